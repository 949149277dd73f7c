//! The phone's step detector: for a phone in hand, pocket, bag or pouch, on an arm or swinging with it.

use serde::{Deserialize, Serialize};

use crate::gravity::STANDARD_GRAVITY_M_S2;
use crate::step::extrema::{Extrema, Turn};
use crate::step::rhythm::{Rhythm, RhythmParams};
use crate::step::{StepCycle, StepDetector, StepFinding, is_usable};
use crate::time::{Duration, Timestamp};

/// Parameters of [`PhoneStepDetector`].
///
/// Found on the runs of the Oxford step-counting collection, where the count hardly depends on them (a fifth more or
/// less of any changes the mean error by less than one percent), and on hands that moved without walking.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhoneStepParams {
    /// Cut-off of each of the two low-pass stages, in Hz; default 2.9: above the fastest walk's cadence.
    pub cutoff_hz: f32,
    /// Least peak-to-trough amplitude of a step, in m/s²; default 0.9 (a slow walk in hand gives about 2).
    pub min_amplitude_m_s2: f32,
    /// Most, in m/s²; default 30 (running with the phone in hand reaches about 20).
    pub max_amplitude_m_s2: f32,
    /// Least amplitude as a fraction of the recent mean; default 0.35.
    pub min_relative_amplitude: f32,
    /// The same for a peak that comes after half the recent mean period; default 0.8: the rebound of a slow step.
    pub min_early_amplitude: f32,
    /// Least time between steps, in seconds; default 0.28 (running reaches 3.5 Hz).
    pub min_period_s: f64,
    /// Least mean time between steps, in seconds; default 0.325 (runners keep to 3 Hz, hands that shake do not).
    pub min_mean_period_s: f32,
    /// A longer gap ends the walk; default 1.4 s.
    pub max_period_s: f64,
    /// The period assumed for the first step of a walk, in seconds; default 0.55.
    pub first_period_s: f64,
    /// Peaks farther apart than this, in seconds, are a limb's, one in two steps, where the next two are exceeded as
    /// well; default 0.8.
    pub stride_period_s: f64,
    /// Least amplitude of such a peak, in m/s²; default 3.
    pub stride_amplitude_m_s2: f32,
    /// Horizontal acceleration (root mean square) that only a limb has, in m/s²; default 2.4.
    pub stride_swing_m_s2: f32,
    /// Most of the horizontal over the vertical acceleration (root mean squares); default 8 (a lazily swinging arm has 5).
    pub max_swing_ratio: f32,
    /// What makes a row of peaks a walk.
    pub rhythm: RhythmParams,
}

impl Default for PhoneStepParams {
    fn default() -> Self {
        Self {
            cutoff_hz: 2.9,
            min_amplitude_m_s2: 0.9,
            max_amplitude_m_s2: 30.0,
            min_relative_amplitude: 0.35,
            min_early_amplitude: 0.8,
            min_period_s: 0.28,
            min_mean_period_s: 0.325,
            max_period_s: 1.4,
            first_period_s: 0.55,
            stride_period_s: 0.8,
            stride_amplitude_m_s2: 3.0,
            stride_swing_m_s2: 2.4,
            max_swing_ratio: 8.0,
            rhythm: RhythmParams::default(),
        }
    }
}

/// Finds steps as alternating peaks and troughs of the low-passed vertical acceleration, causally.
///
/// A peak shows once the signal has fallen from it by a part of the recent amplitude, about a tenth of a second later.
/// From standing, steps are held back until three in a row have a rhythm; while it lasts, each counts at once.
///
/// In a swinging hand the arm's acceleration, once a stride, may drown every other step. A slow and strong peak amid
/// strong horizontal swinging therefore stands for two steps.
///
/// A hand can imitate walking: even strokes up and down, one to three a second and no stronger than a runner's, are
/// counted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhoneStepDetector {
    params: PhoneStepParams,
    last_time: Option<Timestamp>,
    signal: Option<Signal>,
    last_peak: Option<Timestamp>,
    /// The last peak of any amplitude that a step may have, and how many in a row came too fast for steps.
    last_strong: Option<Timestamp>,
    n_fast: u8,
    mean_amplitude_m_s2: f32,
    /// Zero until there is one.
    mean_period_s: f32,
    rhythm: Rhythm,
}

/// The filtered acceleration since the recording or its last gap began, and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Signal {
    /// After one and two low-pass stages: the two horizontal axes, then the vertical one without gravity.
    stages_m_s2: [[f32; 3]; 2],
    /// Slow part of the horizontal axes.
    offset_m_s2: [f32; 2],
    /// Mean squares over about a second: horizontal without its slow part, vertical.
    horizontal_m2_s4: f32,
    vertical_m2_s4: f32,
    extrema: Extrema,
    /// When it began, when it was last lively, and whether the wearer has been seen to stand.
    began: Timestamp,
    last_lively: Timestamp,
    has_stood: bool,
}

/// Time constants of the horizontal axes' slow part (half a hertz) and of the mean squares, in seconds.
const OFFSET_TAU_S: f32 = 0.32;
const POWER_TAU_S: f32 = 0.7;
/// Share of the latest step in the mean amplitude and period.
const LATEST_SHARE: f32 = 0.25;
/// A peak of at least this share of the mean amplitude is no ripple; more of them in a row than this, each sooner than
/// the least period after the last, are a shaken phone.
const STRONG_SHARE: f32 = 0.6;
const MAX_FAST: u8 = 1;
/// A silence longer than this, in seconds, is a gap in the recording.
const MAX_SILENCE_S: f32 = 1.0;
/// A stride lasts at least this many mean periods.
const STRIDE_SHARE: f32 = 1.5;
/// Who stands has no vertical acceleration for this long, in seconds; a step crosses zero within less.
const STILL_S: f64 = 0.45;
/// A peak sooner than this share of the mean period is early, and after half of it as early as can be.
const EARLY_SHARE: f32 = 0.75;

impl PhoneStepDetector {
    /// A detector that has seen nothing.
    pub fn new(params: PhoneStepParams) -> Self {
        Self {
            params,
            last_time: None,
            signal: None,
            last_peak: None,
            last_strong: None,
            n_fast: 0,
            mean_amplitude_m_s2: 0.0,
            mean_period_s: 0.0,
            rhythm: Rhythm::default(),
        }
    }

    /// The parameters.
    pub fn params(&self) -> &PhoneStepParams {
        &self.params
    }

    fn judge_peak(&mut self, peak: Timestamp, amplitude: f32) -> Option<StepFinding> {
        let params = self.params;
        // A peak in the future is from before the clock was set back.
        let since_s = self.last_peak.map(|last| peak.secs_since(last)).filter(|&s| s >= 0.0);
        let since_s = since_s.filter(|&s| s <= params.max_period_s);
        if since_s.is_none() {
            (self.mean_amplitude_m_s2, self.mean_period_s) = (0.0, 0.0);
        }
        if amplitude < self.least_amplitude(since_s) {
            return None;
        }
        if self.is_shaken(peak, amplitude) {
            self.rhythm.reset();
            self.last_peak = Some(peak);
            (self.mean_amplitude_m_s2, self.mean_period_s) = (amplitude, 0.0);
            return None;
        }
        if since_s.is_some_and(|s| s < params.min_period_s) {
            return None;
        }
        let swing = self.signal.map_or((0.0, 0.0), |s| (s.horizontal_m2_s4, s.vertical_m2_s4));
        let is_sideways = swing.0 > params.max_swing_ratio * params.max_swing_ratio * swing.1;
        if amplitude > params.max_amplitude_m_s2 || is_sideways {
            self.rhythm.reset();
            self.last_peak = None;
            return None;
        }
        let is_limb = swing.0 > params.stride_swing_m_s2 * params.stride_swing_m_s2;
        let is_stride = is_limb
            && amplitude > params.stride_amplitude_m_s2
            && since_s.is_some_and(|s| self.is_two_steps(s));
        self.finding(peak, amplitude, since_s, is_stride)
    }

    /// Whether a gap this long is a stride: the steps before it were half as long, or were none but strides.
    ///
    /// The longer step of an uneven pair is neither.
    fn is_two_steps(&self, gap_s: f64) -> bool {
        let stride_s = self.params.stride_period_s as f32;
        gap_s > self.params.stride_period_s
            && (gap_s as f32 > STRIDE_SHARE * self.mean_period_s || self.mean_period_s > stride_s)
    }

    fn finding(
        &mut self,
        peak: Timestamp,
        amplitude: f32,
        since_s: Option<f64>,
        is_stride: bool,
    ) -> Option<StepFinding> {
        let n_steps = if is_stride { 2 } else { 1 };
        let period_s = since_s.map(|s| s as f32 / f32::from(n_steps));
        if let Some(period_s) = period_s {
            let share = if self.mean_period_s > 0.0 { LATEST_SHARE } else { 1.0 };
            self.mean_period_s += share * (period_s - self.mean_period_s);
        }
        let share = if since_s.is_some() { LATEST_SHARE } else { 1.0 };
        self.mean_amplitude_m_s2 += share * (amplitude - self.mean_amplitude_m_s2);
        self.last_peak = Some(peak);
        if period_s.is_some() && self.mean_period_s < self.params.min_mean_period_s {
            self.rhythm.reset();
            return None;
        }
        let verdict = self.rhythm.judge(&self.params.rhythm, period_s, amplitude, n_steps);
        let under_way_s = if since_s.is_none() { self.under_way_s(peak) } else { None };
        let cycle_s = since_s.or(under_way_s).unwrap_or(self.params.first_period_s);
        let cycle = StepCycle::between(peak - Duration::from_secs_f64(cycle_s), peak, amplitude);
        Some(StepFinding {
            cycle: StepCycle { is_first: since_s.or(under_way_s).is_none(), ..cycle },
            is_under_way: under_way_s.is_some(),
            is_stride,
            n_held: verdict.n_held,
            is_confirmed: verdict.is_confirmed,
            starts_walk: verdict.starts_walk,
        })
    }

    /// How long the wearer has walked by the first peak when the recording began amid a walk: nobody stood before it.
    fn under_way_s(&self, peak: Timestamp) -> Option<f64> {
        let signal = self.signal.filter(|signal| !signal.has_stood)?;
        let walked_s = peak.secs_since(signal.began);
        (walked_s <= self.params.max_period_s).then(|| walked_s.max(f64::from(self.params.min_mean_period_s)))
    }

    /// The least amplitude of a step so long after the last: early ones must be nearly as strong as the mean.
    fn least_amplitude(&self, since_s: Option<f64>) -> f32 {
        let params = &self.params;
        let mut relative = params.min_relative_amplitude;
        if let Some(s) = since_s.filter(|_| self.mean_period_s > 0.0) {
            let early = (EARLY_SHARE - s as f32 / self.mean_period_s) / (EARLY_SHARE - 0.5);
            relative += (params.min_early_amplitude - relative) * early.clamp(0.0, 1.0);
        }
        params.min_amplitude_m_s2.max(relative * self.mean_amplitude_m_s2)
    }

    /// Whether strong peaks follow each other faster than any steps.
    fn is_shaken(&mut self, peak: Timestamp, amplitude: f32) -> bool {
        if amplitude > STRONG_SHARE * self.mean_amplitude_m_s2 {
            let is_fast = self.last_strong.replace(peak).is_some_and(|last| {
                let apart_s = peak.secs_since(last);
                (0.0..self.params.min_period_s).contains(&apart_s)
            });
            self.n_fast = if is_fast { self.n_fast.saturating_add(1) } else { 0 };
        }
        self.n_fast > MAX_FAST
    }
}

impl StepDetector for PhoneStepDetector {
    fn push(&mut self, time: Timestamp, level_force_m_s2: [f32; 3]) -> Option<StepFinding> {
        if !is_usable(level_force_m_s2) {
            return None;
        }
        let [x, y, z] = level_force_m_s2;
        let input = [x, y, z - STANDARD_GRAVITY_M_S2];
        let dt_s = self.last_time.replace(time).map_or(f32::MAX, |last| time.secs_since(last) as f32);
        let Some(signal) = self.signal.as_mut().filter(|_| (0.0..MAX_SILENCE_S).contains(&dt_s)) else {
            self.signal = Some(Signal::new(time, input));
            self.last_peak = None;
            return None;
        };
        let params = &self.params;
        let vertical = signal.update(input, dt_s, params.cutoff_hz);
        signal.watch(time, vertical, 0.5 * params.min_amplitude_m_s2);
        let hysteresis = (0.3 * self.mean_amplitude_m_s2).max(0.5 * params.min_amplitude_m_s2);
        match signal.extrema.push(time, vertical, hysteresis) {
            Some(Turn::Peak { time: peak, amplitude }) => self.judge_peak(peak, amplitude),
            _ => None,
        }
    }
}

impl Signal {
    /// A signal that starts at rest: `input` is taken for what the horizontal axes always had.
    fn new(time: Timestamp, input: [f32; 3]) -> Self {
        let at_rest = [input[0], input[1], 0.0];
        Self {
            stages_m_s2: [at_rest; 2],
            offset_m_s2: [input[0], input[1]],
            horizontal_m2_s4: 0.0,
            vertical_m2_s4: 0.0,
            extrema: Extrema::new(time, 0.0),
            began: time,
            last_lively: time,
            has_stood: false,
        }
    }

    /// Sees the wearer stand where the filtered acceleration stays within `still_m_s2` for long enough.
    fn watch(&mut self, time: Timestamp, vertical_m_s2: f32, still_m_s2: f32) {
        if vertical_m_s2.abs() > still_m_s2 {
            self.last_lively = time;
        }
        self.has_stood |= time.secs_since(self.last_lively) >= STILL_S;
    }

    /// Feeds `input`, `dt_s` after the last; returns the filtered vertical acceleration.
    fn update(&mut self, input: [f32; 3], dt_s: f32, cutoff_hz: f32) -> f32 {
        // The exact share of a first-order filter: the same at every sampling rate.
        let share = |tau_s: f32| -libm::expm1f(-dt_s / tau_s);
        let a = share(1.0 / (core::f32::consts::TAU * cutoff_hz));
        let [first, second] = &mut self.stages_m_s2;
        for c in 0..3 {
            first[c] += a * (input[c] - first[c]);
            second[c] += a * (first[c] - second[c]);
        }
        let [x, y, vertical] = *second;
        let (slow, power) = (share(OFFSET_TAU_S), share(POWER_TAU_S));
        self.offset_m_s2[0] += slow * (x - self.offset_m_s2[0]);
        self.offset_m_s2[1] += slow * (y - self.offset_m_s2[1]);
        let swing = [x - self.offset_m_s2[0], y - self.offset_m_s2[1]];
        let horizontal_m2_s4 = swing[0] * swing[0] + swing[1] * swing[1];
        self.horizontal_m2_s4 += power * (horizontal_m2_s4 - self.horizontal_m2_s4);
        self.vertical_m2_s4 += power * (vertical * vertical - self.vertical_m2_s4);
        vertical
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::StepQueue;

    /// The steps that count of a recording at 50 Hz that begins `standing_s` before its walk of 1.6 steps a second: their
    /// starts and ends, in seconds, and whether each is a first one.
    fn steps(standing_s: f64) -> Vec<(f64, f64, bool)> {
        let mut detector = PhoneStepDetector::new(PhoneStepParams::default());
        let mut queue = StepQueue::new();
        let origin = Timestamp::from_millis(0);
        let mut steps = Vec::new();
        for k in 0..400 {
            let time = Timestamp::from_millis(20 * k);
            let walking_s = time.secs_since(origin) - standing_s;
            let bob =
                if walking_s < 0.0 { 0.0 } else { 2.0 * libm::sin(core::f64::consts::TAU * 1.6 * walking_s) };
            let force = [0.0, 0.0, STANDARD_GRAVITY_M_S2 + bob as f32];
            if let Some(finding) = detector.push(time, force) {
                queue.push(&finding, (), detector.params().first_period_s);
            }
            while let Some((cycle, ())) = queue.pop() {
                steps.push((cycle.start.secs_since(origin), cycle.end.secs_since(origin), cycle.is_first));
            }
        }
        steps
    }

    #[test]
    fn a_recording_that_begins_amid_a_walk_has_no_first_step() {
        let (start_s, end_s, is_first) = steps(0.0)[0];
        // The first peak is a quarter of a period after the start and a tenth of a second of filtering; the least mean
        // period is 0.325 s.
        assert!(!is_first && (end_s - start_s - 0.325).abs() < 0.02, "{start_s} {end_s}");
        assert!((0.2..0.35).contains(&end_s), "{end_s}");
        // A tenth of a second is too short to have stood.
        let (start_s, end_s, is_first) = steps(0.1)[0];
        assert!(!is_first && (-0.02..0.02).contains(&start_s) && end_s > 0.325, "{start_s} {end_s}");
    }

    #[test]
    fn who_stood_before_walking_makes_a_first_step() {
        for standing_s in [0.6, 3.0] {
            let (start_s, end_s, is_first) = steps(standing_s)[0];
            assert!(is_first && (end_s - start_s - 0.55).abs() < 1e-6, "{standing_s}: {start_s} {end_s}");
        }
    }
}
