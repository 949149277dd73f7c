//! Collecting the readings of a swing.

use serde::{Deserialize, Serialize};

use super::ellipsoid::{EllipsoidParams, fit_ellipsoid};
use super::{MagnetometerCalibration, SwingAgain};
use crate::rotation::norm;
use crate::sensor::{Reading, Sample};
use crate::time::Timestamp;

/// Parameters of [`MagnetometerCalibrator`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CalibratorParams {
    /// The fit.
    pub ellipsoid: EllipsoidParams,
    /// Most readings kept; default 240. When they are full, near ones are thinned out.
    pub max_readings: usize,
    /// A reading nearer than this to one that is kept tells nothing new, in µT; default 2.
    pub spacing_ut: f64,
    /// The strongest field that turning alone moves, in µT; default 70: more change than the gyroscope's turn makes of
    /// it is a disturbance.
    pub max_strength_ut: f64,
    /// Change of a reading that noise makes, in µT; default 3.
    pub change_noise_ut: f64,
    /// Most of the readings that may be inconsistent with the gyroscope, 0 to 1; default 0.2.
    pub max_inconsistent: f64,
}

impl Default for CalibratorParams {
    fn default() -> Self {
        Self {
            ellipsoid: EllipsoidParams::default(),
            max_readings: 240,
            spacing_ut: 2.0,
            max_strength_ut: 70.0,
            change_noise_ut: 3.0,
            max_inconsistent: 0.2,
        }
    }
}

/// Collects raw fields while the device is swung, well apart from each other and in bounded memory, and fits them.
///
/// With a gyroscope, a reading that changed by more than the turn since the last one can make of it is left out and
/// counted: something other than the device moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MagnetometerCalibrator {
    params: CalibratorParams,
    readings_ut: Vec<[f64; 3]>,
    spacing_ut: f64,
    last: Option<(Timestamp, [f64; 3])>,
    last_rate: Option<(Timestamp, f64)>,
    /// Angle turned since the last field, in radians.
    turned_rad: f64,
    n_seen: u64,
    n_inconsistent: u64,
}

/// Longest time between two fields over which a turn is trusted, in seconds.
const MAX_GAP_S: f64 = 0.5;

impl MagnetometerCalibrator {
    /// A calibrator that has seen nothing.
    pub fn new(params: CalibratorParams) -> Self {
        Self {
            params,
            readings_ut: Vec::new(),
            spacing_ut: params.spacing_ut,
            last: None,
            last_rate: None,
            turned_rad: 0.0,
            n_seen: 0,
            n_inconsistent: 0,
        }
    }

    /// Consumes a sample: raw fields and angular rates count, implausible ones and other kinds do not.
    ///
    /// A calibrated field may be fitted too; a device should send one kind.
    pub fn push(&mut self, sample: &Sample) {
        if !sample.is_plausible() {
            return;
        }
        match sample.reading {
            Reading::AngularRate(rate) => {
                let rate_rad_s = norm(rate.map(f64::from));
                if let Some((last, last_rate_rad_s)) = self.last_rate {
                    let dt_s = sample.time.secs_since(last).clamp(0.0, MAX_GAP_S);
                    self.turned_rad += dt_s * rate_rad_s.max(last_rate_rad_s);
                }
                self.last_rate = Some((sample.time, rate_rad_s));
            }
            Reading::UncalibratedMagneticField { field_ut, .. } | Reading::MagneticField(field_ut) => {
                self.push_field(sample.time, field_ut.map(f64::from));
            }
            _ => {}
        }
    }

    /// Readings kept so far.
    pub fn n_readings(&self) -> usize {
        self.readings_ut.len()
    }

    /// The calibration by what was swung so far.
    ///
    /// # Errors
    /// When the swing was not good enough, with what to do about it.
    pub fn calibration(&self) -> Result<MagnetometerCalibration, SwingAgain> {
        let fit = fit_ellipsoid(&self.readings_ut, &self.params.ellipsoid)?;
        if self.n_inconsistent as f64 > self.params.max_inconsistent * self.n_seen as f64 {
            return Err(SwingAgain::TooDisturbed { residual_ut: fit.quality.residual_ut });
        }
        Ok(fit)
    }

    fn push_field(&mut self, time: Timestamp, field_ut: [f64; 3]) {
        let turned_rad = core::mem::take(&mut self.turned_rad);
        let last = self.last.replace((time, field_ut));
        self.n_seen += 1;
        let has_gyroscope =
            self.last_rate.is_some_and(|(rate_time, _)| time.secs_since(rate_time).abs() < MAX_GAP_S);
        if let Some((last_time, last_ut)) = last {
            let change_ut = norm([0, 1, 2].map(|c| field_ut[c] - last_ut[c]));
            let explained_ut = self.params.change_noise_ut + self.params.max_strength_ut * turned_rad;
            let is_near = (0.0..MAX_GAP_S).contains(&time.secs_since(last_time));
            if has_gyroscope && is_near && change_ut > explained_ut {
                self.n_inconsistent += 1;
                return;
            }
        }
        self.keep(field_ut);
    }

    fn keep(&mut self, field_ut: [f64; 3]) {
        if !is_apart(&self.readings_ut, field_ut, self.spacing_ut) {
            return;
        }
        self.readings_ut.push(field_ut);
        while self.readings_ut.len() > self.params.max_readings.max(1) {
            self.spacing_ut *= 1.25;
            let mut thinned: Vec<[f64; 3]> = Vec::with_capacity(self.readings_ut.len());
            for &reading in &self.readings_ut {
                if is_apart(&thinned, reading, self.spacing_ut) {
                    thinned.push(reading);
                }
            }
            self.readings_ut = thinned;
        }
    }
}

fn is_apart(readings_ut: &[[f64; 3]], field_ut: [f64; 3], spacing_ut: f64) -> bool {
    readings_ut.iter().all(|kept| norm([0, 1, 2].map(|c| kept[c] - field_ut[c])) >= spacing_ut)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::Quaternion;

    /// A swing about all axes at 50 Hz, for `seconds`, with 40 µT of hard iron along x.
    fn swing(calibrator: &mut MagnetometerCalibrator, seconds: f64, disturbance_ut: impl Fn(f64) -> f64) {
        let mut earth_from_device = Quaternion::IDENTITY;
        for k in 0..(seconds * 50.0) as i64 {
            let t = k as f64 * 0.02;
            let rate = [3.0 * libm::sin(1.1 * t), 2.5 * libm::cos(0.7 * t), 2.0 * libm::sin(0.4 * t)];
            earth_from_device = earth_from_device.turned(rate.map(|c| c * 0.02));
            let mut field = earth_from_device.rotate_back([0.0, 22.0, -42.0]);
            field[0] += 40.0 + disturbance_ut(t);
            let time = Timestamp::from_millis(20 * k);
            let field_ut = field.map(|c| c as f32);
            for reading in [
                Reading::AngularRate(rate.map(|c| c as f32)),
                Reading::UncalibratedMagneticField { field_ut, bias_ut: [0.0; 3] },
            ] {
                calibrator.push(&Sample { time, reading });
            }
        }
    }

    #[test]
    fn a_good_swing_is_accepted_and_memory_stays_bounded() {
        let params = CalibratorParams { max_readings: 60, ..CalibratorParams::default() };
        let mut calibrator = MagnetometerCalibrator::new(params);
        swing(&mut calibrator, 60.0, |_| 0.0);
        assert!((30..=60).contains(&calibrator.n_readings()), "{}", calibrator.n_readings());
        let fit = calibrator.calibration().unwrap();
        assert!((fit.offset_ut[0] - 40.0).abs() < 0.1, "{fit:?}");
        assert!((fit.quality.strength_ut - 47.41).abs() < 0.1, "{fit:?}");
    }

    #[test]
    fn a_short_swing_is_refused() {
        let mut calibrator = MagnetometerCalibrator::new(CalibratorParams::default());
        swing(&mut calibrator, 0.4, |_| 0.0);
        assert!(matches!(calibrator.calibration(), Err(SwingAgain::TooShort { .. })));
    }

    #[test]
    fn a_field_that_changes_by_itself_is_refused() {
        let mut calibrator = MagnetometerCalibrator::new(CalibratorParams::default());
        // A magnet comes and goes twice a second.
        swing(&mut calibrator, 30.0, |t| if (2.0 * t).fract() < 0.5 { 60.0 } else { 0.0 });
        assert!(calibrator.calibration().is_err());
        assert!(calibrator.n_inconsistent > 50, "{}", calibrator.n_inconsistent);
    }

    #[test]
    fn time_that_goes_backwards_and_nonsense_do_no_harm() {
        let mut calibrator = MagnetometerCalibrator::new(CalibratorParams::default());
        swing(&mut calibrator, 10.0, |_| 0.0);
        let time = Timestamp::MIN;
        calibrator.push(&Sample { time, reading: Reading::AngularRate([1.0; 3]) });
        calibrator.push(&Sample { time, reading: Reading::MagneticField([f32::NAN; 3]) });
        swing(&mut calibrator, 20.0, |_| 0.0);
        assert!(calibrator.calibration().is_ok(), "{:?}", calibrator.calibration());
    }
}
