//! The ellipsoid on which a swing's readings lie.

use crate::calibration::Calibration;

type Vector = [f64; 3];
type Matrix = [[f64; 3]; 3];

/// Fewest readings.
pub(crate) const MIN_READINGS: usize = 30;
/// Least share of the 24 cells of the sphere with readings.
const MIN_COVERED: u32 = 10;
/// Largest root mean square of the calibrated strengths about their mean, in µT.
const MAX_RESIDUAL_UT: f64 = 2.5;
/// A component this large is at the end of the sensor's range, in µT.
const RANGE_UT: f32 = 1_198.0;
/// Standard deviation of the squared strength by noise, over that of the soft iron's quadric before any reading: readings
/// of 1 µT in 45, twice for the square, against a tenth, twice.
const PRIOR_WEIGHT: f64 = 0.05;

/// Why a swing gave no calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwingRejection {
    /// Fewer than 30 readings that differ.
    TooShort,
    /// Less than ten of 24 directions, or the offset stays unknown along one.
    TooLittleCovered,
    /// The readings lie on no ellipsoid, or on one that iron on a card does not make.
    TooDisturbed,
    /// The sensor was at the end of its range.
    Saturated,
}

/// Fits `readings_ut`: a sphere by linear least squares, then a quadric about it with a prior that it is that sphere.
///
/// # Errors
/// When the readings do not tell an ellipsoid.
///
/// # Source
/// Kwak 2018, §3.2 asks for an ellipsoid fit on a simple swing; the fit is ours. It is smaller than the one that phones
/// use (robust, iterated): a swing that is disturbed is refused here.
pub fn fit(readings_ut: &[[f32; 3]]) -> Result<Calibration, SwingRejection> {
    if readings_ut.len() < MIN_READINGS {
        return Err(SwingRejection::TooShort);
    }
    if readings_ut.iter().flatten().any(|c| c.is_nan() || c.abs() >= RANGE_UT) {
        return Err(SwingRejection::Saturated);
    }
    let (centre, radius_ut) = sphere(readings_ut).ok_or(SwingRejection::TooLittleCovered)?;
    let scaled = |m: &[f32; 3]| [0, 1, 2].map(|c| (f64::from(m[c]) - centre[c]) / radius_ut);
    if covered(readings_ut.iter().map(scaled)) < MIN_COVERED {
        return Err(SwingRejection::TooLittleCovered);
    }
    let (matrix, off) = quadric(readings_ut.iter().map(scaled)).ok_or(SwingRejection::TooDisturbed)?;
    let offset = [0, 1, 2].map(|c| centre[c] + radius_ut * off[c]);
    let strength = |m: &[f32; 3]| {
        let raw = [0, 1, 2].map(|c| f64::from(m[c]) - offset[c]);
        let v = matrix.map(|row| row[0] * raw[0] + row[1] * raw[1] + row[2] * raw[2]);
        libm::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    };
    let n = readings_ut.len() as f64;
    let mean_ut = readings_ut.iter().map(strength).sum::<f64>() / n;
    let square = |m: &[f32; 3]| (strength(m) - mean_ut) * (strength(m) - mean_ut);
    let residual_ut = libm::sqrt(readings_ut.iter().map(square).sum::<f64>() / n);
    if residual_ut.is_nan() || residual_ut > MAX_RESIDUAL_UT {
        return Err(SwingRejection::TooDisturbed);
    }
    let ([x, y, z], [[xx, xy, xz], [_, yy, yz], [_, _, zz]]) = (offset, matrix);
    let numbers = [x, y, z, xx, yy, zz, xy, xz, yz, mean_ut].map(|c| c as f32);
    Calibration::from_array(numbers).ok_or(SwingRejection::TooDisturbed)
}

/// Centre and radius of the sphere nearest to the readings: `|m|² = 2·o·m + (r² − |o|²)`, about the mean.
fn sphere(readings_ut: &[[f32; 3]]) -> Option<(Vector, f64)> {
    let n = readings_ut.len() as f64;
    let mean = [0, 1, 2].map(|c| readings_ut.iter().map(|m| f64::from(m[c])).sum::<f64>() / n);
    let (mut normal, mut right) = ([[0.0; 4]; 4], [0.0; 4]);
    for reading in readings_ut {
        let m = [0, 1, 2].map(|c| f64::from(reading[c]) - mean[c]);
        let square = m[0] * m[0] + m[1] * m[1] + m[2] * m[2];
        accumulate(&mut normal, &mut right, &[2.0 * m[0], 2.0 * m[1], 2.0 * m[2], 1.0], square);
    }
    let [x, y, z, rest] = solve(normal, right)?;
    let square = rest + x * x + y * y + z * z;
    (square > 1.0 && square.is_finite())
        .then(|| ([mean[0] + x, mean[1] + y, mean[2] + z], libm::sqrt(square)))
}

/// How many of the 24 cells of the sphere hold a reading: a cube's faces, each cut into four.
fn covered(scaled: impl Iterator<Item = Vector>) -> u32 {
    let mut cells = 0_u32;
    for v in scaled {
        let axis = (0..3).fold(0, |best, c| if v[c].abs() > v[best].abs() { c } else { best });
        let is_positive = |c: usize| u32::from(v[c % 3] > 0.0);
        cells |= 1
            << ((axis as u32 * 2 + is_positive(axis)) * 4
                + is_positive(axis + 1) * 2
                + is_positive(axis + 2));
    }
    cells.count_ones()
}

/// The symmetric matrix of determinant 1 that makes a sphere of the readings, and that sphere's centre.
fn quadric(scaled: impl Iterator<Item = Vector>) -> Option<(Matrix, Vector)> {
    // xᵀ·A·x + 2·b·x = 1, where A is the unit matrix and b nothing for the sphere that was found.
    let (mut normal, mut right) = ([[0.0; 9]; 9], [0.0; 9]);
    for [x, y, z] in scaled {
        let row = [x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z, 2.0 * x, 2.0 * y, 2.0 * z];
        accumulate(&mut normal, &mut right, &row, 1.0);
    }
    for c in 0..6 {
        normal[c][c] += PRIOR_WEIGHT;
        right[c] += if c < 3 { PRIOR_WEIGHT } else { 0.0 };
    }
    let [xx, yy, zz, xy, xz, yz, bx, by, bz] = solve(normal, right)?;
    let a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let inverse = inverse(a)?;
    let off = inverse.map(|row| -(row[0] * bx + row[1] * by + row[2] * bz));
    let root = square_root(a)?;
    let scale = libm::cbrt(determinant(root));
    let is_good = scale.is_finite() && scale > 0.0 && off.iter().all(|c| c.abs() < 0.5);
    is_good.then(|| (root.map(|row| row.map(|c| c / scale)), off))
}

fn accumulate<const N: usize>(normal: &mut [[f64; N]; N], right: &mut [f64; N], row: &[f64; N], value: f64) {
    for i in 0..N {
        right[i] += row[i] * value;
        for j in 0..N {
            normal[i][j] += row[i] * row[j];
        }
    }
}

/// Solves a symmetric, positive definite system by Cholesky's decomposition; nothing where it is not.
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    for j in 0..N {
        for k in 0..j {
            for i in j..N {
                a[i][j] -= a[i][k] * a[j][k];
            }
        }
        if a[j][j].is_nan() || a[j][j] <= 1e-9 {
            return None;
        }
        let root = libm::sqrt(a[j][j]);
        for row in a.iter_mut().skip(j) {
            row[j] /= root;
        }
    }
    for i in 0..N {
        for k in 0..i {
            b[i] -= a[i][k] * b[k];
        }
        b[i] /= a[i][i];
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            b[i] -= a[k][i] * b[k];
        }
        b[i] /= a[i][i];
    }
    b.iter().all(|c| c.is_finite()).then_some(b)
}

fn determinant(m: Matrix) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn inverse(m: Matrix) -> Option<Matrix> {
    let det = determinant(m);
    if det.is_nan() || det.abs() < 1e-9 {
        return None;
    }
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    Some([0, 1, 2].map(|r| [0, 1, 2].map(|c| minor(c, r) / det)))
}

/// The square root of a positive definite matrix by Denman and Beavers' iteration; nothing where it finds none.
fn square_root(m: Matrix) -> Option<Matrix> {
    let mean = |a: Matrix, b: Matrix| [0, 1, 2].map(|r| [0, 1, 2].map(|c| 0.5 * (a[r][c] + b[r][c])));
    let (mut y, mut z) = (m, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for _ in 0..12 {
        let (y_inverse, z_inverse) = (inverse(y)?, inverse(z)?);
        (y, z) = (mean(y, z_inverse), mean(z, y_inverse));
    }
    let is_root = (0..9).all(|k| {
        let (r, c) = (k / 3, k % 3);
        let square: f64 = (0..3).map(|i| y[r][i] * y[i][c]).sum();
        (square - m[r][c]).abs() < 1e-6
    });
    // Of a positive definite matrix the iteration finds the positive definite root.
    (is_root && y[0][0] > 0.0 && y[1][1] > 0.0 && y[2][2] > 0.0 && determinant(y) > 0.0).then_some(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings all over the sphere of 48 µT, bent by soft iron and moved by hard iron, off by up to `noise_ut`.
    fn readings(noise_ut: f64, n: usize, part: impl Fn(Vector) -> bool) -> impl Iterator<Item = [f32; 3]> {
        let mut chance = 1_u32;
        let mut next = move || {
            chance = chance.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(chance >> 8) / f64::from(1 << 23) - 1.0
        };
        // The golden spiral covers a sphere evenly.
        (0..n).filter_map(move |k| {
            let z = 1.0 - (2.0 * k as f64 + 1.0) / n as f64;
            let (sin, cos) = libm::sincos(2.399_963 * k as f64);
            let r = libm::sqrt(1.0 - z * z);
            let d = [r * cos, r * sin, z];
            let bent =
                [1.06 * d[0] + 0.03 * d[1], 0.03 * d[0] + 0.95 * d[1] - 0.02 * d[2], -0.02 * d[1] + d[2]];
            let off = [32.0, -110.0, 7.0];
            part(d).then(|| [0, 1, 2].map(|c| (48.0 * bent[c] + off[c] + noise_ut * next()) as f32))
        })
    }

    fn fitted(noise_ut: f64, n: usize, part: impl Fn(Vector) -> bool) -> Result<Calibration, SwingRejection> {
        let mut kept = [[0.0; 3]; 240];
        let mut n_kept = 0;
        for reading in readings(noise_ut, n, part) {
            kept[n_kept] = reading;
            n_kept += 1;
        }
        fit(&kept[..n_kept])
    }

    #[test]
    fn iron_is_found() {
        let calibration = fitted(0.0, 120, |_| true).unwrap();
        for (found, true_ut) in calibration.offset_ut.into_iter().zip([32.0, -110.0, 7.0]) {
            assert!((found - true_ut).abs() < 0.05, "{calibration:?}");
        }
        for reading in readings(0.0, 60, |_| true) {
            let strength_ut = crate::level::norm(calibration.apply(reading));
            assert!((strength_ut - calibration.strength_ut).abs() < 0.1, "{strength_ut}");
        }
        let noisy = fitted(2.0, 64, |_| true).unwrap();
        for (found, true_ut) in noisy.offset_ut.into_iter().zip([32.0, -110.0, 7.0]) {
            assert!((found - true_ut).abs() < 0.8, "{noisy:?}");
        }
    }

    #[test]
    fn half_a_sphere_is_enough_and_a_cap_is_not() {
        let half = fitted(0.5, 160, |d| d[0] > -0.1).unwrap();
        for (found, true_ut) in half.offset_ut.into_iter().zip([32.0, -110.0, 7.0]) {
            assert!((found - true_ut).abs() < 1.5, "{half:?}");
        }
        assert_eq!(fitted(0.5, 240, |d| d[0] > 0.8), Err(SwingRejection::TooShort));
        assert_eq!(fitted(0.0, 240, |d| d[0] > 0.7), Err(SwingRejection::TooLittleCovered));
    }

    #[test]
    fn a_poor_swing_is_refused() {
        assert_eq!(fit(&[[1.0, 2.0, 3.0]; 20]), Err(SwingRejection::TooShort));
        assert_eq!(fit(&[[1.0, 2.0, 3.0]; 60]), Err(SwingRejection::TooLittleCovered));
        assert_eq!(fit(&[[f32::NAN, 2.0, 3.0]; 60]), Err(SwingRejection::Saturated));
        assert_eq!(fit(&[[1_199.0, 2.0, 3.0]; 60]), Err(SwingRejection::Saturated));
        assert_eq!(fitted(12.0, 120, |_| true), Err(SwingRejection::TooDisturbed));
    }

    #[test]
    fn a_root_squared_is_the_matrix() {
        let root = square_root([[1.3, 0.1, 0.0], [0.1, 0.8, -0.05], [0.0, -0.05, 1.0]]).unwrap();
        let square: f64 = (0..3).map(|i| root[0][i] * root[i][1]).sum();
        assert!((square - 0.1).abs() < 1e-12);
        assert!(square_root([[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).is_none());
    }
}
