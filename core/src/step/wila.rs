//! The step detector of a wearable at the waist: a long linear-phase filter, then peak and trough.

use serde::{Deserialize, Serialize};

use crate::gravity::STANDARD_GRAVITY_M_S2;
use crate::step::extrema::{Extrema, Turn};
use crate::step::fixed_rate::FixedRate;
use crate::step::low_pass_fir::LowPassFir;
use crate::step::{StepCycle, StepDetector, StepFinding, is_usable};
use crate::time::{Duration, Timestamp};

/// Parameters of [`WilaStepDetector`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WilaStepParams {
    /// Least difference of a peak and the trough after it, in m/s²; default 0.35 (the paper gives none: the first and
    /// the last step of a slow walk have about 0.5 at the waist, standing less than 0.3).
    pub threshold_m_s2: f32,
    /// A longer gap ends the walk, in seconds; default 1.7.
    pub max_period_s: f64,
    /// The period assumed for the first step of a walk, in seconds; default 0.55.
    pub first_period_s: f64,
}

impl Default for WilaStepParams {
    fn default() -> Self {
        Self { threshold_m_s2: 0.35, max_period_s: 1.7, first_period_s: 0.55 }
    }
}

/// Reading rate, taps and cut-off of the filter.
const READING_PERIOD: Duration = Duration::from_millis(20);
const RATE_HZ: f64 = 50.0;
const CUTOFF_HZ: f64 = 5.0;
const TAPS: usize = 51;
/// The filter's delay.
const DELAY: Duration = Duration::from_millis(500);
/// A gap longer than this fills the filter anew.
const MAX_GAP: Duration = Duration::from_millis(400);

/// Finds steps as peaks and the troughs after them in the vertical acceleration below 5 Hz.
///
/// A step is known at its trough, half a second late: the price of linear phase.
///
/// # Source
/// WILA 2016, Eq. 1, and steps 1 to 4 of its section 3.1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WilaStepDetector {
    params: WilaStepParams,
    readings: FixedRate<1>,
    filter: LowPassFir<TAPS>,
    extrema: Option<Extrema>,
    peak: Option<Timestamp>,
    last_step: Option<Timestamp>,
}

impl WilaStepDetector {
    /// A detector that has seen nothing.
    pub fn new(params: WilaStepParams) -> Self {
        Self {
            params,
            readings: FixedRate::new(READING_PERIOD, MAX_GAP),
            filter: LowPassFir::new(CUTOFF_HZ, RATE_HZ),
            extrema: None,
            peak: None,
            last_step: None,
        }
    }
}

impl StepDetector for WilaStepDetector {
    fn push(&mut self, time: Timestamp, level_force_m_s2: [f32; 3]) -> Option<StepFinding> {
        if !is_usable(level_force_m_s2) {
            return None;
        }
        if self.readings.starts_anew(time) {
            self.filter.reset();
            (self.extrema, self.peak, self.last_step) = (None, None, None);
        }
        let Self { params, readings, filter, extrema, peak, .. } = self;
        let mut step = None;
        readings.push(time, [level_force_m_s2[2] - STANDARD_GRAVITY_M_S2], |at, [reading]| {
            let at = at - DELAY;
            let value = filter.push(reading);
            let extrema = extrema.get_or_insert_with(|| Extrema::new(at, value));
            match extrema.push(at, value, params.threshold_m_s2) {
                Some(Turn::Peak { time, .. }) => *peak = Some(time),
                Some(Turn::Trough { depth, .. }) => {
                    step = peak.take().map(|peak| (peak, depth)).or(step);
                }
                // The last step of a walk fades out into standing: no rise shows its trough.
                None if peak.is_some_and(|peak| at.secs_since(peak) > 0.5 * params.max_period_s) => {
                    step = peak.take().map(|peak| (peak, extrema.fallen())).or(step);
                }
                None => {}
            }
        });
        let (end, amplitude) = step?;
        let since_s = self.last_step.replace(end).map(|last| end.secs_since(last));
        let since_s = since_s.filter(|s| (0.0..=params.max_period_s).contains(s));
        let start = end - Duration::from_secs_f64(since_s.unwrap_or(params.first_period_s));
        let cycle = StepCycle::between(start, end, amplitude);
        Some(StepFinding::immediate(StepCycle { is_first: since_s.is_none(), ..cycle }))
    }
}
