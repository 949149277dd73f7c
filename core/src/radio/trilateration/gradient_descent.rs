//! Trilateration by gradient descent, exactly as iBILL prints it.

use rand::Rng as _;
use serde::{Deserialize, Serialize};

use super::{MIN_PLACES, TrilaterationError, distinct_places, usable};
use crate::geometry::Point2;
use crate::radio::range::Range;
use crate::random::CounterRng;

/// Farther than this from the floor's origin the descent has diverged, in metres.
const FARTHEST_M: f64 = 1e6;

/// Parameters of [`gradient_descent`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GradientDescentParams {
    /// The learning rate α; default 0.1, as printed.
    pub learning_rate: f64,
    /// N; default 50, as printed. The loop runs while `n ≤ N`, so N + 1 times.
    pub training_times: u32,
    /// Whether the distances are the unbiased ranges (the default) or the raw ones; the paper corrects them where it
    /// tells how they are estimated, and does not repeat it at the algorithm.
    pub is_unbiased: bool,
}

impl Default for GradientDescentParams {
    fn default() -> Self {
        Self { learning_rate: 0.1, training_times: 50, is_unbiased: true }
    }
}

/// The place that gradient descent on `J(θ) = ½·Σ(‖θ − b_i‖ − d_i)²` reaches from `start`.
///
/// The gradient is printed with a factor 2 although `J` has a ½, so steps are twice those of `J`. At a beacon itself its
/// term has no direction and is left out. Ranges that are not usable are left out. It may end in a minimum that is not
/// the least, or before any; [`super::trilaterate`] does not.
///
/// # Errors
/// [`TrilaterationError::TooFew`] with ranges to fewer than three places, [`TrilaterationError::Diverged`].
///
/// # Source
/// iBILL 2017, Alg. 1, Eqs 31–32.
pub fn gradient_descent(
    params: &GradientDescentParams,
    ranges: &[Range],
    start: Point2,
) -> Result<Point2, TrilaterationError> {
    let n_places = distinct_places(ranges);
    if n_places < MIN_PLACES {
        return Err(TrilaterationError::TooFew { n_places });
    }
    let mut place = start;
    for _ in 0..=params.training_times {
        let mut gradient = Point2::default();
        for range in usable(ranges) {
            let range_m = if params.is_unbiased { range.unbiased_m } else { range.raw_m };
            let away = place - range.centre;
            let distance_m = away.norm_m();
            if distance_m > 0.0 {
                gradient = gradient + away * (2.0 * (distance_m - range_m) / distance_m);
            }
        }
        place = place - gradient * params.learning_rate;
    }
    // Written so that NaN fails.
    if place.norm_m() <= FARTHEST_M { Ok(place) } else { Err(TrilaterationError::Diverged) }
}

/// A start for [`gradient_descent`], uniform in the box round the beacons of `ranges`; nothing without a usable range.
///
/// The paper says "randomly initialize" and not where. The same seed and round give the same start.
///
/// # Source
/// iBILL 2017, Alg. 1, line 1.
pub fn random_start(ranges: &[Range], seed: u64, round: u64) -> Option<Point2> {
    let mut low = usable(ranges).next()?.centre;
    let mut high = low;
    for range in usable(ranges) {
        low = Point2::new(low.x_m.min(range.centre.x_m), low.y_m.min(range.centre.y_m));
        high = Point2::new(high.x_m.max(range.centre.x_m), high.y_m.max(range.centre.y_m));
    }
    let mut rng = CounterRng::new(seed, round);
    let mut share = || f64::from(rng.next_u32()) / 4_294_967_296.0;
    Some(Point2::new(low.x_m + (high.x_m - low.x_m) * share(), low.y_m + (high.y_m - low.y_m) * share()))
}
