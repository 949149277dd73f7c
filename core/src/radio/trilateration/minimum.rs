//! The minimum of the robust cost: a coarse grid, then Levenberg–Marquardt, in two unknowns and no allocation.

use super::usable;
use crate::geometry::Point2;
use crate::radio::path_loss::NEAREST_M;
use crate::radio::range::Range;

/// Nodes of the coarse grid along each side.
const N_SIDE: u32 = 13;
/// So many of its best nodes are refined.
const N_STARTS: usize = 4;
/// Most iterations of a refinement.
const MAX_ITERATIONS: u32 = 60;
/// A refinement ends when it moves less than this, in metres.
const ENOUGH_M: f64 = 1e-9;
/// Standard deviation of a range's logarithm is never taken for less: a perfect range would silence all others.
const LEAST_LOG_SD: f64 = 0.02;

/// Minus the log-likelihood of the ranges (up to a constant) as a function of the place.
pub(super) struct Cost<'a> {
    pub degrees_of_freedom: f64,
    pub ranges: &'a [Range],
}

/// A symmetric 2 × 2 matrix.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Normal {
    pub xx: f64,
    pub xy: f64,
    pub yy: f64,
}

impl Normal {
    /// Adds `weight·v·vᵀ`.
    pub(super) fn add(&mut self, v: Point2, weight: f64) {
        self.xx += weight * v.x_m * v.x_m;
        self.xy += weight * v.x_m * v.y_m;
        self.yy += weight * v.y_m * v.y_m;
    }

    /// The inverse's xx, xy, yy; nothing when it is singular to rounding.
    pub(super) fn inverse(&self) -> Option<[f64; 3]> {
        let determinant = self.xx * self.yy - self.xy * self.xy;
        (determinant > 1e-12 * self.xx * self.yy && determinant > 0.0)
            .then(|| [self.yy / determinant, -self.xy / determinant, self.xx / determinant])
    }

    /// `(self + damping·diagonal)⁻¹·v`; zero when that is singular.
    fn damped_solve(&self, damping: f64, v: Point2) -> Point2 {
        // A direction that no range speaks of keeps a trace of the other's scale.
        let least = 1e-9 * (self.xx + self.yy);
        let diagonal = |value: f64| value + damping * value.max(least);
        let damped = Self { xx: diagonal(self.xx), xy: self.xy, yy: diagonal(self.yy) };
        damped.inverse().map_or(Point2::default(), |[xx, xy, yy]| {
            Point2::new(xx * v.x_m + xy * v.y_m, xy * v.x_m + yy * v.y_m)
        })
    }
}

impl Cost<'_> {
    /// The best place and its cost.
    pub(super) fn search(&self) -> (Point2, f64) {
        let (low, high) = self.box_of_starts();
        let mut starts = [(low, f64::INFINITY); N_STARTS];
        let at = |k: u32| f64::from(k) / f64::from(N_SIDE - 1);
        for (i, j) in (0..N_SIDE).flat_map(|i| (0..N_SIDE).map(move |j| (i, j))) {
            let place =
                Point2::new(low.x_m + (high.x_m - low.x_m) * at(i), low.y_m + (high.y_m - low.y_m) * at(j));
            let mut candidate = (place, self.at(place));
            for start in &mut starts {
                if candidate.1 < start.1 {
                    core::mem::swap(start, &mut candidate);
                }
            }
        }
        let refined = starts.map(|(place, _)| self.refined(place));
        refined.into_iter().fold((low, f64::INFINITY), |best, next| if next.1 < best.1 { next } else { best })
    }

    /// The box round the beacons, wider by the shortest range on each side: exact ranges end inside it.
    fn box_of_starts(&self) -> (Point2, Point2) {
        let mut low = Point2::new(f64::INFINITY, f64::INFINITY);
        let mut high = Point2::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
        let mut shortest_m = f64::INFINITY;
        for range in usable(self.ranges) {
            low = Point2::new(low.x_m.min(range.centre.x_m), low.y_m.min(range.centre.y_m));
            high = Point2::new(high.x_m.max(range.centre.x_m), high.y_m.max(range.centre.y_m));
            shortest_m = shortest_m.min(range.raw_m);
        }
        let margin = Point2::new(shortest_m, shortest_m);
        (low - margin, high + margin)
    }

    /// The cost of a place.
    fn at(&self, place: Point2) -> f64 {
        let nu = self.degrees_of_freedom;
        let of_range = |range| {
            let (residual, _) = residual(range, place);
            0.5 * (nu + 1.0) * libm::log1p(residual * residual / nu)
        };
        usable(self.ranges).map(of_range).sum()
    }

    /// The minimum that downhill from `place` ends in, and its cost.
    pub(super) fn refined(&self, mut place: Point2) -> (Point2, f64) {
        let nu = self.degrees_of_freedom;
        let (mut cost, mut damping) = (self.at(place), 1e-3);
        for _ in 0..MAX_ITERATIONS {
            let (mut normal, mut downhill) = (Normal::default(), Point2::default());
            for range in usable(self.ranges) {
                let (residual, gradient) = residual(range, place);
                let weight = (nu + 1.0) / (nu + residual * residual);
                normal.add(gradient, weight);
                downhill = downhill - gradient * (weight * residual);
            }
            let mut moved = false;
            while damping < 1e9 {
                let step = normal.damped_solve(damping, downhill);
                let next = self.at(place + step);
                if next < cost {
                    (place, cost, moved) = (place + step, next, step.norm_m() > ENOUGH_M);
                    damping *= 0.2;
                    break;
                }
                if step.norm_m() <= ENOUGH_M {
                    break;
                }
                damping *= 5.0;
            }
            if !moved {
                break;
            }
        }
        (place, cost)
    }

    /// The information that the ranges hold of the place: what a Student-t number of their deviations holds.
    pub(super) fn information(&self, place: Point2) -> Normal {
        let nu = self.degrees_of_freedom;
        let mut normal = Normal::default();
        for range in usable(self.ranges) {
            normal.add(residual(range, place).1, (nu + 1.0) / (nu + 3.0));
        }
        normal
    }
}

/// The logarithm of distance over range, in standard deviations, and its gradient in the place; nearer than a metre
/// as at one, as path loss has it.
fn residual(range: &Range, place: Point2) -> (f64, Point2) {
    let per_sd = 1.0 / range.log_sd.max(LEAST_LOG_SD);
    let away = place - range.centre;
    let distance_m = away.norm_m();
    let ratio = distance_m.max(NEAREST_M) / range.raw_m.max(NEAREST_M);
    let gradient =
        if distance_m > NEAREST_M { away * (per_sd / (distance_m * distance_m)) } else { Point2::default() };
    (libm::log(ratio) * per_sd, gradient)
}
