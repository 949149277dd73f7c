//! Buildings of open rooms: squares that are crossed in all directions, joined by doors.

use fieldwalk::floor_plan::{FloorPlan, Unit};
use fieldwalk::geometry::{Point2, Segment};

use crate::building::{Building, Door, Rectangle, Way, WayGraph};

/// How far before and behind a door one walks straight, in metres.
const DOOR_REACH_M: f64 = 0.8;

/// A building described by its rooms, which meet wall to wall, and the doors between them.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenBuilding {
    /// The building's name.
    pub name: String,
    /// Extent along x, in metres.
    pub width_m: f64,
    /// Extent along y, in metres.
    pub height_m: f64,
    /// The rooms; each is walkable all over.
    pub rooms: Vec<Rectangle>,
    /// The doors between rooms: middle, and whether the wall runs along x.
    pub doors: Vec<(Point2, bool)>,
    /// Width of a door, in metres.
    pub door_width_m: f64,
    /// Distance between the lanes that people walk on, in metres, about.
    pub lane_m: f64,
    /// Whether people also cross from lane to lane askew.
    pub is_crossed_askew: bool,
    /// Where columns stand.
    pub columns: Vec<Point2>,
    /// From floor to ceiling, in metres.
    pub ceiling_m: f64,
}

impl OpenBuilding {
    /// The building.
    pub fn build(&self) -> Building {
        let unit = |(room, k): (&Rectangle, usize)| Unit {
            name: format!("room {k}"),
            walkable: true,
            polygon: room.polygon(),
        };
        let (across, up) = (Point2::new(1.0, 0.0), Point2::new(0.0, 1.0));
        let doors = self.doors.iter().map(|&(centre, is_along_x)| Door {
            centre,
            along: if is_along_x { across } else { up },
            width_m: self.door_width_m,
        });
        let doors: Vec<Door> = doors.collect();
        let plan = FloorPlan {
            width_m: self.width_m,
            height_m: self.height_m,
            outline: vec![Rectangle::new(0.0, 0.0, self.width_m, self.height_m).polygon()],
            units: self.rooms.iter().zip(1..).map(unit).collect(),
            walls: self.rooms.iter().flat_map(|room| self.walls(room, &doors)).collect(),
            ..FloorPlan::default()
        };
        Building {
            name: self.name.clone(),
            plan,
            ways: self.ways(&doors),
            doors,
            columns: self.columns.clone(),
            squares: self.rooms.clone(),
            ceiling_m: self.ceiling_m,
            ..Building::default()
        }
    }

    /// A room's walls, with gaps for doors; where two rooms meet the wall is there twice, with the same gaps.
    fn walls(&self, room: &Rectangle, doors: &[Door]) -> Vec<Segment> {
        let [a, b, c, d] = room.corners();
        let mut walls = Vec::new();
        for (from, to) in [(a, b), (b, c), (d, c), (a, d)] {
            let along = (to - from) * (1.0 / from.distance_m(to).max(1e-9));
            let place_m = |p: Point2| (p.x_m - from.x_m) * along.x_m + (p.y_m - from.y_m) * along.y_m;
            let wall = Segment { a: from, b: to };
            let mut gaps_m: Vec<f64> = doors
                .iter()
                .filter(|door| wall.distance_m(door.centre) < 1e-6)
                .map(|d| place_m(d.centre))
                .collect();
            gaps_m.sort_by(f64::total_cmp);
            let mut start = from;
            for gap_m in gaps_m {
                walls.push(Segment { a: start, b: from + along * (gap_m - 0.5 * self.door_width_m) });
                start = from + along * (gap_m + 0.5 * self.door_width_m);
            }
            walls.push(Segment { a: start, b: to });
        }
        walls
    }

    /// Lanes through every room, and through every door.
    fn ways(&self, doors: &[Door]) -> WayGraph {
        let mut graph = WayGraph::default();
        let mut rooms: Vec<std::ops::Range<usize>> = Vec::with_capacity(self.rooms.len());
        for room in &self.rooms {
            let first = graph.nodes.len();
            let (xs, ys) = lanes(room, self.lane_m);
            graph.nodes.extend(ys.iter().flat_map(|&y_m| xs.iter().map(move |&x_m| Point2::new(x_m, y_m))));
            let at = |i: usize, j: usize| first + j * xs.len() + i;
            let mut link = |from: usize, to: usize, free_m: f64| graph.ways.push(Way { from, to, free_m });
            for j in 0..ys.len() {
                for i in 0..xs.len() {
                    if i + 1 < xs.len() {
                        link(at(i, j), at(i + 1, j), 0.5);
                    }
                    if j + 1 < ys.len() {
                        link(at(i, j), at(i, j + 1), 0.5);
                    }
                    if self.is_crossed_askew && i + 1 < xs.len() && j + 1 < ys.len() {
                        link(at(i, j), at(i + 1, j + 1), 0.5);
                        link(at(i + 1, j), at(i, j + 1), 0.5);
                    }
                }
            }
            rooms.push(first..graph.nodes.len());
        }
        for door in doors {
            let across = Point2::new(-door.along.y_m, door.along.x_m) * DOOR_REACH_M;
            let first = graph.nodes.len();
            let ends = [door.centre - across, door.centre + across];
            graph.nodes.extend(ends);
            graph.ways.push(Way { from: first, to: first + 1, free_m: 0.1 });
            for (end, node) in ends.into_iter().zip(first..) {
                let Some(room) = self.rooms.iter().position(|room| room.contains(end)) else { continue };
                let near = |a: usize, b: usize| {
                    end.distance_m(graph.nodes[a]).total_cmp(&end.distance_m(graph.nodes[b]))
                };
                if let Some(nearest) = rooms[room].clone().min_by(|&a, &b| near(a, b)) {
                    graph.ways.push(Way { from: node, to: nearest, free_m: 0.1 });
                }
            }
        }
        graph
    }
}

/// The lanes of a room along y (their x) and along x (their y), about `lane_m` apart and half of that from its walls.
pub(crate) fn lanes(room: &Rectangle, lane_m: f64) -> (Vec<f64>, Vec<f64>) {
    let between = |low_m: f64, high_m: f64| -> Vec<f64> {
        let n = ((high_m - low_m) / lane_m).round().max(1.0);
        (0..n as usize).map(|k| low_m + (high_m - low_m) * (k as f64 + 0.5) / n).collect()
    };
    (between(room.low.x_m, room.high.x_m), between(room.low.y_m, room.high.y_m))
}
