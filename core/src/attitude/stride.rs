//! Cuts the specific force into strides of two steps, from vertical peak to vertical peak.

use serde::{Deserialize, Serialize};

use super::table::FeatureEvents;
use crate::step::StepCycle;
use crate::time::{Duration, Timestamp};

/// What the specific force did during a stride, in the device frame.
///
/// Index 0 is the x axis, to the right of the screen, index 1 the y axis, to its top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stride {
    /// The vertical peak that ends it.
    pub end: Timestamp,
    /// Its two steps' time, in seconds.
    pub period_s: f32,
    /// Mean specific force over it, device frame, in m/s².
    pub mean_m_s2: [f32; 3],
    /// When the axis peaks within a step, 0 to 1 of the step, by its wave at the step's frequency.
    pub peak_phase: [f32; 2],
    /// Amplitude of the axis at one cycle a stride, in m/s².
    pub per_stride_m_s2: [f32; 2],
    /// Amplitude of the axis at two cycles a stride, one a step, in m/s².
    pub per_step_m_s2: [f32; 2],
}

impl Stride {
    /// The feature events that it shows.
    ///
    /// # Source
    /// Mass-centred 2019, Alg. 2. E1 by the phase of the wave, since a peak near the cut would else fall now on one side
    /// of it and now on the other; E3 by the amplitudes at the stride's and the step's frequency, since to be higher or
    /// lower than both neighbours happens by chance two times in three.
    pub fn events(&self) -> FeatureEvents {
        FeatureEvents::new(
            self.peak_phase[1] > 0.5,
            self.mean_m_s2[1] > self.mean_m_s2[0],
            self.per_stride_m_s2[0] > self.per_step_m_s2[0],
        )
    }

    /// The same stride had the phone been turned a quarter to the left about its screen's normal, so that its top edge
    /// points left where it pointed ahead.
    #[must_use]
    pub fn turned_left(&self) -> Self {
        // The new x axis lies where y was, the new y axis where -x was.
        Self {
            mean_m_s2: [self.mean_m_s2[1], -self.mean_m_s2[0], self.mean_m_s2[2]],
            peak_phase: [self.peak_phase[1], (self.peak_phase[0] + 0.5) % 1.0],
            per_stride_m_s2: [self.per_stride_m_s2[1], self.per_stride_m_s2[0]],
            per_step_m_s2: [self.per_step_m_s2[1], self.per_step_m_s2[0]],
            ..*self
        }
    }
}

/// Cut-off of each of the two low-pass stages, in Hz: passes the step and the stride, stops the heel's jolt.
const CUTOFF_HZ: f32 = 3.5;
/// Samples are kept at most this often, in seconds.
const SPACING_S: f64 = 0.018;
/// Samples kept: three seconds at that spacing, which two slow steps and the detector's delay fill.
const N_KEPT: usize = 168;
/// A step shorter or longer than this is none of a walk, in seconds.
const STEP_PERIOD_S: core::ops::RangeInclusive<f64> = 0.2..=1.4;

/// Remembers the filtered force of the last seconds and cuts the latest stride out of it.
///
/// Steps come from a step detector; the cut is at the filtered vertical's own peak near the detector's, so that peaks
/// along other axes, which the same filter has delayed alike, keep their place in the step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StrideCutter {
    /// Low-pass stages of x, y, z and the vertical.
    stages: [[f32; 4]; 2],
    last_time: Option<Timestamp>,
    kept: Vec<Kept>,
    next: usize,
    peaks: [Option<Timestamp>; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Kept {
    time: Timestamp,
    /// Specific force along x, y, z (device frame) and the vertical, filtered, in m/s².
    force_m_s2: [f32; 4],
}

const NOTHING_KEPT: Kept = Kept { time: Timestamp::MIN, force_m_s2: [0.0; 4] };

impl Default for StrideCutter {
    fn default() -> Self {
        Self {
            stages: [[0.0; 4]; 2],
            last_time: None,
            kept: vec![NOTHING_KEPT; N_KEPT],
            next: 0,
            peaks: [None; 3],
        }
    }
}

impl StrideCutter {
    /// Takes in a specific force (device frame) and its vertical component, in m/s².
    pub fn push_force(&mut self, time: Timestamp, force_m_s2: [f32; 3], vertical_m_s2: f32) {
        let input = [force_m_s2[0], force_m_s2[1], force_m_s2[2], vertical_m_s2];
        if !input.iter().all(|c| c.is_finite()) {
            return;
        }
        let dt_s = self.last_time.map(|last| time.secs_since(last));
        self.last_time = Some(time);
        let Some(dt_s) = dt_s.filter(|dt_s| (0.0..1.0).contains(dt_s)) else {
            // The first sample, a gap, or a clock set back: what is kept is of another walk.
            self.stages = [input; 2];
            self.kept.fill(NOTHING_KEPT);
            self.peaks = [None; 3];
            return;
        };
        let tau_s = 1.0 / (core::f32::consts::TAU * CUTOFF_HZ);
        let a = dt_s as f32 / (tau_s + dt_s as f32);
        let [first, second] = self.stages;
        let first = [0, 1, 2, 3].map(|c| first[c] + a * (input[c] - first[c]));
        self.stages = [first, [0, 1, 2, 3].map(|c| second[c] + a * (first[c] - second[c]))];
        let newest = (self.next + N_KEPT - 1) % N_KEPT;
        if self.kept.get(newest).is_some_and(|kept| time.secs_since(kept.time) < SPACING_S) {
            return;
        }
        if let Some(slot) = self.kept.get_mut(self.next) {
            *slot = Kept { time, force_m_s2: self.stages[1] };
            self.next = (self.next + 1) % N_KEPT;
        }
    }

    /// Takes in a step; returns the stride that it completes, if the one before it was a step of the same walk.
    pub fn push_step(&mut self, cycle: &StepCycle) -> Option<Stride> {
        let peak = self.vertical_peak_near(cycle)?;
        let is_walk = |from: Option<Timestamp>, to: Timestamp| {
            from.is_some_and(|from| STEP_PERIOD_S.contains(&to.secs_since(from)))
        };
        if cycle.is_first || !is_walk(self.peaks[2], peak) {
            self.peaks = [None, None, Some(peak)];
            return None;
        }
        self.peaks = [self.peaks[1], self.peaks[2], Some(peak)];
        let [Some(start), Some(middle), Some(end)] = self.peaks else { return None };
        self.stride(start, middle, end)
    }

    /// The highest filtered vertical near the step's end.
    fn vertical_peak_near(&self, cycle: &StepCycle) -> Option<Timestamp> {
        let reach = Duration::from_secs_f64(0.3 * cycle.end.secs_since(cycle.start).clamp(0.0, 1.0));
        let (from, to) = (cycle.end - reach, cycle.end + reach);
        let near = self.kept.iter().filter(|kept| kept.time >= from && kept.time <= to);
        near.max_by(|a, b| a.force_m_s2[3].total_cmp(&b.force_m_s2[3])).map(|kept| kept.time)
    }

    fn stride(&self, start: Timestamp, middle: Timestamp, end: Timestamp) -> Option<Stride> {
        let (first_s, last_s) = (middle.secs_since(start), end.secs_since(middle));
        // Phase of the stride, half a cycle a step, whatever the steps' own periods.
        let phase_of = |time: Timestamp| match time < middle {
            true => 0.5 * time.secs_since(start) / first_s,
            false => 0.5 + 0.5 * time.secs_since(middle) / last_s,
        };
        let (older, newer) = (self.kept.get(self.next..)?, self.kept.get(..self.next)?);
        let within = older.iter().chain(newer).filter(|kept| kept.time >= start && kept.time < end);
        let within = within.map(|kept| (phase_of(kept.time) as f32, kept.force_m_s2));
        let n = within.clone().count();
        if n < 16 {
            return None;
        }
        let n = n as f32;
        let mut sum = [0.0f32; 3];
        let mut ends: Option<[[f32; 4]; 2]> = None;
        for (_, force) in within.clone() {
            sum = [0, 1, 2].map(|c| sum[c] + force[c]);
            ends = Some([ends.map_or(force, |[first, _]| first), force]);
        }
        let mean = sum.map(|sum| sum / n);
        // A stride that ends as it began has no trend; a line through other phases would take part of the sway away.
        let trend = ends.map_or([0.0; 2], |[first, last]| [last[0] - first[0], last[1] - first[1]]);
        // Fourier coefficients of x and y without their trend, at one and two cycles a stride.
        let mut waves = [[[0.0f32; 2]; 2]; 2];
        for (phase, force) in within {
            for (cycles, wave) in waves.iter_mut().enumerate() {
                let angle = core::f32::consts::TAU * (cycles as f32 + 1.0) * phase;
                let (sin, cos) = libm::sincosf(angle);
                for c in 0..2 {
                    let value = force[c] - mean[c] - trend[c] * (phase - 0.5);
                    wave[c][0] += value * cos;
                    wave[c][1] += value * sin;
                }
            }
        }
        let turn = |angle_rad: f32| (angle_rad / core::f32::consts::TAU + 1.0) % 1.0;
        let amplitude = |wave: [f32; 2]| 2.0 / n * (wave[0] * wave[0] + wave[1] * wave[1]).sqrt();
        Some(Stride {
            end,
            period_s: end.secs_since(start) as f32,
            mean_m_s2: [mean[0], mean[1], mean[2]],
            peak_phase: [0, 1].map(|c| turn(libm::atan2f(waves[1][c][1], waves[1][c][0]))),
            per_stride_m_s2: [0, 1].map(|c| amplitude(waves[0][c])),
            per_step_m_s2: [0, 1].map(|c| amplitude(waves[1][c])),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    /// The strides of a walk of two steps a second at 100 Hz, with vertical peaks at whole half seconds.
    ///
    /// `along` gives x and y from the phase of the step and of the stride, in cycles.
    fn strides(along: impl Fn(f64, f64) -> [f32; 2]) -> Vec<Stride> {
        let mut cutter = StrideCutter::default();
        let mut strides = Vec::new();
        for k in 0..600 {
            let time = Timestamp::from_millis(10 * k);
            let t = 0.01 * k as f64;
            let [x, y] = along(2.0 * t, t);
            let vertical = 9.81 + 3.0 * libm::cos(TAU * 2.0 * t) as f32;
            cutter.push_force(time, [x, y, vertical], vertical);
            // The detector knows of a peak about a tenth of a second later, and stamps it 20 ms late.
            if k % 50 == 12 && k > 50 {
                let end = Timestamp::from_millis(10 * k - 100);
                strides.extend(cutter.push_step(&StepCycle {
                    start: end - Duration::from_millis(500),
                    end,
                    frequency_hz: 2.0,
                    amplitude_m_s2: 6.0,
                    is_first: k < 100,
                }));
            }
        }
        strides
    }

    #[test]
    fn means_phases_and_amplitudes_of_a_constructed_walk() {
        let strides = strides(|step, stride| {
            // y peaks at 0.75 of the step; x sways once a stride.
            [-0.5 + libm::sin(TAU * stride) as f32, 1.5 + 2.0 * libm::cos(TAU * (step - 0.75)) as f32]
        });
        assert!(strides.len() >= 8, "{}", strides.len());
        let stride = strides[strides.len() - 1];
        assert!((stride.period_s - 1.0).abs() < 0.05, "{stride:?}");
        for (mean, expected) in stride.mean_m_s2.into_iter().zip([-0.5, 1.5, 9.81]) {
            assert!((mean - expected).abs() < 0.1, "{stride:?}");
        }
        assert!((stride.peak_phase[1] - 0.75).abs() < 0.06, "{stride:?}");
        assert!(stride.per_stride_m_s2[0] > 10.0 * stride.per_step_m_s2[0], "{stride:?}");
        assert!(stride.per_step_m_s2[1] > 10.0 * stride.per_stride_m_s2[1], "{stride:?}");
        assert_eq!(stride.events(), FeatureEvents::new(true, true, true));
    }

    #[test]
    fn each_event_is_absent_where_its_cause_is() {
        let events = |along: fn(f64, f64) -> [f32; 2]| strides(along).last().map(Stride::events);
        // E1: y peaks in the first half.
        assert_eq!(
            events(|step, stride| [libm::sin(TAU * stride) as f32, 1.0 + libm::sin(TAU * step) as f32]),
            Some(FeatureEvents::new(false, true, true))
        );
        // E2: the right edge is the higher one.
        assert_eq!(
            events(|step, stride| [2.0 + libm::sin(TAU * stride) as f32, -libm::sin(TAU * step) as f32]),
            Some(FeatureEvents::new(true, false, true))
        );
        // E3: x sways with the step.
        assert_eq!(
            events(|step, stride| {
                [
                    (libm::sin(TAU * step) + 0.3 * libm::sin(TAU * stride)) as f32,
                    1.0 - libm::sin(TAU * step) as f32,
                ]
            }),
            Some(FeatureEvents::new(true, true, false))
        );
    }

    #[test]
    fn four_quarter_turns_are_none() {
        let stride = strides(|step, stride| {
            [-0.5 + libm::sin(TAU * stride) as f32, 1.5 + 2.0 * libm::cos(TAU * (step - 0.75)) as f32]
        })[3];
        let left = stride.turned_left();
        // The top edge now points left: what was ahead is to the right, what was to the right is behind.
        assert_eq!(left.mean_m_s2[0], stride.mean_m_s2[1]);
        assert_eq!(left.mean_m_s2[1], -stride.mean_m_s2[0]);
        assert_eq!(left.turned_left().events(), FeatureEvents::new(false, false, true));
        let back = left.turned_left().turned_left().turned_left();
        assert_eq!((back.mean_m_s2, back.events()), (stride.mean_m_s2, stride.events()));
        assert!((back.peak_phase[1] - stride.peak_phase[1]).abs() < 1e-6);
    }

    #[test]
    fn a_gap_or_a_broken_number_gives_no_stride_of_both_sides() {
        let mut cutter = StrideCutter::default();
        let step = |end_ms: i64| StepCycle {
            start: Timestamp::from_millis(end_ms - 500),
            end: Timestamp::from_millis(end_ms),
            frequency_hz: 2.0,
            amplitude_m_s2: 3.0,
            is_first: false,
        };
        assert_eq!(cutter.push_step(&step(1000)), None);
        for k in 0..400 {
            let value = if k % 7 == 0 { f32::NAN } else { 9.81 };
            // A clock set back by ten seconds halfway.
            let time = Timestamp::from_millis(10 * k - if k > 200 { 10_000 } else { 0 });
            cutter.push_force(time, [0.0, 0.0, value], value);
            if k == 150 {
                assert_eq!(cutter.push_step(&step(1000)), None);
                assert_eq!(cutter.push_step(&step(1450)), None);
            }
        }
        assert_eq!(cutter.push_step(&step(-6500)), None);
        assert_eq!(cutter.push_step(&step(1900)), None);
    }
}
