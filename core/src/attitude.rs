//! How the phone is held against the walk: which way its screen and its top edge point, and where it is carried.
//!
//! Gravity says whether the screen faces up and how far it is inclined, at every instant. Whether the top edge points
//! ahead shows only in walking: per stride, feature events of the specific force make it more or less likely.

mod carry;
mod stride;
mod table;

use serde::{Deserialize, Serialize};

use crate::gravity::STANDARD_GRAVITY_M_S2;
use crate::step::StepFinding;
use crate::time::Timestamp;

pub use carry::{CarryEvidence, CarryMode, CarryParams};
pub use stride::{Stride, StrideCutter};
pub use table::{EventCounts, EventTable, FeatureEvents, Pointing};

/// How a phone is held, in the terms of Mass-centred 2019, Table 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Attitude {
    /// Nothing was heard yet.
    #[default]
    Unknown,
    /// UFH: screen up, top edge ahead, about level.
    UpwardForwardHorizontal,
    /// UFNH: screen up, top edge ahead, inclined.
    UpwardForwardInclined,
    /// UNF: screen up, top edge to a side or back.
    UpwardNotForward,
    /// The screen does not face up.
    NotUpward,
}

impl Attitude {
    /// Whether azimuth and polar angle of the field may be compared with a survey's, which was walked in this attitude.
    ///
    /// # Source
    /// Mass-centred 2019, Eq. 11: exactly in the attitude UFH.
    pub fn allows_magnetic_direction(self) -> bool {
        self == Self::UpwardForwardHorizontal
    }

    /// Whether the phone's top edge points where its walker goes, so that its heading is the walk's.
    pub fn points_ahead(self) -> bool {
        matches!(self, Self::UpwardForwardHorizontal | Self::UpwardForwardInclined)
    }

    /// Whether the screen faces up.
    pub fn is_upward(self) -> bool {
        matches!(self, Self::UpwardForwardHorizontal | Self::UpwardForwardInclined | Self::UpwardNotForward)
    }
}

/// The attitude with what it was judged by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AttitudeEstimate {
    /// The attitude, with hysteresis.
    pub attitude: Attitude,
    /// Where the phone is carried.
    pub carry_mode: CarryMode,
    /// Specific force out of the screen, mean over the stride, in units of g: about 1 for a level phone.
    pub upward_g: f32,
    /// Angle between the screen's normal and the vertical, mean over the stride, in radians; 0 to π.
    pub incline_rad: f32,
    /// Probability that the top edge points ahead if the screen faces up, 0 to 1.
    pub p_forward: f32,
    /// How sure UFH is, 0 to 1: the product of `p_forward` and of soft thresholds at the two tests of gravity.
    pub ufh_score: f32,
}

/// Parameters of [`AttitudeDetector`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttitudeParams {
    /// `k`: the screen faces up when the mean force out of it is greater than this, in units of g; default 0.6 (an
    /// incline of 53°). The paper leaves it open.
    pub upward_g: f32,
    /// `k_θ`: level when inclined by less than this share of a right angle; default 0.4 (36°). The paper leaves it open.
    pub level_share: f32,
    /// Half the width of the band about `upward_g` in which the last answer stands, in units of g; default 0.05.
    pub upward_band_g: f32,
    /// The same about the level test, as a share of a right angle; default 0.04.
    pub level_band: f32,
    /// The same about a probability of one half for pointing ahead; default 0.1.
    pub forward_band: f32,
    /// Events and priors.
    pub table: EventTable,
    /// Share of the belief that falls back to the prior from stride to stride, 0 to 1; default 0.1: a walker changes
    /// the grip once in about ten strides at the most. With 1 every stride is judged by itself, as in the paper.
    pub forgetting: f32,
    /// Share of strides that turns, stumbles and obstacles break, 0 to 1, so that no single one outweighs a grip;
    /// default 0.2. The paper has none.
    pub broken_share: f32,
    /// Where on the body.
    pub carry: CarryParams,
}

impl Default for AttitudeParams {
    fn default() -> Self {
        Self {
            upward_g: 0.6,
            level_share: 0.4,
            upward_band_g: 0.05,
            level_band: 0.04,
            forward_band: 0.1,
            table: EventTable::estimated(),
            forgetting: 0.1,
            broken_share: 0.2,
            carry: CarryParams::default(),
        }
    }
}

impl AttitudeParams {
    /// The detector as printed: the paper's table, each stride by itself, no hysteresis; `k` and `k_θ` are ours.
    ///
    /// # Source
    /// Mass-centred 2019, Alg. 2.
    pub fn printed() -> Self {
        Self {
            upward_band_g: 0.0,
            level_band: 0.0,
            forward_band: 0.0,
            table: EventTable::printed(),
            forgetting: 1.0,
            broken_share: 0.0,
            ..Self::default()
        }
    }
}

/// A stride older than this says nothing about now, in seconds.
const STRIDE_LASTS_S: f64 = 1.5;
/// Widths of the soft thresholds in [`AttitudeEstimate::ufh_score`]: of the force out of the screen, in units of g, and
/// of the incline as a share of a right angle.
const SOFT_G: f32 = 0.1;
const SOFT_SHARE: f32 = 0.1;

/// Follows the attitude, causally: from the specific force, the steps found in it, and the angular rate.
///
/// # Source
/// Mass-centred 2019, Alg. 2. Ours are the memory from stride to stride, the hysteresis, and that gravity alone goes on
/// answering when nobody walks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AttitudeDetector {
    params: AttitudeParams,
    cutter: StrideCutter,
    carry: CarryEvidence,
    last_stride: Option<Stride>,
    /// Probabilities as [`Pointing::ALL`].
    pointing: [f32; 4],
    last_judged: Option<Timestamp>,
    is_upward: bool,
    is_level: bool,
    is_forward: bool,
}

impl AttitudeDetector {
    /// A detector that has seen nothing.
    pub fn new(params: AttitudeParams) -> Self {
        let table = params.table.with_broken_share(params.broken_share);
        Self {
            params: AttitudeParams { table, ..params },
            cutter: StrideCutter::default(),
            carry: CarryEvidence::default(),
            last_stride: None,
            pointing: params.table.prior,
            last_judged: None,
            is_upward: false,
            is_level: false,
            is_forward: params.table.prior[0] > 0.5,
        }
    }

    /// Takes in an angular rate, device frame, in rad/s.
    pub fn push_rate(&mut self, time: Timestamp, rate_rad_s: [f32; 3]) {
        self.carry.push_rate(time, rate_rad_s);
    }

    /// Takes in a specific force, device frame, and its vertical component, in m/s².
    pub fn push_force(&mut self, time: Timestamp, force_m_s2: [f32; 3], vertical_m_s2: f32) {
        self.cutter.push_force(time, force_m_s2, vertical_m_s2);
        self.carry.push_force(time, force_m_s2);
        self.judge(time);
    }

    /// Takes in what a step detector has just found; returns the stride that it completes, if it does.
    ///
    /// A peak that may yet be none of a walk only marks where a stride can begin.
    pub fn push_step(&mut self, finding: &StepFinding) -> Option<Stride> {
        if finding.is_stride {
            // The peaks of a limb say nothing of the steps in between.
            return None;
        }
        let stride = self.cutter.push_step(&finding.cycle).filter(|_| finding.is_confirmed)?;
        self.last_stride = Some(stride);
        let params = &self.params;
        if stride.mean_m_s2[2] > params.upward_g * STANDARD_GRAVITY_M_S2 {
            let keep = 1.0 - params.forgetting.clamp(0.0, 1.0);
            let prior = [0, 1, 2, 3]
                .map(|k| params.table.prior[k] + keep * (self.pointing[k] - params.table.prior[k]));
            self.pointing = params.table.posterior(stride.events(), prior);
        } else {
            // Out of the hand that held it: the next grip may be another.
            self.pointing = params.table.prior;
        }
        self.judge(self.last_judged.unwrap_or(stride.end));
        Some(stride)
    }

    /// The latest stride; nothing before the first.
    pub fn last_stride(&self) -> Option<&Stride> {
        self.last_stride.as_ref()
    }

    /// What is known now.
    pub fn estimate(&self) -> AttitudeEstimate {
        let Some(now) = self.last_judged else { return AttitudeEstimate::default() };
        let (upward_g, incline_rad) = self.gravity(now);
        let p_forward = self.pointing[0];
        let soft = |margin: f32, width: f32| 1.0 / (1.0 + libm::expf(-margin / width));
        let level_margin = self.params.level_share - incline_rad / core::f32::consts::FRAC_PI_2;
        AttitudeEstimate {
            attitude: match (self.is_upward, self.is_forward, self.is_level) {
                (false, ..) => Attitude::NotUpward,
                (true, false, _) => Attitude::UpwardNotForward,
                (true, true, true) => Attitude::UpwardForwardHorizontal,
                (true, true, false) => Attitude::UpwardForwardInclined,
            },
            carry_mode: self.carry.mode(),
            upward_g,
            incline_rad,
            p_forward,
            ufh_score: soft(upward_g - self.params.upward_g, SOFT_G)
                * soft(level_margin, SOFT_SHARE)
                * p_forward,
        }
    }

    /// Force out of the screen in units of g, and the incline in radians: over the last stride while walking, else over
    /// about a second.
    ///
    /// # Source
    /// Mass-centred 2019, Eq. 2: the angle between the summed force of a stride and its part out of the screen.
    fn gravity(&self, now: Timestamp) -> (f32, f32) {
        let of_stride =
            self.last_stride.filter(|stride| (0.0..STRIDE_LASTS_S).contains(&now.secs_since(stride.end)));
        let mean = of_stride.map_or(self.carry.mean_m_s2(), |stride| stride.mean_m_s2);
        let norm = (mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]).sqrt();
        let cos = if norm > 0.0 { (mean[2] / norm).clamp(-1.0, 1.0) } else { 0.0 };
        (mean[2] / STANDARD_GRAVITY_M_S2, libm::acosf(cos))
    }

    fn judge(&mut self, now: Timestamp) {
        self.last_judged = Some(now);
        let (upward_g, incline_rad) = self.gravity(now);
        let params = &self.params;
        let stays = |was: bool, band: f32| if was { -band } else { band };
        self.is_upward = upward_g > params.upward_g + stays(self.is_upward, params.upward_band_g);
        let incline = incline_rad / core::f32::consts::FRAC_PI_2;
        self.is_level = incline < params.level_share - stays(self.is_level, params.level_band);
        self.is_forward = self.pointing[0] > 0.5 + stays(self.is_forward, params.forward_band);
        self.carry.judge(now, self.is_upward, &params.carry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::StepCycle;
    use crate::time::Duration;
    use core::f64::consts::TAU;

    /// A walk of two steps a second at 100 Hz; `force` gives x, y and z in m/s² from the time in seconds, in cycles a
    /// second; the vertical peaks with every half second.
    fn walk(
        detector: &mut AttitudeDetector,
        from_s: i64,
        seconds: i64,
        force: impl Fn(f64) -> [f64; 3],
    ) -> Vec<AttitudeEstimate> {
        let mut estimates = Vec::new();
        for k in 100 * from_s..100 * (from_s + seconds) {
            let time = Timestamp::from_millis(10 * k);
            let t = 0.01 * k as f64;
            let vertical = (9.81 + 3.0 * libm::cos(TAU * 2.0 * t)) as f32;
            detector.push_force(time, force(t).map(|c| c as f32), vertical);
            if k % 50 == 12 && k > 100 * from_s + 50 {
                let end = Timestamp::from_millis(10 * k - 100);
                let start = end - Duration::from_millis(500);
                detector.push_step(&StepFinding {
                    cycle: StepCycle { start, end, frequency_hz: 2.0, amplitude_m_s2: 6.0, is_first: false },
                    is_stride: false,
                    is_under_way: false,
                    n_held: 0,
                    is_confirmed: true,
                    starts_walk: false,
                });
            }
            estimates.push(detector.estimate());
        }
        estimates
    }

    /// Held level with the top edge ahead: the late peak along y, the tilt to the eyes, the sway of the stride along x.
    fn ahead(t: f64) -> [f64; 3] {
        [
            libm::sin(TAU * t),
            1.5 + 1.5 * libm::cos(TAU * (2.0 * t - 0.75)),
            9.6 + 3.0 * libm::cos(TAU * 2.0 * t),
        ]
    }

    /// The same with the top edge to the left.
    fn leftward(t: f64) -> [f64; 3] {
        let [x, y, z] = ahead(t);
        [y, -x, z]
    }

    fn detector() -> AttitudeDetector {
        AttitudeDetector::new(AttitudeParams::default())
    }

    #[test]
    fn strides_tell_the_edge_that_points_ahead() {
        for params in [AttitudeParams::default(), AttitudeParams::printed()] {
            let mut detector = AttitudeDetector::new(params);
            let held_ahead = walk(&mut detector, 0, 10, ahead)[999];
            assert_eq!(held_ahead.attitude, Attitude::UpwardForwardHorizontal);
            assert!(held_ahead.p_forward > 0.95 && held_ahead.ufh_score > 0.9, "{held_ahead:?}");
            assert!((held_ahead.upward_g - 9.6 / STANDARD_GRAVITY_M_S2).abs() < 0.02, "{held_ahead:?}");
            let turned = walk(&mut detector, 10, 10, leftward)[999];
            assert_eq!(turned.attitude, Attitude::UpwardNotForward);
            assert!(turned.p_forward < 0.05 && !turned.attitude.points_ahead(), "{turned:?}");
        }
    }

    #[test]
    fn the_paper_judges_every_stride_by_itself() {
        let mut detector = AttitudeDetector::new(AttitudeParams::printed());
        // No sway at all: E1 and E2 without E3, as in a turn, whatever was before.
        let swayless = |t: f64| {
            let [_, y, z] = ahead(t);
            [0.3 * libm::sin(TAU * 2.0 * t), y, z]
        };
        walk(&mut detector, 0, 10, ahead);
        let estimate = walk(&mut detector, 10, 5, swayless)[499];
        assert!((estimate.p_forward - 0.0633).abs() < 1e-3, "{estimate:?}");
        let mut remembering = self::detector();
        walk(&mut remembering, 0, 10, ahead);
        assert!(walk(&mut remembering, 10, 2, swayless)[199].attitude.points_ahead());
    }

    #[test]
    fn the_incline_is_the_angle_of_the_summed_force() {
        // 45°: beyond 36°, and upward since cos 45° > 0.6.
        let inclined = |t: f64| {
            let [x, y, z] = ahead(t);
            let (c, s) = (0.5f64.sqrt(), 0.5f64.sqrt());
            [x, c * y + s * z - 0.5, c * z - s * y + 1.06]
        };
        let estimate = walk(&mut detector(), 0, 10, inclined)[999];
        assert_eq!(estimate.attitude, Attitude::UpwardForwardInclined);
        assert!((estimate.incline_rad.to_degrees() - 45.0).abs() < 3.0, "{estimate:?}");
        assert!(estimate.attitude.points_ahead() && !estimate.attitude.allows_magnetic_direction());
    }

    #[test]
    fn gravity_alone_answers_when_nobody_walks() {
        let mut detector = detector();
        assert_eq!(detector.estimate(), AttitudeEstimate::default());
        for k in 0..300 {
            detector.push_force(Timestamp::from_millis(10 * k), [0.0, 1.0, 9.75], 9.8);
        }
        let level = detector.estimate();
        // Held forward is what is expected before any stride.
        assert_eq!(level.attitude, Attitude::UpwardForwardHorizontal);
        assert!((level.p_forward - 0.7).abs() < 1e-6);
        for k in 300..900 {
            detector.push_force(Timestamp::from_millis(10 * k), [0.0, 1.0, -9.75], 9.8);
        }
        let face_down = detector.estimate();
        assert_eq!(face_down.attitude, Attitude::NotUpward);
        assert!(face_down.ufh_score < 0.01 && face_down.upward_g < -0.9, "{face_down:?}");
    }

    #[test]
    fn answers_stand_within_the_band() {
        let mut detector = detector();
        let mut hold = |from_s: i64, upward_g: f64| {
            let z = upward_g * 9.806_65;
            let side = (9.806_65f64 * 9.806_65 - z * z).sqrt();
            for k in 100 * from_s..100 * (from_s + 8) {
                let time = Timestamp::from_millis(10 * k);
                detector.push_force(time, [0.0, side as f32, z as f32], 9.81);
            }
            detector.estimate().attitude.is_upward()
        };
        // The threshold is 0.6, the band 0.55 to 0.65.
        let answers = [0.5, 0.62, 0.68, 0.58, 0.62, 0.52, 0.58].map(|g| g);
        let seen: Vec<bool> = answers.iter().enumerate().map(|(k, &g)| hold(8 * k as i64, g)).collect();
        assert_eq!(seen, [false, false, true, true, true, false, false]);
    }

    #[test]
    fn every_answer_is_a_number_whatever_comes() {
        let mut detector = detector();
        let numbers = [f32::NAN, f32::INFINITY, -1e30, 0.0, 9.81, 2_000.0];
        for k in 0..2_000usize {
            let pick = |n: usize| numbers[(k / n) % numbers.len()];
            // Clocks that stop, jump and go backwards.
            let time = Timestamp::from_nanos((k as i64 * 7_919_000_017) % 20_000_000_000);
            detector.push_rate(time, [pick(2), pick(3), pick(5)]);
            detector.push_force(time, [pick(3), pick(7), pick(1)], pick(2));
            let cycle = StepCycle {
                start: time - Duration::from_millis(500),
                end: time,
                frequency_hz: 2.0,
                amplitude_m_s2: pick(1),
                is_first: k % 9 == 0,
            };
            detector.push_step(&StepFinding {
                cycle,
                is_stride: k % 5 == 0,
                is_under_way: false,
                n_held: 0,
                is_confirmed: k % 3 == 0,
                starts_walk: false,
            });
            let said = detector.estimate();
            assert!(
                (0.0..=1.0).contains(&said.p_forward) && (0.0..=1.0).contains(&said.ufh_score),
                "{said:?}"
            );
            assert!((0.0..=3.2).contains(&said.incline_rad) && said.upward_g.is_finite(), "{said:?}");
        }
    }
}
