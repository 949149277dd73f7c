//! The covariance of the fused heading's errors, and its corrections.

use nalgebra::{Matrix3, RowSVector, SMatrix, SVector, Vector3};

/// Number of errors.
const N: usize = 11;

/// Where the rotation error (three, earth frame, radians) begins.
pub(super) const ROTATION: usize = 0;
/// Where the gyroscope's bias (three, device frame, rad/s) begins.
pub(super) const BIAS: usize = 3;
/// Where the hard iron (three, device frame, µT) begins.
pub(super) const HARD_IRON: usize = 6;
/// Where the usual field (horizontal and vertical part, µT) begins.
pub(super) const FIELD: usize = 9;

/// How a reading depends on the errors.
pub(super) type Row = RowSVector<f64, N>;
/// The errors themselves: true value less estimate; the rotation turns the estimate to the truth.
pub(super) type Errors = SVector<f64, N>;

/// The covariance of the errors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ErrorState {
    covariance: SMatrix<f64, N, N>,
}

impl Default for ErrorState {
    fn default() -> Self {
        Self { covariance: SMatrix::zeros() }
    }
}

impl ErrorState {
    /// Independent errors with these variances; what reaches beyond the last error is left out.
    pub(super) fn from_variances(variances: [(usize, [f64; 3]); 4]) -> Self {
        let mut state = Self::default();
        for (start, values) in variances {
            for (c, value) in (start..N).zip(values) {
                state.covariance[(c, c)] = value;
            }
        }
        state
    }

    /// Variance of one error.
    pub(super) fn variance(&self, index: usize) -> f64 {
        self.covariance[(index, index)]
    }

    /// Lets the bias turn the rotation error: it grows by `−bias_to_angle_s · bias`.
    pub(super) fn turn(&mut self, bias_to_angle_s: &Matrix3<f64>) {
        let bias_rows: SMatrix<f64, 3, N> = self.covariance.fixed_view::<3, N>(BIAS, 0).into();
        let mut rotation_rows = self.covariance.fixed_view_mut::<3, N>(ROTATION, 0);
        rotation_rows -= bias_to_angle_s * bias_rows;
        let bias_columns: SMatrix<f64, N, 3> = self.covariance.fixed_view::<N, 3>(0, BIAS).into();
        let mut rotation_columns = self.covariance.fixed_view_mut::<N, 3>(0, ROTATION);
        rotation_columns -= bias_columns * bias_to_angle_s.transpose();
    }

    /// Adds to the variances of the errors from `start` on (three, or what there is), up to `most`.
    pub(super) fn add_variance(&mut self, start: usize, variance: f64, most: f64) {
        for c in (start..N).take(3) {
            let now = self.covariance[(c, c)];
            self.covariance[(c, c)] = (now + variance).min(most.max(now));
        }
    }

    /// The errors that `innovation = row·errors + noise` of this variance implies; zero where it implies nothing.
    pub(super) fn correct(&mut self, row: &Row, innovation: f64, variance: f64) -> Errors {
        let cross: Errors = self.covariance * row.transpose();
        let total = (row * cross)[0] + variance;
        if !(total > 0.0 && total.is_finite() && innovation.is_finite()) {
            return Errors::zeros();
        }
        let gain = cross / total;
        self.covariance -= gain * cross.transpose();
        gain * innovation
    }

    /// The squared length of `innovation`, in units of what the errors and noise of this variance make it.
    pub(super) fn mahalanobis2(&self, rows: &[Row; 3], innovation: &Vector3<f64>, variance: f64) -> f64 {
        let rows = SMatrix::<f64, 3, N>::from_rows(rows);
        let total = rows * self.covariance * rows.transpose() + Matrix3::from_diagonal_element(variance);
        total.try_inverse().map_or(0.0, |inverse| (innovation.transpose() * inverse * innovation)[0].max(0.0))
    }

    /// As [`ErrorState::correct`], by three readings with independent noise at once.
    pub(super) fn correct_three(
        &mut self,
        rows: &[Row; 3],
        innovation: &Vector3<f64>,
        variance: f64,
    ) -> Errors {
        let rows = SMatrix::<f64, 3, N>::from_rows(rows);
        let cross: SMatrix<f64, N, 3> = self.covariance * rows.transpose();
        let total = rows * cross + Matrix3::from_diagonal_element(variance);
        let Some(inverse) = total.try_inverse() else { return Errors::zeros() };
        let gain = cross * inverse;
        let errors = gain * innovation;
        if !errors.iter().all(|e| e.is_finite()) {
            return Errors::zeros();
        }
        self.covariance -= gain * cross.transpose();
        // Rounding must not let the two halves drift apart.
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        errors
    }
}
