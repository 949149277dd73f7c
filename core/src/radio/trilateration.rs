//! Ranges into a place: robustly, and saying when the beacons stand badly; and as iBILL prints it.

mod gradient_descent;
mod minimum;
#[cfg(test)]
mod tests;

pub use gradient_descent::{GradientDescentParams, gradient_descent, random_start};

use serde::{Deserialize, Serialize};

use crate::geometry::Point2;
use crate::radio::range::Range;
use minimum::{Cost, Normal};

/// Beacons nearer to each other than this stand at one place, in metres.
const SAME_PLACE_M: f64 = 0.1;
/// Fewest places with a range: with two, both crossings of two circles fit.
const MIN_PLACES: usize = 3;

/// Minima nearer to each other than this are one, in metres.
const SAME_MINIMUM_M: f64 = 1.0;

/// Parameters of [`trilaterate`]. No paper gives them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrilaterationParams {
    /// Degrees of freedom of the Student-t density of a range's logarithm; default 4, as for the radio likelihood: a
    /// range behind a body or a wall is not a normal one.
    pub degrees_of_freedom: f64,
    /// The dilution beyond which the geometry is called bad; default 5. Inside an equilateral triangle it is 1.15.
    pub max_dilution: f64,
    /// A place on the other side of the beacons' line is called possible when its log-likelihood falls short of the
    /// best one's by less than this; default 1.
    pub mirror_log_likelihood: f64,
}

impl Default for TrilaterationParams {
    fn default() -> Self {
        Self { degrees_of_freedom: 4.0, max_dilution: 5.0, mirror_log_likelihood: 1.0 }
    }
}

/// A place from ranges.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrilateratedPlace {
    /// The place, in the floor frame.
    pub point: Point2,
    /// Horizontal dilution of precision: root mean square metres of error a metre of error in every range, by where the
    /// beacons stand; infinite when they all lie in one line with the place.
    pub dilution: f64,
    /// Covariance of the place (xx, xy, yy), in m², by the ranges' own deviations: near beacons count more. It knows
    /// what the path loss's σ knows.
    pub covariance_m2: [f64; 3],
}

impl TrilateratedPlace {
    /// Root of the mean squared distance from the true place, in metres, by the covariance.
    pub fn sd_m(&self) -> f64 {
        (self.covariance_m2[0] + self.covariance_m2[2]).sqrt()
    }
}

/// Why ranges give no place, or none to rely on.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TrilaterationError {
    /// The usable ranges were to fewer than three places.
    TooFew {
        /// To how many places there was a usable range.
        n_places: usize,
    },
    /// Beacons (nearly) in one line: a place on the other side fits about as well.
    Mirrored {
        /// The likelier place.
        place: TrilateratedPlace,
        /// The other one.
        mirror: Point2,
    },
    /// The place is found badly along some direction.
    Diluted {
        /// The place with its dilution.
        place: TrilateratedPlace,
    },
    /// The descent left the Earth: with more than about twenty beacons the printed learning rate overshoots.
    Diverged,
}

impl TrilaterationError {
    /// The best place in spite of the geometry, where there is one.
    pub fn place(&self) -> Option<&TrilateratedPlace> {
        match self {
            Self::Mirrored { place, .. } | Self::Diluted { place } => Some(place),
            Self::TooFew { .. } | Self::Diverged => None,
        }
    }
}

impl core::fmt::Display for TrilaterationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooFew { n_places } => {
                write!(f, "ranges to {n_places} places, and {MIN_PLACES} are needed: hang more beacons")
            }
            Self::Mirrored { mirror, .. } => write!(
                f,
                "the beacons heard stand in a line, so ({:.1}, {:.1}) m fits about as well: hang one off the line",
                mirror.x_m, mirror.y_m
            ),
            Self::Diluted { place } => {
                write!(f, "the beacons stand badly: {:.1} m of error a metre of range", place.dilution)
            }
            Self::Diverged => write!(f, "the descent diverged: use fewer beacons or a smaller learning rate"),
        }
    }
}

impl core::error::Error for TrilaterationError {}

/// The likeliest place by `ranges`; no allocation.
///
/// Each range's logarithm has the deviation that the path loss says, so a range weighs by the inverse square of its own
/// standard deviation: near beacons decide. Student-t residuals make one blocked beacon do little. The search begins on
/// a coarse grid round the beacons, so that no start decides; Levenberg–Marquardt ends it. Ranges that are not usable
/// are left out.
///
/// # Errors
/// [`TrilaterationError::TooFew`], [`TrilaterationError::Mirrored`] and [`TrilaterationError::Diluted`]; the last two
/// carry the best place.
///
/// # Source
/// Ours. iBILL 2017, Eq. 32 sums plain squares of metres, where a far beacon, whose range is off by as much as the room
/// is wide, counts like a near one; [`gradient_descent`] is that.
pub fn trilaterate(
    params: &TrilaterationParams,
    ranges: &[Range],
) -> Result<TrilateratedPlace, TrilaterationError> {
    let n_places = distinct_places(ranges);
    if n_places < MIN_PLACES {
        return Err(TrilaterationError::TooFew { n_places });
    }
    let cost = Cost { degrees_of_freedom: params.degrees_of_freedom, ranges };
    let (point, least) = cost.search();
    let place = TrilateratedPlace {
        point,
        dilution: dilution(ranges, point),
        covariance_m2: cost.information(point).inverse().unwrap_or([f64::INFINITY, 0.0, f64::INFINITY]),
    };
    let across = cost.refined(mirrored(ranges, point));
    if across.0.distance_m(point) > SAME_MINIMUM_M && across.1 - least < params.mirror_log_likelihood {
        return Err(TrilaterationError::Mirrored { place, mirror: across.0 });
    }
    if place.dilution <= params.max_dilution { Ok(place) } else { Err(TrilaterationError::Diluted { place }) }
}

/// The ranges that can be used.
fn usable(ranges: &[Range]) -> impl Iterator<Item = &Range> + Clone {
    ranges.iter().filter(|range| range.is_usable())
}

/// To how many different places there are usable ranges.
fn distinct_places(ranges: &[Range]) -> usize {
    let is_new = |&(k, range): &(usize, &Range)| {
        usable(ranges).take(k).all(|other| other.centre.distance_m(range.centre) > SAME_PLACE_M)
    };
    usable(ranges).enumerate().filter(is_new).count()
}

/// Root of the trace of `(Σ u·uᵀ)⁻¹`, `u` the unit vectors from the beacons to the point.
fn dilution(ranges: &[Range], point: Point2) -> f64 {
    let mut normal = Normal::default();
    for range in usable(ranges) {
        let away = point - range.centre;
        let distance_m = away.norm_m();
        if distance_m > 0.0 {
            normal.add(away * (1.0 / distance_m), 1.0);
        }
    }
    normal.inverse().map_or(f64::INFINITY, |[xx, _, yy]| (xx + yy).sqrt())
}

/// The point on the other side of the line along which the beacons spread most.
fn mirrored(ranges: &[Range], point: Point2) -> Point2 {
    let n = usable(ranges).count().max(1) as f64;
    let centre = usable(ranges).fold(Point2::default(), |sum, range| sum + range.centre * (1.0 / n));
    let mut scatter = Normal::default();
    usable(ranges).for_each(|range| scatter.add(range.centre - centre, 1.0));
    let angle_rad = 0.5 * libm::atan2(2.0 * scatter.xy, scatter.xx - scatter.yy);
    let (sin, cos) = libm::sincos(angle_rad);
    let off = point - centre;
    let across = off.y_m * cos - off.x_m * sin;
    Point2::new(point.x_m + 2.0 * across * sin, point.y_m - 2.0 * across * cos)
}
