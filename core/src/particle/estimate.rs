//! The weighted mean of the cloud, its covariance and the radii that hold 68 % and 95 % of the weight.

use crate::geometry::Point2;
use crate::particle::Particles;

/// Width of a histogram bin for the radii, in metres.
const BIN_M: f32 = 0.1;
/// Bins; farther particles fall into the last one, which ends where the farthest is.
const N_BINS: usize = 1_024;

/// What the cloud says.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CloudEstimate {
    /// Weighted mean along x, in metres.
    pub x_m: f64,
    /// Weighted mean along y, in metres.
    pub y_m: f64,
    /// Weighted circular mean of the headings, in radians.
    pub heading_rad: f64,
    /// Covariance of (x, y), in m².
    pub covariance_m2: [[f64; 2]; 2],
    /// Radius about the mean that holds 68 % of the weight, in metres.
    pub radius_68_m: f64,
    /// Radius about the mean that holds 95 % of the weight, in metres.
    pub radius_95_m: f64,
    /// Effective number of particles, `(Σw)² / Σw²`.
    pub effective_sample_size: f64,
}

/// What the cloud's position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Centre {
    /// The weighted mean.
    Mean,
    /// The heaviest particle; of equals the first.
    ///
    /// # Source
    /// Song 2014, §3.
    Heaviest,
}

/// Memory for [`CloudEstimate::of`].
#[derive(Clone, Debug)]
pub struct EstimateScratch {
    histogram: Vec<f64>,
    farthest_m: f64,
}

impl Default for EstimateScratch {
    fn default() -> Self {
        Self { histogram: vec![0.0; N_BINS], farthest_m: 0.0 }
    }
}

impl CloudEstimate {
    /// The estimate of `particles` under `weights` (any positive scale); nothing when the weights sum to zero.
    ///
    /// # Source
    /// iBILL 2017, Eq. 14, and the other papers alike: the weighted mean.
    pub fn of(particles: &Particles, weights: &[f32], scratch: &mut EstimateScratch) -> Option<Self> {
        Self::centred(Centre::Mean, particles, weights, scratch)
    }

    /// The same about another centre: position, covariance and radii are about it.
    pub fn centred(
        centre: Centre,
        particles: &Particles,
        weights: &[f32],
        scratch: &mut EstimateScratch,
    ) -> Option<Self> {
        let (mut total, mut square, mut x, mut y, mut sin, mut cos) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (i, &w) in weights.iter().enumerate() {
            let w = f64::from(w);
            total += w;
            square += w * w;
            x += w * f64::from(particles.x_m[i]);
            y += w * f64::from(particles.y_m[i]);
            sin += w * f64::from(particles.heading_sin[i]);
            cos += w * f64::from(particles.heading_cos[i]);
        }
        if !(total > 0.0 && total.is_finite()) {
            return None;
        }
        let (x, y) = match centre {
            Centre::Mean => (x / total, y / total),
            Centre::Heaviest => {
                let best =
                    (0..weights.len()).fold(0, |best, i| if weights[i] > weights[best] { i } else { best });
                (f64::from(particles.x_m[best]), f64::from(particles.y_m[best]))
            }
        };
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        scratch.clear();
        for (i, &w) in weights.iter().enumerate() {
            let (dx, dy) = (f64::from(particles.x_m[i]) - x, f64::from(particles.y_m[i]) - y);
            let w = f64::from(w);
            xx += w * dx * dx;
            xy += w * dx * dy;
            yy += w * dy * dy;
            scratch.add((dx * dx + dy * dy).sqrt(), w);
        }
        Some(Self {
            x_m: x,
            y_m: y,
            heading_rad: libm::atan2(sin, cos),
            covariance_m2: [[xx / total, xy / total], [xy / total, yy / total]],
            radius_68_m: scratch.radius_m(0.68 * total),
            radius_95_m: scratch.radius_m(0.95 * total),
            effective_sample_size: total * total / square,
        })
    }

    /// The estimate that stands at `point`, spread as the weighted places about it are; nothing when the weights sum to
    /// zero.
    pub fn about(
        point: Point2,
        places: impl Iterator<Item = (Point2, f32)>,
        scratch: &mut EstimateScratch,
    ) -> Option<Self> {
        let (mut total, mut square, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        scratch.clear();
        for (place, w) in places {
            let (off, w) = (place - point, f64::from(w));
            total += w;
            square += w * w;
            xx += w * off.x_m * off.x_m;
            xy += w * off.x_m * off.y_m;
            yy += w * off.y_m * off.y_m;
            scratch.add(off.norm_m(), w);
        }
        (total > 0.0 && total.is_finite()).then(|| Self {
            x_m: point.x_m,
            y_m: point.y_m,
            heading_rad: 0.0,
            covariance_m2: [[xx / total, xy / total], [xy / total, yy / total]],
            radius_68_m: scratch.radius_m(0.68 * total),
            radius_95_m: scratch.radius_m(0.95 * total),
            effective_sample_size: total * total / square,
        })
    }
}

impl EstimateScratch {
    fn clear(&mut self) {
        self.histogram.fill(0.0);
        self.farthest_m = 0.0;
    }

    fn add(&mut self, distance_m: f64, weight: f64) {
        self.farthest_m = self.farthest_m.max(distance_m);
        let bin = (distance_m as f32 * (1.0 / BIN_M)) as usize;
        self.histogram[bin.min(N_BINS - 1)] += weight;
    }

    /// The radius that holds `weight`, in metres.
    fn radius_m(&self, weight: f64) -> f64 {
        let mut sum = 0.0;
        for (bin, mass) in self.histogram.iter().enumerate() {
            if sum + mass >= weight {
                let part = if *mass > 0.0 { (weight - sum) / mass } else { 0.0 };
                if bin + 1 == N_BINS {
                    let from_m = f64::from(BIN_M) * bin as f64;
                    return from_m + part * (self.farthest_m - from_m).max(0.0);
                }
                return f64::from(BIN_M) * (bin as f64 + part);
            }
            sum += mass;
        }
        self.farthest_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cloud_of_a_whole_mall_is_as_wide_as_it_is() {
        // A thousand particles along 600 m, about their middle.
        let x_m: Vec<f32> = (0..1_000).map(|k| 0.6 * k as f32).collect();
        let zeros = vec![0.0; 1_000];
        let particles = Particles {
            x_m,
            y_m: zeros.clone(),
            heading_sin: zeros.clone(),
            heading_cos: zeros,
            ..Particles::default()
        };
        let weights = vec![1.0; 1_000];
        let estimate = CloudEstimate::of(&particles, &weights, &mut EstimateScratch::default()).unwrap();
        assert!((estimate.radius_68_m - 0.68 * 300.0).abs() < 1.0, "{}", estimate.radius_68_m);
        assert!((estimate.radius_95_m - 0.95 * 300.0).abs() < 1.0, "{}", estimate.radius_95_m);
    }

    #[test]
    fn mean_covariance_and_size_by_hand() {
        let particles = Particles {
            x_m: vec![0.0, 2.0, 0.0, 2.0],
            y_m: vec![0.0, 0.0, 4.0, 4.0],
            heading_sin: vec![0.6; 4],
            heading_cos: vec![0.8; 4],
            ..Particles::default()
        };
        let estimate = CloudEstimate::of(&particles, &[1.0; 4], &mut EstimateScratch::default()).unwrap();
        assert_eq!((estimate.x_m, estimate.y_m), (1.0, 2.0));
        assert_eq!(estimate.covariance_m2, [[1.0, 0.0], [0.0, 4.0]]);
        assert_eq!(estimate.effective_sample_size, 4.0);
        assert!((estimate.heading_rad - libm::atan2(0.6, 0.8)).abs() < 1e-6);
        // All four lie √5 ≈ 2.236 m away: in the bin from 2.2 m to 2.3 m.
        assert!(estimate.radius_68_m > 2.2 && estimate.radius_95_m < 2.3);
        assert_eq!(CloudEstimate::of(&particles, &[0.0; 4], &mut EstimateScratch::default()), None);
    }

    #[test]
    fn a_spread_about_a_place_by_hand() {
        let scratch = &mut EstimateScratch::default();
        let at = |x_m, y_m| Point2::new(x_m, y_m);
        let places = [(at(1.0, 1.0), 3.0), (at(4.05, 5.0), 1.0), (at(1.0, 1.0), 0.0)];
        let estimate = CloudEstimate::about(at(1.0, 1.0), places.into_iter(), scratch).unwrap();
        assert_eq!((estimate.x_m, estimate.y_m), (1.0, 1.0));
        assert_eq!(estimate.covariance_m2[1], [3.05, 4.0]);
        assert!(estimate.radius_68_m < 0.1 && (estimate.radius_95_m - 5.0).abs() < 0.1, "{estimate:?}");
        assert_eq!(estimate.effective_sample_size, 1.6);
        assert_eq!(CloudEstimate::about(at(0.0, 0.0), core::iter::empty(), scratch), None);
    }
}
