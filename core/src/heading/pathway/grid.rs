//! The directions of the ways at every place, made ready for thousands of particles.

use crate::geometry::{Point2, Segment};
use crate::heading::pathway::{CORNER_M, PathwayParams, Pathways};
use crate::map::GridFrame;

/// How finely directions are kept, in metres.
const CELL_M: f64 = 0.5;
/// Directions nearer to each other than this cosine (four degrees) are kept once.
const SAME_COSINE: f32 = 0.9976;

/// For each half metre of a floor, the directions in which its nearest ways can be walked.
///
/// A place counts as its cell's centre; else it answers as [`Pathways::closest_direction_rad`].
#[derive(Clone, Debug)]
pub struct WayGrid {
    params: PathwayParams,
    least_cosine: f32,
    frame: GridFrame,
    origin_m: [f32; 2],
    starts: Vec<u32>,
    /// Sine and cosine of headings.
    directions: Vec<[f32; 2]>,
}

impl WayGrid {
    /// The ways of a floor of `width_m` × `height_m`.
    pub fn new(pathways: &Pathways, params: PathwayParams, width_m: f64, height_m: f64) -> Self {
        let mut frame = GridFrame::covering(width_m, height_m, CELL_M);
        frame.origin = Point2::new(0.5 * CELL_M, 0.5 * CELL_M);
        let mut nearest_m = vec![f64::INFINITY; frame.len()];
        for segment in &pathways.segments {
            for_each_cell_near(&frame, segment, params.reach_m, |cell, distance_m| {
                nearest_m[cell] = nearest_m[cell].min(distance_m);
            });
        }
        let mut of_cells = vec![Vec::<[f32; 2]>::new(); frame.len()];
        for segment in &pathways.segments {
            let heading_rad = (segment.b - segment.a).heading_rad();
            let (sin, cos) = libm::sincos(heading_rad);
            let along = [sin as f32, cos as f32];
            for_each_cell_near(&frame, segment, params.reach_m + CORNER_M, |cell, distance_m| {
                if nearest_m[cell] > params.reach_m || distance_m > nearest_m[cell] + CORNER_M {
                    return;
                }
                let directions = &mut of_cells[cell];
                for direction in [along, along.map(|c| -c)] {
                    if !directions.iter().any(|known| cosine(*known, direction) > SAME_COSINE) {
                        directions.push(direction);
                    }
                }
            });
        }
        let mut starts = vec![0];
        let mut directions = Vec::new();
        for of_cell in of_cells {
            directions.extend(of_cell);
            starts.push(directions.len() as u32);
        }
        let origin_m = [frame.origin.x_m, frame.origin.y_m].map(|m| m as f32);
        let least_cosine = libm::cos(params.max_turn_rad) as f32;
        Self { params, least_cosine, frame, origin_m, starts, directions }
    }

    /// Sine and cosine of the heading that a particle takes at a place: along its way, or raw.
    ///
    /// As [`pathway_heading_rad`](super::pathway_heading_rad), with headings as sines and cosines.
    #[inline]
    pub fn heading(&self, x_m: f32, y_m: f32, raw: [f32; 2], last: [f32; 2], share: f32) -> [f32; 2] {
        let wanted = if share < self.params.by_compass {
            raw
        } else if share < self.params.by_compass + self.params.by_last_heading {
            last
        } else {
            return raw;
        };
        let mut taken = None;
        // Where the way may differ by a right angle less rounding, it does not differ by less.
        let mut best = self.least_cosine + 1e-6;
        for &direction in self.directions_at(x_m, y_m) {
            let cosine = cosine(direction, wanted);
            if cosine > best {
                (best, taken) = (cosine, Some(direction));
            }
        }
        taken.unwrap_or(raw)
    }

    #[inline]
    fn directions_at(&self, x_m: f32, y_m: f32) -> &[[f32; 2]] {
        let per_m = (1.0 / CELL_M) as f32;
        let u = (x_m - self.origin_m[0]) * per_m + 0.5;
        let v = (y_m - self.origin_m[1]) * per_m + 0.5;
        if !(u >= 0.0 && v >= 0.0) || u >= self.frame.nx as f32 || v >= self.frame.ny as f32 {
            return &[];
        }
        let cell = v as usize * self.frame.nx + u as usize;
        let span = self.starts.get(cell).zip(self.starts.get(cell + 1));
        span.and_then(|(&from, &to)| self.directions.get(from as usize..to as usize)).unwrap_or(&[])
    }
}

fn cosine(a: [f32; 2], b: [f32; 2]) -> f32 {
    a[0] * b[0] + a[1] * b[1]
}

/// Hands `visit` every cell whose centre lies within `reach_m` of `segment`, with the distance.
fn for_each_cell_near(frame: &GridFrame, segment: &Segment, reach_m: f64, mut visit: impl FnMut(usize, f64)) {
    let index = |m: f64, origin_m: f64, n: usize| {
        (((m - origin_m) / frame.cell_m).max(0.0) as usize).min(n.saturating_sub(1))
    };
    let (x0, x1) = (segment.a.x_m.min(segment.b.x_m), segment.a.x_m.max(segment.b.x_m));
    let (y0, y1) = (segment.a.y_m.min(segment.b.y_m), segment.a.y_m.max(segment.b.y_m));
    let columns =
        index(x0 - reach_m, frame.origin.x_m, frame.nx)..=index(x1 + reach_m, frame.origin.x_m, frame.nx);
    for j in index(y0 - reach_m, frame.origin.y_m, frame.ny)..=index(y1 + reach_m, frame.origin.y_m, frame.ny)
    {
        for i in columns.clone() {
            let distance_m = segment.distance_m(frame.node(i, j));
            if distance_m <= reach_m {
                visit(j * frame.nx + i, distance_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::wrap_rad;
    use crate::heading::pathway::pathway_heading_rad;
    use proptest::prelude::*;

    fn ways() -> Pathways {
        let lines = [
            vec![(1.0, 2.0), (18.0, 2.0), (18.0, 12.0), (1.0, 12.0), (1.0, 2.0)],
            vec![(9.0, 2.0), (12.0, 12.0)],
        ];
        let points = |line: Vec<(f64, f64)>| line.into_iter().map(|(x, y)| Point2::new(x, y)).collect();
        Pathways::of_lines(&lines.map(points))
    }

    proptest! {
        #[test]
        fn the_grid_answers_as_the_ways_do(
            i in 0usize..50, j in 0usize..36, raw in -3.1f64..3.1, last in -3.1f64..3.1, share in 0.0f32..1.0,
            max_turn_rad in 0.3f64..1.57,
        ) {
            let params = PathwayParams { max_turn_rad, ..PathwayParams::default() };
            let grid = WayGrid::new(&ways(), params, 20.0, 14.0);
            let place = Point2::new(0.25 + 0.5 * i as f64, 0.25 + 0.5 * j as f64);
            let place = place + Point2::new(-2.5, -2.5);
            let of = |heading_rad: f64| [libm::sin(heading_rad) as f32, libm::cos(heading_rad) as f32];
            let [sin, cos] = grid.heading(place.x_m as f32, place.y_m as f32, of(raw), of(last), share);
            let taken = libm::atan2(f64::from(sin), f64::from(cos));
            // The last cells reach beyond the plan.
            let expected = if (0.0..20.5).contains(&place.x_m) && (0.0..14.5).contains(&place.y_m) {
                pathway_heading_rad(&params, &ways(), place, raw, last, share)
            } else {
                raw
            };
            // A tie, or an angle at the very limit, may go either way.
            let wanted = if share < 0.4 { raw } else { last };
            let off = |heading: f64| wrap_rad(heading - wanted).abs();
            let is_tie = (off(taken) - off(expected)).abs() < 1e-3 || (off(expected) - max_turn_rad).abs() < 1e-3
                || (off(taken) - max_turn_rad).abs() < 1e-3;
            prop_assert!(wrap_rad(taken - expected).abs() < 1e-3 || is_tie, "{taken} {expected}");
        }
    }

    #[test]
    fn off_every_way_the_heading_is_raw() {
        let grid = WayGrid::new(&ways(), PathwayParams::default(), 20.0, 14.0);
        let raw = [0.6, 0.8];
        assert_eq!(grid.heading(5.0, 7.0, raw, [0.0, 1.0], 0.1), raw);
        assert_eq!(grid.heading(f32::NAN, 7.0, raw, [0.0, 1.0], 0.1), raw);
        assert_eq!(grid.heading(5.0, 1e30, raw, [0.0, 1.0], 0.1), raw);
        // On one it is the way's.
        assert_eq!(grid.heading(5.0, 2.2, raw, [0.0, 1.0], 0.1).map(f32::round), [1.0, 0.0]);
    }
}
