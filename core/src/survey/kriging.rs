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

    /// What works out places with these readings.
    pub fn predictor(&self) -> Predictor<'_, N> {
        Predictor {
            kriging: self,
            near: Vec::new(),
            last_near: Vec::new(),
            covariances: Vec::new(),
            last_covariances: Vec::new(),
            factor: Vec::new(),
            sums: Vec::new(),
            weights: Vec::new(),
        }
    }

    fn covariance_ut2(&self, distance_m: f64) -> f64 {
        let p = &self.params;
        let part = |sd_ut: f64, length_m: f64| sd_ut * sd_ut * libm::exp(-distance_m / length_m);
        part(p.short_sd_ut, p.short_length_m) + part(p.long_sd_ut, p.long_length_m)
    }

    fn covariance_of_readings_ut2(&self, a: u32, b: u32) -> f64 {
        let p = &self.params;
        let (ra, rb) = (&self.readings[a as usize], &self.readings[b as usize]);
        let mut covariance = self.covariance_ut2(ra.position.distance_m(rb.position));
        if ra.walk == rb.walk {
            covariance += p.walk_sd_ut * p.walk_sd_ut;
        }
        if a == b {
            covariance += p.nugget_sd_ut * p.nugget_sd_ut;
        }
        covariance
    }
}

/// Works out place after place; neighbouring places in turn are cheap, since they share readings.
#[derive(Debug)]
pub struct Predictor<'a, const N: usize> {
    kriging: &'a Kriging<N>,
    near: Vec<(f64, u32)>,
    /// The readings of the last place, and their covariances: its lower triangle, by columns.
    last_near: Vec<u32>,
    last_covariances: Vec<f64>,
    covariances: Vec<f64>,
    factor: Vec<f64>,
    sums: Vec<f64>,
    weights: Vec<f64>,
}

impl<const N: usize> Predictor<'_, N> {
    /// The expected values at `place` and their common variance, a single reading's noise excluded.
    pub fn predict(&mut self, place: Point2) -> ([f64; N], f64) {
        let p = &self.kriging.params;
        let sill_ut2 = p.short_sd_ut * p.short_sd_ut + p.long_sd_ut * p.long_sd_ut;
        self.find_neighbours(place);
        let n = self.near.len();
        if n == 0 {
            return (self.kriging.mean_ut, sill_ut2);
        }
        self.fill_covariances();
        self.factor.clone_from(&self.covariances);
        cholesky_in_place(&mut self.factor, n, &mut self.sums);
        self.weights.clear();
        self.weights.extend(self.near.iter().map(|&(distance_m, _)| self.kriging.covariance_ut2(distance_m)));
        forward_substitute(&self.factor, n, &mut self.weights, &mut self.sums);
        let variance_ut2 = sill_ut2 - self.weights.iter().map(|w| w * w).sum::<f64>();
        back_substitute(&self.factor, n, &mut self.weights);
        let mean_ut = self.kriging.mean_ut;
        let mut values_ut = mean_ut;
        for (&(_, k), weight) in self.near.iter().zip(&self.weights) {
            let reading = &self.kriging.readings[k as usize];
            for ((value, read), mean) in values_ut.iter_mut().zip(reading.values_ut).zip(mean_ut) {
                *value += weight * (read - mean);
            }
        }
        (values_ut, variance_ut2.max(0.0))
    }

    /// The walks whose readings [`Predictor::predict`] would use at `place`, some of them repeatedly.
    pub fn walks_used(&mut self, place: Point2) -> impl Iterator<Item = u32> {
        self.find_neighbours(place);
        self.near.iter().map(|&(_, k)| self.kriging.readings[k as usize].walk)
    }

    /// The nearest readings, nearest first; ties by index.
    fn find_neighbours(&mut self, place: Point2) {
        let Kriging { params, readings, cells, .. } = self.kriging;
        self.near.clear();
        let (i, j) = cell_of(place);
        let rings = (params.reach_m / CELL_M).ceil() as i32;
        let mut enough_at = None;
        for ring in 0..=rings {
            if enough_at.is_some_and(|at| ring > at) {
                break;
            }
            for dj in -ring..=ring {
                let step = if dj.abs() == ring { 1 } else { (2 * ring).max(1) };
                for di in (-ring..=ring).step_by(step as usize) {
                    let Some(cell) = cells.get(&(i + di, j + dj)) else { continue };
                    self.near
                        .extend(cell.iter().map(|&k| (readings[k as usize].position.distance_m(place), k)));
                }
            }
            // One more ring after enough are found: a corner of this one is farther than an edge of the next.
            if enough_at.is_none() && self.near.len() >= params.n_neighbours {
                enough_at = Some(ring + 1);
            }
        }
        self.near.retain(|(distance_m, _)| *distance_m <= params.reach_m);
        let nearer = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if self.near.len() > params.n_neighbours {
            self.near.select_nth_unstable_by(params.n_neighbours, nearer);
            self.near.truncate(params.n_neighbours);
        }
        self.near.sort_unstable_by(nearer);
    }

    /// The lower triangle of the neighbours' covariances, by columns; pairs that the last place had are copied.
    fn fill_covariances(&mut self) {
        let n = self.near.len();
        let n_last = self.last_near.len();
        let place_of = |&(_, k): &(f64, u32)| self.last_near.iter().position(|&last| last == k);
        let places: Vec<Option<usize>> = self.near.iter().map(place_of).collect();
        core::mem::swap(&mut self.covariances, &mut self.last_covariances);
        self.covariances.clear();
        self.covariances.resize(n * n, 0.0);
        for b in 0..n {
            for a in b..n {
                self.covariances[b * n + a] = match (places[a], places[b]) {
                    (Some(a), Some(b)) => self.last_covariances[a.min(b) * n_last + a.max(b)],
                    _ => self.kriging.covariance_of_readings_ut2(self.near[a].1, self.near[b].1),
                };
            }
        }
        self.last_near.clear();
        self.last_near.extend(self.near.iter().map(|&(_, k)| k));
    }
}

fn cell_of(p: Point2) -> (i32, i32) {
    ((p.x_m / CELL_M).floor() as i32, (p.y_m / CELL_M).floor() as i32)
}

/// Lower Cholesky factor of a positive definite matrix whose lower triangle is given by columns.
///
/// Each column's sums grow together: they are independent of each other, so the processor need not wait.
fn cholesky_in_place(m: &mut [f64], n: usize, sums: &mut Vec<f64>) {
    for b in 0..n {
        let (done, rest) = m.split_at_mut(b * n);
        sums.clear();
        sums.resize(n - b, 0.0);
        for earlier in done.chunks_exact(n) {
            add_multiple(sums, &earlier[b..], earlier[b]);
        }
        let column = &mut rest[b..n];
        let diagonal = (column[0] - sums[0]).max(1e-9).sqrt();
        for (value, sum) in column.iter_mut().zip(sums.iter()) {
            *value = (*value - sum) / diagonal;
        }
        column[0] = diagonal;
    }
}

fn forward_substitute(l: &[f64], n: usize, x: &mut [f64], sums: &mut Vec<f64>) {
    sums.clear();
    sums.resize(n, 0.0);
    for (b, column) in l.chunks_exact(n).enumerate() {
        x[b] = (x[b] - sums[b]) / column[b];
        add_multiple(&mut sums[b..], &column[b..], x[b]);
    }
}

fn back_substitute(l: &[f64], n: usize, x: &mut [f64]) {
    for (b, column) in l.chunks_exact(n).enumerate().rev() {
        let dot: f64 = column[b + 1..].iter().zip(&x[b + 1..]).map(|(l, x)| l * x).sum();
        x[b] = (x[b] - dot) / column[b];
    }
}

fn add_multiple(sums: &mut [f64], column: &[f64], factor: f64) {
    for (sum, value) in sums.iter_mut().zip(column) {
        *sum += value * factor;
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
        let (values, variance) = kriging.predictor().predict(Point2::new(0.0, 0.0));
        // Mean 20; sill 32; gain 32/36: 20 − 10·32/36, variance 32 − 32²/36.
        assert!((values[0] - (20.0 - 320.0 / 36.0)).abs() < 1e-9);
        assert!((variance - (32.0 - 1024.0 / 36.0)).abs() < 1e-9);
    }

    #[test]
    fn far_from_all_readings_the_mean_and_the_sill_remain() {
        let kriging = Kriging::new(KrigingParams::default(), vec![reading(0.0, 10.0, 0)]);
        assert_eq!(kriging.predictor().predict(Point2::new(500.0, 0.0)), ([10.0], 32.0));
    }

    #[test]
    fn the_nearest_readings_are_found() {
        let readings = (0..400).map(|k| reading(0.1 * f64::from(k), 0.0, 0)).collect();
        let kriging = Kriging::new(KrigingParams { n_neighbours: 5, ..KrigingParams::default() }, readings);
        let mut predictor = kriging.predictor();
        predictor.find_neighbours(Point2::new(20.02, 0.0));
        let mut near: Vec<u32> = predictor.near.iter().map(|n| n.1).collect();
        near.sort_unstable();
        assert_eq!(near, [198, 199, 200, 201, 202]);
    }

    /// Readings of three walks, scattered over 20 m × 20 m.
    fn scattered() -> Vec<Reading<1>> {
        let readings = (0..120).map(|k| {
            let [x, y, value, _] = crate::random::draw(5, 0, k, crate::random::Purpose::Start)
                .map(|bits| f64::from(crate::random::uniform(bits)));
            Reading {
                position: Point2::new(20.0 * x, 20.0 * y),
                values_ut: [40.0 + 10.0 * value],
                walk: k % 3,
            }
        });
        readings.collect()
    }

    #[test]
    fn without_noise_every_reading_is_met() {
        let params = KrigingParams { nugget_sd_ut: 0.0, walk_sd_ut: 0.0, ..KrigingParams::default() };
        let kriging = Kriging::new(params, scattered());
        let mut predictor = kriging.predictor();
        for reading in scattered() {
            let (values, variance) = predictor.predict(reading.position);
            assert!(
                (values[0] - reading.values_ut[0]).abs() < 1e-6 && variance < 1e-6,
                "{values:?} {variance}"
            );
        }
    }

    #[test]
    fn the_last_place_leaves_no_trace() {
        let kriging =
            Kriging::new(KrigingParams { n_neighbours: 20, ..KrigingParams::default() }, scattered());
        let mut predictor = kriging.predictor();
        for k in 0..60 {
            // Small steps, then a leap out of everybody's reach and back.
            let place = Point2::new(if k == 40 { 500.0 } else { 0.4 * f64::from(k) }, 10.0);
            assert_eq!(predictor.predict(place), kriging.predictor().predict(place));
        }
    }

    #[test]
    fn the_walks_used_are_those_of_the_nearest_readings() {
        let readings = (0..40).map(|k| reading(f64::from(k), 0.0, k / 10)).collect();
        let kriging = Kriging::new(KrigingParams { n_neighbours: 4, ..KrigingParams::default() }, readings);
        let mut predictor = kriging.predictor();
        assert_eq!(predictor.walks_used(Point2::new(15.2, 0.0)).collect::<Vec<_>>(), [1; 4]);
        assert_eq!(predictor.walks_used(Point2::new(19.4, 0.0)).collect::<Vec<_>>(), [1, 2, 1, 2]);
        assert_eq!(predictor.walks_used(Point2::new(60.0, 0.0)).count(), 0);
    }
}
