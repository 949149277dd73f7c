//! What a device without a heading would read at a place.

use super::GridLookup;
use crate::map::Layers;

/// Strength, horizontal and vertical part per node, in µT, each unknown one as the mean of those that are known.
///
/// The vertical part and the strength are surveyed. The horizontal part at a node is `√(x² + y²)` of the surveyed vector;
/// where there is none but the others are, `√(strength² − z²)`, which errs more: where the field is steep, the horizontal
/// part is the small difference of large squares.
#[derive(Clone, Debug)]
pub(super) struct ReadGrid {
    reads_ut: Vec<[f32; 4]>,
    mean_ut: [f32; 4],
}

impl ReadGrid {
    /// The reads at the `n` nodes of `layers`.
    pub(super) fn new(layers: &Layers, n: usize) -> Self {
        let layer = |values: &[f32], node: usize| values.get(node).copied().unwrap_or(f32::NAN);
        let read_ut = |node: usize| {
            let (strength, z) = (layer(&layers.strength_ut, node), layer(&layers.field_z_ut, node));
            let (x, y) = (layer(&layers.field_x_ut, node), layer(&layers.field_y_ut, node));
            let of_vector = (x * x + y * y).sqrt();
            let horizontal = if of_vector.is_nan() {
                // `max` would turn what is unknown into 0.
                let square = strength * strength - z * z;
                if square < 0.0 { 0.0 } else { square.sqrt() }
            } else {
                of_vector
            };
            let strength = if strength.is_nan() { (of_vector * of_vector + z * z).sqrt() } else { strength };
            [strength, horizontal, z, 0.0]
        };
        let mut reads_ut: Vec<[f32; 4]> = (0..n).map(read_ut).collect();
        let mut mean_ut = [0.0f32; 4];
        for (c, mean_ut) in mean_ut.iter_mut().enumerate() {
            let (mut sum_ut, mut n_known) = (0.0f64, 0u32);
            for read_ut in reads_ut.iter().filter(|read_ut| read_ut[c].is_finite()) {
                sum_ut += f64::from(read_ut[c]);
                n_known += 1;
            }
            *mean_ut = (sum_ut / f64::from(n_known.max(1))) as f32;
            for read_ut in reads_ut.iter_mut().filter(|read_ut| !read_ut[c].is_finite()) {
                read_ut[c] = *mean_ut;
            }
        }
        Self { reads_ut, mean_ut }
    }

    /// Strength, horizontal and vertical part at a place, bilinear; off the grid the means.
    #[inline]
    pub(super) fn at(&self, grid: &GridLookup, x_m: f32, y_m: f32) -> [f32; 3] {
        let [strength_ut, horizontal_ut, vertical_ut, _] = match self.corners(grid, x_m, y_m) {
            None => self.mean_ut,
            Some(([a, b, c, d], fx, fy)) => {
                let (wa, wb, wc, wd) = ((1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy);
                core::array::from_fn(|k| wa * a[k] + wb * b[k] + wc * c[k] + wd * d[k])
            }
        };
        [strength_ut, horizontal_ut, vertical_ut]
    }

    #[inline]
    fn corners(&self, grid: &GridLookup, x_m: f32, y_m: f32) -> Option<([&[f32; 4]; 4], f32, f32)> {
        let (node, fx, fy) = grid.bilinear(x_m, y_m)?;
        let [a, b] = self.reads_ut.get(node..)?.first_chunk::<2>()?;
        let [c, d] = self.reads_ut.get(node + grid.nx..)?.first_chunk::<2>()?;
        Some(([a, b, c, d], fx, fy))
    }
}

#[cfg(test)]
mod tests {
    use crate::floor_plan::FloorPlan;
    use crate::map::{FloorIndex, FloorMap, GridFrame, Layers};

    /// x, 2x and −x along x.
    fn floor() -> FloorMap {
        let plan = FloorPlan { width_m: 10.0, height_m: 8.0, ..FloorPlan::default() };
        let frame = GridFrame::covering(10.0, 8.0, 1.0);
        let ramp = |scale: f32| (0..frame.len()).map(|n| scale * (n % frame.nx) as f32).collect::<Vec<_>>();
        let layers = Layers {
            field_x_ut: ramp(1.0),
            field_y_ut: ramp(2.0),
            field_z_ut: ramp(-1.0),
            ..Layers::default()
        };
        FloorMap { plan, frame, layers, ..FloorMap::default() }
    }

    #[test]
    fn a_read_is_derived_from_what_the_map_has() {
        let mut map = floor();
        let n = map.frame.len();
        // At x = 4 the vector is (4, 8, −4): √80 across, √96 in all.
        let read = FloorIndex::new(map.clone()).read_or_mean(4.0, 3.0);
        let expected = [96f32.sqrt(), 80f32.sqrt(), -4.0];
        assert!(read.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{read:?}");
        // The surveyed strength goes before the vector's; off the map stand the means.
        map.layers.strength_ut = vec![50.0; n];
        assert_eq!(FloorIndex::new(map.clone()).read_or_mean(4.0, 3.0)[0], 50.0);
        assert_eq!(FloorIndex::new(map.clone()).read_or_mean(-1.0, f32::NAN)[2], -5.0);
        // Without a vector, √(50² − 30²); without anything, 0.
        map.layers = Layers { strength_ut: vec![50.0; n], field_z_ut: vec![-30.0; n], ..Default::default() };
        assert_eq!(FloorIndex::new(map.clone()).read_or_mean(4.0, 3.0), [50.0, 40.0, -30.0]);
        map.layers = Layers::default();
        assert_eq!(FloorIndex::new(map).read_or_mean(4.0, 3.0), [0.0; 3]);
    }
}
