//! The ellipsoid fit.

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};
use serde::{Deserialize, Serialize};

use super::coverage::coverage;
use super::{CalibrationQuality, MagnetometerCalibration, SwingAgain};

/// Parameters of [`fit_ellipsoid`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EllipsoidParams {
    /// The strength of the undisturbed field at the place, in µT, where it is known; else it is found, and the
    /// ellipsoid's volume kept.
    pub strength_ut: Option<f64>,
    /// Standard deviation of the soft iron's matrix about the identity, before any reading; default 0.1: phones bend
    /// the field by a few hundredths. It keeps few readings from bending it more.
    pub soft_iron_sd: f64,
    /// Standard deviation of one reading's strength, in µT; default 1. Readings beyond twice as much count less.
    pub noise_ut: f64,
    /// Fewest readings; default 30.
    pub min_readings: usize,
    /// Least share of the directions with readings; default 0.4.
    pub min_coverage: f64,
    /// Largest standard deviation of the worst-known direction of the offset, in µT; default 1.5.
    pub max_offset_sd_ut: f64,
    /// Largest residual, in µT; default 2.5.
    pub max_residual_ut: f64,
    /// A component this large is at the end of the sensor's range, in µT; default 1198 (ranges begin at ±1200).
    pub range_ut: f64,
}

impl Default for EllipsoidParams {
    fn default() -> Self {
        Self {
            strength_ut: None,
            soft_iron_sd: 0.1,
            noise_ut: 1.0,
            min_readings: 30,
            min_coverage: 0.4,
            max_offset_sd_ut: 1.5,
            max_residual_ut: 2.5,
            range_ut: 1_198.0,
        }
    }
}

/// Offset (three) and the matrix's xx, yy, zz, xy, xz, yz.
const N: usize = 9;
type Unknowns = SVector<f64, N>;
type Normal = SMatrix<f64, N, N>;

/// Most Gauss–Newton iterations; ten suffice for an ellipsoid within a third of a sphere.
const MAX_ITERATIONS: usize = 50;

/// The ellipsoid on which `readings_ut` (raw fields, device frame) lie.
///
/// A sphere by linear least squares begins; then Levenberg–Marquardt on `|A·(m − o)| − strength` with Huber's weights,
/// so that some disturbed readings do little, and a prior on `A`.
///
/// # Errors
/// When the readings are too few, cover too little, lie on no ellipsoid or were at the end of the sensor's range.
pub fn fit_ellipsoid(
    readings_ut: &[[f64; 3]],
    params: &EllipsoidParams,
) -> Result<MagnetometerCalibration, SwingAgain> {
    let is_usable = |m: &[f64; 3]| m.iter().all(|c| c.is_finite());
    let readings: Vec<[f64; 3]> = readings_ut.iter().copied().filter(is_usable).collect();
    let n_readings = readings.len();
    let is_saturated = |m: &&[f64; 3]| m.iter().any(|c| c.abs() >= params.range_ut);
    let n_saturated = readings.iter().filter(is_saturated).count();
    if n_saturated > n_readings / 100 {
        return Err(SwingAgain::Saturated { n_saturated });
    }
    let n_needed = params.min_readings.max(N);
    if n_readings < n_needed {
        return Err(SwingAgain::TooShort { n_readings, n_needed });
    }
    let uncovered = SwingAgain::TooLittleCovered { coverage: 0.0, offset_sd_ut: f64::INFINITY };
    let (centre, radius_ut) = sphere(&readings).ok_or(uncovered)?;
    let target_ut = params.strength_ut.unwrap_or(radius_ut);
    let fitted = refine(&readings, centre, radius_ut, target_ut, params).ok_or(uncovered)?;
    let offset = fitted.unknowns.fixed_rows::<3>(0).into_owned();
    let coverage = coverage(&readings, offset.into());
    let offset_sd_ut = fitted.offset_sd_ut();
    let mut matrix = matrix_of(&fitted.unknowns);
    // A positive definite matrix alone is an ellipsoid's.
    if !(coverage >= params.min_coverage && offset_sd_ut <= params.max_offset_sd_ut)
        || matrix.cholesky().is_none()
    {
        return Err(SwingAgain::TooLittleCovered { coverage, offset_sd_ut });
    }
    let mut strength_ut = target_ut;
    if params.strength_ut.is_none() {
        let scale = libm::cbrt(matrix.determinant());
        matrix /= scale;
        strength_ut /= scale;
    }
    let square = |m: &[f64; 3]| {
        let excess_ut = (matrix * (Vector3::from(*m) - offset)).norm() - strength_ut;
        excess_ut * excess_ut
    };
    let residual_ut = (readings.iter().map(square).sum::<f64>() / n_readings as f64).sqrt();
    if residual_ut.is_nan() || residual_ut > params.max_residual_ut {
        return Err(SwingAgain::TooDisturbed { residual_ut });
    }
    let axes = matrix.symmetric_eigenvalues();
    let quality = CalibrationQuality {
        strength_ut,
        residual_ut,
        coverage,
        offset_sd_ut,
        axis_ratio: axes.max() / axes.min(),
        n_readings,
    };
    let matrix = [0, 1, 2].map(|r| [0, 1, 2].map(|c| matrix[(r, c)]));
    Ok(MagnetometerCalibration { offset_ut: offset.into(), matrix, quality })
}

/// Centre and radius of the sphere nearest to the readings: `|m|² = 2·o·m + (r² − |o|²)` by least squares.
fn sphere(readings: &[[f64; 3]]) -> Option<([f64; 3], f64)> {
    let n = readings.len() as f64;
    let mean = Vector3::from([0, 1, 2].map(|c| readings.iter().map(|m| m[c]).sum::<f64>() / n));
    let mut normal = Matrix4::zeros();
    let mut right = Vector4::zeros();
    for reading in readings {
        // About the mean the numbers stay small.
        let m = Vector3::from(*reading) - mean;
        let row = Vector4::new(2.0 * m.x, 2.0 * m.y, 2.0 * m.z, 1.0);
        normal += row * row.transpose();
        right += row * m.norm_squared();
    }
    let solution = normal.cholesky()?.solve(&right);
    let centre = solution.fixed_rows::<3>(0).into_owned();
    let radius2 = solution[3] + centre.norm_squared();
    (radius2 > 0.0 && radius2.is_finite()).then(|| ((centre + mean).into(), radius2.sqrt()))
}

/// Where the refinement ended.
struct Fitted {
    unknowns: Unknowns,
    /// Sum of `J·Jᵀ` with weights and prior, and the variance of one residual, in µT².
    normal: Normal,
    variance_ut2: f64,
}

impl Fitted {
    /// Standard deviation of the offset along its worst-known direction; infinite where it is unknown.
    fn offset_sd_ut(&self) -> f64 {
        let Some(inverse) = self.normal.try_inverse() else { return f64::INFINITY };
        let offset: Matrix3<f64> = inverse.fixed_view::<3, 3>(0, 0).into();
        (offset.symmetric_eigenvalues().max() * self.variance_ut2).max(0.0).sqrt()
    }
}

fn refine(
    readings: &[[f64; 3]],
    centre: [f64; 3],
    radius_ut: f64,
    target_ut: f64,
    params: &EllipsoidParams,
) -> Option<Fitted> {
    // The prior is a sphere of the target's size, or of any size where a known strength differs from the readings'.
    let scale = target_ut / radius_ut;
    let start = [centre[0], centre[1], centre[2], scale, scale, scale, 0.0, 0.0, 0.0];
    let mut unknowns = Unknowns::from(start);
    let mut damping = 1e-3;
    let mut now = linearise(readings, &unknowns, scale, target_ut, params);
    for _ in 0..MAX_ITERATIONS {
        let mut damped = now.normal;
        for c in 0..N {
            damped[(c, c)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(&now.gradient);
        let next_unknowns = unknowns - step;
        let next = linearise(readings, &next_unknowns, scale, target_ut, params);
        if next.cost < now.cost {
            let is_settled = now.cost - next.cost < 1e-12 * now.cost;
            (unknowns, now) = (next_unknowns, next);
            damping = (damping * 0.2).max(1e-12);
            if is_settled {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    let n_free = (readings.len() as f64 - N as f64).max(1.0);
    let floor_ut2 = 1e-4 * params.noise_ut * params.noise_ut;
    let variance_ut2 = (2.0 * now.cost / n_free).max(floor_ut2);
    unknowns.iter().all(|u| u.is_finite()).then_some(Fitted { unknowns, normal: now.normal, variance_ut2 })
}

/// The robust cost at some unknowns, its gradient and the normal matrix.
struct Linearised {
    cost: f64,
    gradient: Unknowns,
    normal: Normal,
}

fn linearise(
    readings: &[[f64; 3]],
    unknowns: &Unknowns,
    scale: f64,
    target_ut: f64,
    params: &EllipsoidParams,
) -> Linearised {
    let matrix = matrix_of(unknowns);
    let offset = unknowns.fixed_rows::<3>(0).into_owned();
    let knee_ut = 2.0 * params.noise_ut;
    let mut result = Linearised { cost: 0.0, gradient: Unknowns::zeros(), normal: Normal::zeros() };
    for reading in readings {
        let u = Vector3::from(*reading) - offset;
        let v = matrix * u;
        let length_ut = v.norm();
        if length_ut < 1e-9 {
            continue;
        }
        let residual_ut = length_ut - target_ut;
        let size_ut = residual_ut.abs();
        let weight = if size_ut <= knee_ut { 1.0 } else { knee_ut / size_ut };
        result.cost += if size_ut <= knee_ut {
            0.5 * residual_ut * residual_ut
        } else {
            knee_ut * (size_ut - 0.5 * knee_ut)
        };
        let d = v / length_ut;
        let by_offset = -(matrix * d);
        let row = Unknowns::from([
            by_offset.x,
            by_offset.y,
            by_offset.z,
            d.x * u.x,
            d.y * u.y,
            d.z * u.z,
            d.x * u.y + d.y * u.x,
            d.x * u.z + d.z * u.x,
            d.y * u.z + d.z * u.y,
        ]);
        result.gradient += row * (weight * residual_ut);
        result.normal += row * row.transpose() * weight;
    }
    let sd = params.soft_iron_sd * scale;
    let prior = params.noise_ut * params.noise_ut / (sd * sd);
    for c in 3..N {
        let expected = if c < 6 { scale } else { 0.0 };
        let off = unknowns[c] - expected;
        result.cost += 0.5 * prior * off * off;
        result.gradient[c] += prior * off;
        result.normal[(c, c)] += prior;
    }
    result
}

fn matrix_of(unknowns: &Unknowns) -> Matrix3<f64> {
    let [_, _, _, xx, yy, zz, xy, xz, yz] = (*unknowns).into();
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

#[cfg(test)]
mod tests;
