//! Where on the body a phone is: told by what points up, how fast the phone tilts to and fro, and whether it lies still.

use serde::{Deserialize, Serialize};

use crate::time::Timestamp;

/// How a phone is carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CarryMode {
    /// Nothing fits, or too little was heard.
    #[default]
    Unknown,
    /// In a steady hand, the screen up.
    HeldUp,
    /// In a steady hand, the screen upright with an edge up, as a camera.
    HeldUpright,
    /// At the ear.
    Calling,
    /// In a hand that swings.
    Swinging,
    /// In a front trouser pocket.
    FrontPocket,
    /// In a back trouser pocket.
    BackPocket,
    /// On something that nobody carries.
    OnTable,
}

impl CarryMode {
    /// Every mode.
    pub const ALL: [Self; 8] = [
        Self::Unknown,
        Self::HeldUp,
        Self::HeldUpright,
        Self::Calling,
        Self::Swinging,
        Self::FrontPocket,
        Self::BackPocket,
        Self::OnTable,
    ];

    /// Whether the phone is in a pocket or shaken, where iBILL 2017 pauses positioning by particles.
    pub fn is_pocketed_or_shaken(self) -> bool {
        matches!(self, Self::Swinging | Self::FrontPocket | Self::BackPocket)
    }

    /// Whether what the phone feels can be a walker's steps.
    pub fn allows_steps(self) -> bool {
        self != Self::OnTable
    }
}

/// Parameters of the rules for [`CarryMode`]; the defaults separate the middle halves of the public recordings of one
/// person with two phones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CarryParams {
    /// A phone that tilts slower than this is in a steady hand or at the ear, in rad/s (root mean square about level
    /// axes); default 0.45: hands 0.16 to 0.35, pockets 0.6 to 1.5.
    pub steady_rad_s: f32,
    /// One that tilts faster than this swings in a hand, unless its long edge is upright; in rad/s, default 0.9.
    pub swinging_rad_s: f32,
    /// The long edge is upright when gravity's share along it is greater than this, 0 to 1; default 0.75.
    pub upright_share: f32,
    /// One whose long edge is upright swings in a hand when it tilts faster than this, in rad/s; default 2.
    pub swinging_upright_rad_s: f32,
    /// In a pocket, only the thigh swings faster than this, in rad/s: a front pocket; default 1 (seats 0.6 to 0.9).
    pub thigh_rad_s: f32,
    /// A back pocket leans the screen out of the upright by this much more than it leans an edge (difference of
    /// gravity's shares); default -0.15.
    pub back_pocket_lean: f32,
    /// Nothing carried is as quiet as this, in m/s² (standard deviation of the specific force); default 0.05.
    pub still_m_s2: f32,
    /// And tilts as slowly as this, in rad/s; default 0.02.
    pub still_rad_s: f32,
    /// A change must be seen for this long before it is believed, in seconds; default 1.
    pub dwell_s: f64,
}

impl Default for CarryParams {
    fn default() -> Self {
        Self {
            steady_rad_s: 0.45,
            swinging_rad_s: 0.9,
            upright_share: 0.75,
            swinging_upright_rad_s: 2.0,
            thigh_rad_s: 1.0,
            back_pocket_lean: -0.15,
            still_m_s2: 0.05,
            still_rad_s: 0.02,
            dwell_s: 1.0,
        }
    }
}

/// Running means of what the rules look at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CarryEvidence {
    last_force: Option<Timestamp>,
    last_rate: Option<Timestamp>,
    /// Mean specific force, device frame, in m/s².
    mean_m_s2: [f32; 3],
    variance_m2_s4: f32,
    /// Mean square of the angular rate about level axes; the rate about the vertical is the walker's turning.
    tilting_rad2_s2: f32,
    mode: CarryMode,
    proposed: CarryMode,
    proposed_since: Option<Timestamp>,
}

/// Time constant of the means, in seconds: two steps.
const TAU_S: f32 = 1.0;

impl CarryEvidence {
    /// Takes in an angular rate, device frame, in rad/s.
    pub fn push_rate(&mut self, time: Timestamp, rate_rad_s: [f32; 3]) {
        let square: f32 = rate_rad_s.iter().map(|c| c * c).sum();
        let norm = norm(self.mean_m_s2);
        let Some(a) = share(&mut self.last_rate, time) else { return };
        if norm < 1.0 || !square.is_finite() {
            return;
        }
        let vertical = dot(rate_rad_s, self.mean_m_s2) / norm;
        self.tilting_rad2_s2 += a * ((square - vertical * vertical).max(0.0) - self.tilting_rad2_s2);
    }

    /// Takes in a specific force, device frame, in m/s².
    pub fn push_force(&mut self, time: Timestamp, force_m_s2: [f32; 3]) {
        if !force_m_s2.iter().all(|c| c.is_finite()) {
            return;
        }
        let Some(a) = share(&mut self.last_force, time) else {
            self.mean_m_s2 = force_m_s2;
            self.variance_m2_s4 = 0.0;
            self.proposed_since = None;
            return;
        };
        let off = [0, 1, 2].map(|c| force_m_s2[c] - self.mean_m_s2[c]);
        self.mean_m_s2 = [0, 1, 2].map(|c| self.mean_m_s2[c] + a * off[c]);
        self.variance_m2_s4 += a * (dot(off, off) - self.variance_m2_s4);
    }

    /// Mean specific force of about the last second, device frame, in m/s²; zero before the first.
    pub fn mean_m_s2(&self) -> [f32; 3] {
        self.mean_m_s2
    }

    /// The mode that is believed.
    pub fn mode(&self) -> CarryMode {
        self.mode
    }

    /// Judges anew at `now`; `is_upward` says whether the screen faces up.
    pub fn judge(&mut self, now: Timestamp, is_upward: bool, params: &CarryParams) {
        let seen = self.seen(now, is_upward, params);
        if seen != self.proposed || self.proposed_since.is_none_or(|since| since > now) {
            self.proposed = seen;
            self.proposed_since = Some(now);
        }
        let dwelt_s = self.proposed_since.map_or(0.0, |since| now.secs_since(since));
        if dwelt_s >= params.dwell_s {
            self.mode = seen;
        }
    }

    fn seen(&self, now: Timestamp, is_upward: bool, params: &CarryParams) -> CarryMode {
        let norm = norm(self.mean_m_s2);
        if norm < 1.0 {
            return CarryMode::Unknown;
        }
        let has_rate = self.last_rate.is_some_and(|last| now.secs_since(last) < 1.0);
        let tilting_rad_s = self.tilting_rad2_s2.max(0.0).sqrt();
        let is_quiet = self.variance_m2_s4 < params.still_m_s2 * params.still_m_s2;
        if is_quiet && (!has_rate || tilting_rad_s < params.still_rad_s) {
            return CarryMode::OnTable;
        }
        if is_upward {
            return CarryMode::HeldUp;
        }
        if !has_rate {
            return CarryMode::Unknown;
        }
        let [side, long, screen] = self.mean_m_s2.map(|c| (c / norm).abs());
        let is_long_edge_upright = long > params.upright_share;
        if tilting_rad_s < params.steady_rad_s {
            // At the ear the phone leans between its edges; a camera stands on one.
            let is_on_an_edge = side.min(long) < 0.4 * side.max(long);
            return if is_on_an_edge { CarryMode::HeldUpright } else { CarryMode::Calling };
        }
        let swings_from =
            if is_long_edge_upright { params.swinging_upright_rad_s } else { params.swinging_rad_s };
        if tilting_rad_s > swings_from {
            CarryMode::Swinging
        } else if !is_long_edge_upright {
            CarryMode::Unknown
        } else if tilting_rad_s < params.thigh_rad_s && screen - side > params.back_pocket_lean {
            CarryMode::BackPocket
        } else {
            CarryMode::FrontPocket
        }
    }
}

/// The share of a new value in a running mean; nothing for the first value and after a gap or a step back.
fn share(last: &mut Option<Timestamp>, time: Timestamp) -> Option<f32> {
    let dt_s = time.secs_since(last.replace(time)?) as f32;
    (0.0..1.0).contains(&dt_s).then_some(dt_s / (TAU_S + dt_s))
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(v: [f32; 3]) -> f32 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight seconds at 50 Hz of a phone with `up` pointing up, tilting at `tilt_rad_s` (root mean square).
    fn mode_of(up: [f32; 3], tilt_rad_s: f32, is_upward: bool) -> CarryMode {
        let mut evidence = CarryEvidence::default();
        for k in 0..400 {
            let time = Timestamp::from_millis(20 * k);
            let wave = core::f32::consts::SQRT_2 * libm::sinf(6.0 * 0.02 * k as f32);
            // About an axis across what points up.
            evidence.push_rate(time, [up[1], -up[0], 0.0].map(|c| tilt_rad_s * wave * c));
            evidence.push_force(time, up.map(|c| c * (9.81 + tilt_rad_s * wave)));
            evidence.judge(time, is_upward, &CarryParams::default());
        }
        evidence.mode()
    }

    #[test]
    fn what_points_up_and_how_it_tilts_tell_the_place() {
        assert_eq!(mode_of([0.0, 0.1, 0.99], 0.3, true), CarryMode::HeldUp);
        assert_eq!(mode_of([1.0, 0.0, 0.1], 0.2, false), CarryMode::HeldUpright);
        assert_eq!(mode_of([0.66, 0.65, 0.35], 0.3, false), CarryMode::Calling);
        assert_eq!(mode_of([-0.98, -0.1, 0.0], 1.8, false), CarryMode::Swinging);
        assert_eq!(mode_of([0.0, -1.0, 0.1], 1.4, false), CarryMode::FrontPocket);
        assert_eq!(mode_of([0.45, 0.88, 0.0], 0.7, false), CarryMode::FrontPocket);
        assert_eq!(mode_of([0.05, 0.96, -0.25], 0.8, false), CarryMode::BackPocket);
        assert_eq!(mode_of([0.0, 0.0, 1.0], 0.0, true), CarryMode::OnTable);
        assert_eq!(mode_of([0.0, 0.0, -1.0], 0.0, false), CarryMode::OnTable);
    }

    #[test]
    fn a_change_is_believed_after_a_second() {
        let mut evidence = CarryEvidence::default();
        for k in 0..100 {
            let time = Timestamp::from_millis(20 * k);
            // Shaken a little, so that it is no table.
            evidence.push_force(time, [0.0, 0.0, 9.81 + 0.5 * (k % 2) as f32]);
            evidence.judge(time, true, &CarryParams::default());
            let expected = if k < 55 { CarryMode::Unknown } else { CarryMode::HeldUp };
            if !(45..60).contains(&k) {
                assert_eq!(evidence.mode(), expected, "{k}");
            }
        }
    }

    #[test]
    fn broken_numbers_and_clocks_are_borne() {
        let mut evidence = CarryEvidence::default();
        for time in [10, 20, -5_000, 30, 90_000].map(Timestamp::from_millis) {
            evidence.push_force(time, [f32::NAN, 0.0, 9.81]);
            evidence.push_force(time, [0.0, 0.0, 9.81]);
            evidence.push_rate(time, [f32::INFINITY, 0.0, 0.0]);
            evidence.judge(time, true, &CarryParams::default());
        }
        assert_eq!(evidence.mean_m_s2(), [0.0, 0.0, 9.81]);
        assert!(evidence.tilting_rad2_s2.is_finite());
    }
}
