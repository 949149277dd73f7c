//! The ways that people take through a building, and lines along them.

use fieldwalk::geometry::{Point2, Segment};

use crate::building::{Aisle, Rectangle};
use crate::noise::Noise;

/// Half the breadth of a body, and air, in metres: nobody walks closer to a wall.
const BODY_M: f64 = 0.3;

/// A straight way between two nodes of a [`WayGraph`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// One node.
    pub from: usize,
    /// The other.
    pub to: usize,
    /// How far one can keep to a side of the way's middle, in metres.
    pub free_m: f64,
}

/// Crossings, doors and places, and the straight ways between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WayGraph {
    /// Where one can turn.
    pub nodes: Vec<Point2>,
    /// The ways; each can be walked in both directions.
    pub ways: Vec<Way>,
}

impl WayGraph {
    /// The ways of a grid of corridors, with `halls` between the rows that are crossed through their doors, and a node
    /// before the stairs.
    pub(super) fn of_grid(
        columns: &[Aisle],
        rows: &[Aisle],
        halls: &[Rectangle],
        stairs_at: Option<Point2>,
    ) -> Self {
        let mut graph = Self::default();
        let n_columns = columns.len();
        for row in rows {
            graph.nodes.extend(columns.iter().map(|column| Point2::new(column.centre_m, row.centre_m)));
        }
        let mut doors: Vec<(usize, usize)> = Vec::new();
        for hall in halls {
            graph.add_hall(rows, hall, &mut doors);
        }
        let row_of = |p: Point2| rows.iter().position(|row| (row.centre_m - p.y_m).abs() < 1e-6);
        if let Some((place, row)) = stairs_at.and_then(|place| Some((place, row_of(place)?))) {
            doors.push((row, graph.nodes.len()));
            graph.nodes.push(place);
        }
        for (j, row) in rows.iter().enumerate() {
            let of_row = doors.iter().filter(|(r, _)| *r == j).map(|(_, node)| *node);
            let mut along: Vec<usize> = (j * n_columns..(j + 1) * n_columns).chain(of_row).collect();
            along.sort_by(|&a, &b| graph.nodes[a].x_m.total_cmp(&graph.nodes[b].x_m));
            graph.link(&along, row.width_m);
        }
        for (i, column) in columns.iter().enumerate() {
            let along: Vec<usize> = (0..rows.len()).map(|j| j * n_columns + i).collect();
            graph.link(&along, column.width_m);
        }
        graph
    }

    /// Through a hall: from the corridor below by the door to the left or the right half, and out above.
    fn add_hall(&mut self, rows: &[Aisle], hall: &Rectangle, doors: &mut Vec<(usize, usize)>) {
        let centre = hall.centre();
        let quarter_m = 0.25 * (hall.high.x_m - hall.low.x_m);
        let below = rows.iter().rposition(|row| row.centre_m < hall.low.y_m);
        let above = rows.iter().position(|row| row.centre_m > hall.high.y_m);
        let (Some(below), Some(above)) = (below, above) else { return };
        let first = self.nodes.len();
        let node = |x_m: f64, y_m: f64| Point2::new(x_m, y_m);
        self.nodes.extend([
            node(centre.x_m, rows[below].centre_m),
            node(centre.x_m, hall.low.y_m + 1.2),
            node(centre.x_m - quarter_m, centre.y_m),
            node(centre.x_m + quarter_m, centre.y_m),
            node(centre.x_m, hall.high.y_m - 1.2),
            node(centre.x_m, rows[above].centre_m),
        ]);
        doors.extend([(below, first), (above, first + 5)]);
        for (from, to, free_m) in
            [(0, 1, 0.1), (1, 2, 0.6), (1, 3, 0.6), (1, 4, 0.6), (2, 4, 0.6), (3, 4, 0.6), (4, 5, 0.1)]
        {
            self.ways.push(Way { from: first + from, to: first + to, free_m });
        }
    }

    fn link(&mut self, along: &[usize], width_m: f64) {
        let free_m = (0.5 * width_m - BODY_M).max(0.0);
        self.ways.extend(along.windows(2).map(|pair| Way { from: pair[0], to: pair[1], free_m }));
    }

    /// The nodes that a way joins to `node`, with the free space along it.
    pub fn neighbours(&self, node: usize) -> impl Iterator<Item = (usize, f64)> {
        self.ways.iter().filter_map(move |way| match way {
            Way { from, to, free_m } if *from == node => Some((*to, *free_m)),
            Way { from, to, free_m } if *to == node => Some((*from, *free_m)),
            _ => None,
        })
    }

    /// The free space to a side of the straight line between two places, in metres: the least of the ways that the line
    /// follows, 0 where it follows none.
    pub fn free_m(&self, from: Point2, to: Point2) -> f64 {
        let line = Segment { a: from, b: to };
        let is_on = |line: Segment, p: Point2| line.distance_m(p) < 1e-6;
        let follows = |way: &&Way| {
            let way = Segment { a: self.nodes[way.from], b: self.nodes[way.to] };
            let is_part = is_on(line, way.a) && is_on(line, way.b);
            is_part || (is_on(way, from) && is_on(way, to))
        };
        let free_m = self.ways.iter().filter(follows).map(|way| way.free_m).fold(f64::INFINITY, f64::min);
        if free_m.is_finite() { free_m } else { 0.0 }
    }

    /// Whether `p` is within `margin_m` of the space that the ways need.
    pub(crate) fn is_near(&self, p: Point2, margin_m: f64) -> bool {
        self.ways.iter().any(|way| {
            let line = Segment { a: self.nodes[way.from], b: self.nodes[way.to] };
            line.distance_m(p) < way.free_m + margin_m
        })
    }

    /// A way through the building by chance, at least `length_m` long, that turns back only at dead ends.
    pub fn wander(&self, seed: u64, length_m: f64) -> Vec<Point2> {
        if self.nodes.is_empty() {
            return Vec::new();
        }
        let mut noise = Noise::new(seed, "wander", 0);
        let start = noise.index(self.nodes.len());
        self.wander_on(start, &mut noise, length_m)
    }

    /// A way by chance that begins at the node nearest to `start`, at least `length_m` long.
    pub fn wander_from(&self, start: Point2, seed: u64, length_m: f64) -> Vec<Point2> {
        let nearest = (0..self.nodes.len())
            .min_by(|&a, &b| start.distance_m(self.nodes[a]).total_cmp(&start.distance_m(self.nodes[b])));
        let Some(nearest) = nearest else { return Vec::new() };
        self.wander_on(nearest, &mut Noise::new(seed, "wander", 1), length_m)
    }

    fn wander_on(&self, start: usize, noise: &mut Noise, length_m: f64) -> Vec<Point2> {
        let mut path = vec![start];
        let mut walked_m = 0.0;
        while walked_m < length_m && path.len() < 1_000 {
            let here = path[path.len() - 1];
            let back = path.len().checked_sub(2).map(|k| path[k]);
            let onward: Vec<usize> =
                self.neighbours(here).map(|(node, _)| node).filter(|&node| Some(node) != back).collect();
            let Some(next) = onward.get(noise.index(onward.len())).copied().or(back) else { break };
            walked_m += self.nodes[here].distance_m(self.nodes[next]);
            path.push(next);
        }
        path.into_iter().map(|node| self.nodes[node]).collect()
    }
}

/// The line `right_m[k]` to the right of the `k`-th stretch of `line`.
///
/// `right_m` holds one number per stretch; where there are fewer, the last holds on.
pub fn keeping_right(line: &[Point2], right_m: &[f64]) -> Vec<Point2> {
    let aside = |k: usize| right_m.get(k).or(right_m.last()).copied().unwrap_or(0.0);
    let normals: Vec<Point2> = line
        .windows(2)
        .map(|pair| {
            let along = pair[1] - pair[0];
            Point2::new(along.y_m, -along.x_m) * (1.0 / along.norm_m().max(1e-9))
        })
        .collect();
    let moved = |(k, &p): (usize, &Point2)| {
        let before = k.checked_sub(1).and_then(|k| Some((*normals.get(k)?, aside(k))));
        let after = normals.get(k).map(|&n| (n, aside(k)));
        match (before, after) {
            (Some((n, a)), Some((m, b))) => {
                let det = n.x_m * m.y_m - n.y_m * m.x_m;
                if det.abs() < 0.2 {
                    p + (n * a + m * b) * 0.5
                } else {
                    // The place at `a` along one normal and at `b` along the other.
                    p + Point2::new(a * m.y_m - b * n.y_m, b * n.x_m - a * m.x_m) * (1.0 / det)
                }
            }
            (Some((n, a)), None) | (None, Some((n, a))) => p + n * a,
            (None, None) => p,
        }
    };
    line.iter().enumerate().map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::Building;

    #[test]
    fn a_line_keeps_right_round_a_corner() {
        let line = [Point2::new(0.0, 0.0), Point2::new(0.0, 10.0), Point2::new(10.0, 10.0)];
        let right = keeping_right(&line, &[0.5, 0.2]);
        // Northward the right is east, eastward it is south.
        assert_eq!(right, [Point2::new(0.5, 0.0), Point2::new(0.5, 9.8), Point2::new(10.0, 9.8)]);
    }

    #[test]
    fn every_way_of_the_office_is_free_of_walls() {
        let office = Building::office();
        assert!(office.ways.nodes.len() == 18 && office.ways.ways.len() > 20);
        for way in &office.ways.ways {
            let line = [office.ways.nodes[way.from], office.ways.nodes[way.to]];
            for right_m in [-way.free_m, 0.0, way.free_m] {
                let moved = keeping_right(&line, &[right_m]);
                assert!(office.is_clear(moved[0], moved[1]), "{line:?} {right_m}");
            }
        }
    }

    #[test]
    fn free_space_is_that_of_the_narrowest_way() {
        let ways = Building::office().ways;
        let (a, b) = (Point2::new(6.0, 25.0), Point2::new(54.0, 25.0));
        assert!((ways.free_m(a, b) - 0.05).abs() < 1e-9);
        assert!((ways.free_m(Point2::new(6.0, 8.0), Point2::new(6.0, 12.0)) - 0.5).abs() < 1e-9);
        assert_eq!(ways.free_m(a, Point2::new(20.0, 30.0)), 0.0);
    }

    #[test]
    fn wandering_is_seeded_and_long_enough() {
        let ways = Building::office().ways;
        let length_m = |path: &[Point2]| path.windows(2).map(|p| p[0].distance_m(p[1])).sum::<f64>();
        let path = ways.wander(1, 120.0);
        assert!(length_m(&path) >= 120.0);
        assert_eq!(path, ways.wander(1, 120.0));
        assert_ne!(path, ways.wander(2, 120.0));
        assert!(path.windows(2).all(|p| ways.neighbours(0).count() > 0 && p[0] != p[1]));
    }
}
