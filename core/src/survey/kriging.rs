//! Local ordinary-with-known-mean (simple) kriging: scattered readings become a grid with its own variance.

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;

/// Parameters of the field's spatial covariance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct KrigingParams {
    /// Readings used at a node.
    pub n_neighbours: usize,
    /// Readings farther than this are not used, in metres.
    pub reach_m: f64,
    /// Length of the fine structure (furniture, doors), in metres.
    pub short_length_m: f64,
    /// Standard deviation of the fine structure, in µT.
    pub short_sd_ut: f64,
    /// Length of the coarse structure (the steel frame), in metres.
    pub long_length_m: f64,
    /// Standard deviation of the coarse structure, in µT.
    pub long_sd_ut: f64,
    /// Standard deviation of one reading about the field, in µT.
    pub nugget_sd_ut: f64,
    /// Standard deviation of what all readings of one walk share (the magnetometer's bias), in µT.
    pub walk_sd_ut: f64,
}

impl Default for KrigingParams {
    fn default() -> Self {
        Self {
            n_neighbours: 48,
            reach_m: 12.0,
            short_length_m: 2.5,
            short_sd_ut: 4.0,
            long_length_m: 12.0,
            long_sd_ut: 4.0,
            nugget_sd_ut: 3.5,
            walk_sd_ut: 4.0,
        }
    }
}

/// A reading at a place: `N` quantities that share one covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<const N: usize> {
    /// Where.
    pub position: Point2,
    /// What, in µT.
    pub values_ut: [f64; N],
    /// The walk that it comes from.
    pub walk: u32,
}

/// Readings with a search grid.
#[derive(Debug)]
pub struct Kriging<const N: usize> {
    params: KrigingParams,
    readings: Vec<Reading<N>>,
    mean_ut: [f64; N],
    cells: std::collections::BTreeMap<(i32, i32), Vec<u32>>,
}

const CELL_M: f64 = 2.0;

impl<const N: usize> Kriging<N> {
    /// Prepares `readings`; their mean is what is expected where nothing is near.
    pub fn new(params: KrigingParams, readings: Vec<Reading<N>>) -> Self {
        let n = readings.len().max(1) as f64;
        let mut mean_ut = [0.0; N];
        let mut cells = std::collections::BTreeMap::<_, Vec<u32>>::new();
        for (k, reading) in readings.iter().enumerate() {
            for (mean, value) in mean_ut.iter_mut().zip(reading.values_ut) {
                *mean += value / n;
            }
            cells.entry(cell_of(reading.position)).or_default().push(k as u32);
        }
        Self { params, readings, mean_ut, cells }
    }

    /// The expected values at `place` and their common variance, a single reading's noise excluded.
    pub fn predict(&self, place: Point2, scratch: &mut KrigingScratch) -> ([f64; N], f64) {
        let p = &self.params;
        let sill_ut2 = p.short_sd_ut * p.short_sd_ut + p.long_sd_ut * p.long_sd_ut;
        self.neighbours(place, scratch);
        let n = scratch.near.len();
        if n == 0 {
            return (self.mean_ut, sill_ut2);
        }
        scratch.matrix.clear();
        scratch.matrix.resize(n * n, 0.0);
        scratch.weights.clear();
        for a in 0..n {
            let ra = &self.readings[scratch.near[a].1 as usize];
            for b in 0..=a {
                let rb = &self.readings[scratch.near[b].1 as usize];
                let mut covariance = self.covariance_ut2(ra.position.distance_m(rb.position));
                if ra.walk == rb.walk {
                    covariance += p.walk_sd_ut * p.walk_sd_ut;
                }
                if a == b {
                    covariance += p.nugget_sd_ut * p.nugget_sd_ut;
                }
                scratch.matrix[a * n + b] = covariance;
            }
            scratch.weights.push(self.covariance_ut2(ra.position.distance_m(place)));
        }
        let mut variance_ut2 = sill_ut2;
        cholesky_in_place(&mut scratch.matrix, n);
        forward_substitute(&scratch.matrix, n, &mut scratch.weights);
        variance_ut2 -= scratch.weights.iter().map(|w| w * w).sum::<f64>();
        back_substitute(&scratch.matrix, n, &mut scratch.weights);
        let mut values_ut = self.mean_ut;
        for (&(_, k), weight) in scratch.near.iter().zip(&scratch.weights) {
            let reading = &self.readings[k as usize];
            for ((value, read), mean) in values_ut.iter_mut().zip(reading.values_ut).zip(self.mean_ut) {
                *value += weight * (read - mean);
            }
        }
        (values_ut, variance_ut2.max(0.0))
    }

    fn covariance_ut2(&self, distance_m: f64) -> f64 {
        let p = &self.params;
        let part = |sd_ut: f64, length_m: f64| sd_ut * sd_ut * libm::exp(-distance_m / length_m);
        part(p.short_sd_ut, p.short_length_m) + part(p.long_sd_ut, p.long_length_m)
    }

    /// The nearest readings, nearest first; ties by index.
    fn neighbours(&self, place: Point2, scratch: &mut KrigingScratch) {
        scratch.near.clear();
        let (i, j) = cell_of(place);
        let rings = (self.params.reach_m / CELL_M).ceil() as i32;
        let mut enough_at = None;
        for ring in 0..=rings {
            if enough_at.is_some_and(|at| ring > at) {
                break;
            }
            for dj in -ring..=ring {
                let step = if dj.abs() == ring { 1 } else { (2 * ring).max(1) };
                for di in (-ring..=ring).step_by(step as usize) {
                    let Some(cell) = self.cells.get(&(i + di, j + dj)) else { continue };
                    scratch.near.extend(
                        cell.iter().map(|&k| (self.readings[k as usize].position.distance_m(place), k)),
                    );
                }
            }
            // One more ring after enough are found: a corner of this one is farther than an edge of the next.
            if enough_at.is_none() && scratch.near.len() >= self.params.n_neighbours {
                enough_at = Some(ring + 1);
            }
        }
        scratch.near.retain(|(distance_m, _)| *distance_m <= self.params.reach_m);
        scratch.near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        scratch.near.truncate(self.params.n_neighbours);
    }
}

/// Memory for [`Kriging::predict`].
#[derive(Debug, Default)]
pub struct KrigingScratch {
    near: Vec<(f64, u32)>,
    matrix: Vec<f64>,
    weights: Vec<f64>,
}

fn cell_of(p: Point2) -> (i32, i32) {
    ((p.x_m / CELL_M).floor() as i32, (p.y_m / CELL_M).floor() as i32)
}

/// Lower Cholesky factor of a positive definite matrix whose lower triangle is given.
fn cholesky_in_place(m: &mut [f64], n: usize) {
    for a in 0..n {
        for b in 0..=a {
            let dot: f64 = (0..b).map(|k| m[a * n + k] * m[b * n + k]).sum();
            let rest = m[a * n + b] - dot;
            m[a * n + b] = if a == b { rest.max(1e-9).sqrt() } else { rest / m[b * n + b] };
        }
    }
}

fn forward_substitute(l: &[f64], n: usize, x: &mut [f64]) {
    for a in 0..n {
        let dot: f64 = (0..a).map(|k| l[a * n + k] * x[k]).sum();
        x[a] = (x[a] - dot) / l[a * n + a];
    }
}

fn back_substitute(l: &[f64], n: usize, x: &mut [f64]) {
    for a in (0..n).rev() {
        let dot: f64 = (a + 1..n).map(|k| l[k * n + a] * x[k]).sum();
        x[a] = (x[a] - dot) / l[a * n + a];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(x: f64, value: f64, walk: u32) -> Reading<1> {
        Reading { position: Point2::new(x, 0.0), values_ut: [value], walk }
    }

    #[test]
    fn one_reading_by_hand() {
        let params = KrigingParams { walk_sd_ut: 0.0, nugget_sd_ut: 2.0, ..KrigingParams::default() };
        let kriging = Kriging::new(params, vec![reading(0.0, 10.0, 0), reading(1_000.0, 30.0, 1)]);
        let (values, variance) = kriging.predict(Point2::new(0.0, 0.0), &mut KrigingScratch::default());
        // Mean 20; sill 32; gain 32/36: 20 − 10·32/36, variance 32 − 32²/36.
        assert!((values[0] - (20.0 - 320.0 / 36.0)).abs() < 1e-9);
        assert!((variance - (32.0 - 1024.0 / 36.0)).abs() < 1e-9);
    }

    #[test]
    fn far_from_all_readings_the_mean_and_the_sill_remain() {
        let kriging = Kriging::new(KrigingParams::default(), vec![reading(0.0, 10.0, 0)]);
        assert_eq!(kriging.predict(Point2::new(500.0, 0.0), &mut KrigingScratch::default()), ([10.0], 32.0));
    }

    #[test]
    fn the_nearest_readings_are_found() {
        let readings = (0..400).map(|k| reading(0.1 * f64::from(k), 0.0, 0)).collect();
        let kriging = Kriging::new(KrigingParams { n_neighbours: 5, ..KrigingParams::default() }, readings);
        let mut scratch = KrigingScratch::default();
        kriging.neighbours(Point2::new(20.02, 0.0), &mut scratch);
        let mut near: Vec<u32> = scratch.near.iter().map(|n| n.1).collect();
        near.sort_unstable();
        assert_eq!(near, [198, 199, 200, 201, 202]);
    }
}
