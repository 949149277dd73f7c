//! The lines that a surveyor walks.

use fieldwalk::geometry::Point2;

use crate::building::{Building, Rectangle, keeping_right, lanes};

/// Distance of the second line from a corridor's middle, in metres, where there is room.
///
/// # Source
/// Mass-centred 2019: one line in corridors of 0.7 m, two more 0.5 m apart in those of 1.6 m.
const ASIDE_M: f64 = 0.5;
/// Distance between the lines in what is wider, in metres, about: nobody surveys a mall at 0.5 m.
const WIDE_ASIDE_M: f64 = 1.6;

/// Lines that cover `building`: to and fro along all corridors of each direction, down their middles and to their
/// right sides, through every hall, and along the lanes of open rooms. Each is walked in both directions.
pub fn survey_lines(building: &Building) -> Vec<Vec<Point2>> {
    let (mut along_x, mut along_y) = (Vec::new(), Vec::new());
    for corridor in &building.corridors {
        let (a, b) = (corridor.line.a, corridor.line.b);
        if (a.y_m - b.y_m).abs() < 1e-9 { along_x.push(a.y_m) } else { along_y.push(a.x_m) }
    }
    along_x.sort_by(f64::total_cmp);
    along_y.sort_by(f64::total_cmp);
    let mut middles = vec![
        to_and_fro(&along_x, &along_y, |along, across| Point2::new(across, along)),
        to_and_fro(&along_y, &along_x, Point2::new),
    ];
    let mut lines = Vec::new();
    for middle in &middles {
        for line in both_ways(middle) {
            let free: Vec<f64> = line.windows(2).map(|p| building.ways.free_m(p[0], p[1])).collect();
            let widest_m = free.iter().copied().fold(0.0, f64::max);
            let mut aside_m = ASIDE_M;
            loop {
                lines.push(keeping_right(&line, &free.iter().map(|m| m.min(aside_m)).collect::<Vec<_>>()));
                aside_m += WIDE_ASIDE_M;
                if aside_m > widest_m {
                    break;
                }
            }
        }
    }
    for hall in &building.halls {
        let at = hall.centre();
        let quarter_m = 0.25 * (hall.high.x_m - hall.low.x_m);
        let below = along_x.iter().rev().find(|&&y| y < hall.low.y_m);
        let above = along_x.iter().find(|&&y| y > hall.high.y_m);
        let (Some(&below), Some(&above)) = (below, above) else { continue };
        let (low_m, high_m) = (hall.low.y_m + 1.2, hall.high.y_m - 1.2);
        let places = [
            (at.x_m, below),
            (at.x_m, low_m),
            (at.x_m - quarter_m, at.y_m),
            (at.x_m, high_m),
            (at.x_m + quarter_m, at.y_m),
            (at.x_m, low_m),
            (at.x_m, above),
        ];
        middles.push(places.map(|(x_m, y_m)| Point2::new(x_m, y_m)).to_vec());
    }
    middles.extend(building.squares.iter().flat_map(lanes_of));
    middles.extend(between_rooms(building));
    lines.extend(middles.iter().filter(|middle| middle.len() > 1).flat_map(|middle| both_ways(middle)));
    lines
}

/// To and fro over an open room, along its length and across it.
fn lanes_of(room: &Rectangle) -> [Vec<Point2>; 2] {
    let (xs, ys) = lanes(room, WIDE_ASIDE_M);
    [to_and_fro(&ys, &xs, |y, x| Point2::new(x, y)), to_and_fro(&xs, &ys, Point2::new)]
}

/// From the middle of one open room through each door to the middle of the next.
fn between_rooms(building: &Building) -> impl Iterator<Item = Vec<Point2>> {
    building.doors.iter().map(|door| {
        let across = Point2::new(-door.along.y_m, door.along.x_m);
        let room_at =
            |p: Point2| building.squares.iter().find(|room| room.contains(p)).map(Rectangle::centre);
        let (before, after) = (door.centre - across * 0.8, door.centre + across * 0.8);
        let (first, last) = (room_at(before), room_at(after));
        first.zip(last).map_or(Vec::new(), |(first, last)| vec![first, before, after, last])
    })
}

fn both_ways(line: &[Point2]) -> [Vec<Point2>; 2] {
    [line.to_vec(), line.iter().rev().copied().collect()]
}

/// Along each of `lines` in turn, alternately forwards and backwards, joined at the outermost of `ends`.
fn to_and_fro(lines: &[f64], ends: &[f64], point: impl Fn(f64, f64) -> Point2) -> Vec<Point2> {
    let (Some(&first), Some(&last)) = (ends.first(), ends.last()) else { return Vec::new() };
    let turn = |(k, &along): (usize, &f64)| {
        let (from, to) = if k % 2 == 0 { (first, last) } else { (last, first) };
        [point(along, from), point(along, to)]
    };
    lines.iter().enumerate().flat_map(turn).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lines_cover_every_corridor_and_meet_no_wall() {
        let office = Building::office();
        let lines = survey_lines(&office);
        assert_eq!(lines.len(), 10);
        for line in &lines {
            assert!(line.windows(2).all(|p| office.is_clear(p[0], p[1])), "{line:?}");
        }
        for corridor in &office.corridors {
            let middle = corridor.line.a.lerp(corridor.line.b, 0.4);
            let near =
                |p: &[Point2]| fieldwalk::geometry::Segment { a: p[0], b: p[1] }.distance_m(middle) < 0.01;
            assert!(lines.iter().filter(|line| line.windows(2).any(near)).count() >= 2, "{corridor:?}");
        }
    }
}
