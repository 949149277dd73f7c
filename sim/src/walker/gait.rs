//! How the body moves at each instant of a walk.

use std::f64::consts::{PI, TAU};

use fieldwalk::geometry::{Point2, wrap_rad};

use crate::noise::{Noise, SmoothNoise, smooth_step};
use crate::walker::spline::{Ends, Spline};
use crate::walker::{Course, Pace, Pause, Step, WalkerProfile, pace};

/// The jolt of a heel strike as it reaches the trunk: how long it rings, in seconds, and at what frequency.
///
/// # Source
/// Light, McLellan and Klenerman 1980, *Skeletal transients on heel strike in normal walking with different footwear*:
/// some m/s² at the trunk. Length and frequency are those of the third to fifth harmonics of recorded walks
/// (`docs/simulator/`).
const JOLT_S: f64 = 0.25;
pub(crate) const JOLT_HZ: f64 = 6.5;
/// The jolt brakes, and pushes towards the other foot, by these shares of its upward part.
const JOLT_BACK: f64 = 0.5;
const JOLT_ASIDE: f64 = 0.3;
/// No two steps meet the ground alike: standard deviation of a jolt's strength over its mean.
const JOLT_SD: f64 = 0.35;
/// Share of the body's rise in the second harmonic of the step, and in the stride's.
const SECOND_HARMONIC: f64 = 0.06;
/// Rise of the trunk once a stride, over that of a step: one leg is never as the other.
const STRIDE_SHARE: f64 = 0.12;
/// Variation of speed within a step, over the mean speed; and the third harmonic of the sway over the first.
///
/// # Source
/// Menz, Lord and Fitzpatrick 2003, *Acceleration patterns of the head and pelvis when walking on level and irregular
/// surfaces*: 1 to 1.6 m/s² rms along and across at the pelvis.
const SURGE: f64 = 0.12;
const SWAY_THIRD: f64 = 0.2;

/// On stairs the body rises and falls by fits: its vertical speed varies by this share of its mean, and is greatest at
/// this share of the step, upwards and downwards.
///
/// # Source
/// Ours, after the forces in Riener, Rabuffetti and Frigo 2002: the leg that has just been set up lifts the body; on the
/// way down the lower foot catches it.
const UNEVEN_CLIMB: f64 = 0.8;
const LIFTED_AT: f64 = 0.35;
const LET_DOWN_AT: f64 = 0.8;
/// How much harder a foot meets a tread 0.17 m lower than the level floor.
const LANDING_DOWN: f64 = 1.0 / 0.17;

/// The body at one instant. Offsets are of the trunk's centre, in the frame of the body (right, ahead, up).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Body {
    /// Where the walker is: on the path, without the sway of the gait.
    pub position: Point2,
    /// Height of the floor under the walker, or of the slope of the stairs, in metres over the ground floor.
    pub height_m: f64,
    /// Where the walker faces, clockwise from +y, in radians, in [-π, π).
    pub heading_rad: f64,
    /// Grows by 1 through each step, from a heel strike to the next; the right foot swings from even to odd numbers.
    pub step_phase: f64,
    /// 0 when standing, 1 in full stride.
    pub vigour: f64,
    /// Offset of the trunk by the gait, without the bounce and the jolts of heel strikes, in metres.
    pub offset_m: [f64; 3],
    /// The trunk's rise and fall within steps and strides: the parts of its upward offset by frequency.
    pub bounce: [Wave; 3],
    /// Offset by the jolt of a heel strike (right, ahead, up), in metres.
    pub jolt_m: [f64; 3],
    /// Whether the right heel struck last.
    pub is_right_down: bool,
}

/// A part of a periodic motion: `amplitude_m · cos(phase_rad)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Its amplitude, in metres.
    pub amplitude_m: f64,
    /// Where it is in its period, in radians.
    pub phase_rad: f64,
    /// Its frequency at this time, in Hz.
    pub frequency_hz: f64,
}

impl Body {
    /// The trunk's rise by its bounce, in metres.
    pub fn bounced_m(&self) -> f64 {
        self.bounce.iter().map(|wave| wave.amplitude_m * libm::cos(wave.phase_rad)).sum()
    }
}

/// A walk in time: who walks where, step by step, and the body at every instant.
#[derive(Clone, Debug)]
pub struct Gait {
    walker: WalkerProfile,
    course: Course,
    bouts: Vec<Bout>,
    steps: Vec<Step>,
    end_s: f64,
    stray: SmoothNoise,
    sway_phase_rad: f64,
}

/// Steps without a stop, as curves over time.
#[derive(Clone, Debug)]
struct Bout {
    start_s: f64,
    end_s: f64,
    /// End of the first step and start of the last.
    full_s: [f64; 2],
    at_m: Spline,
    phase: Spline,
    length_m: Spline,
    step_hz: Spline,
    /// Height of the floor at the feet, and the rise of each step.
    height_m: Spline,
    climb_m: Spline,
    contacts: Vec<Contact>,
    is_first_right: bool,
}

/// A heel strike.
#[derive(Clone, Copy, Debug)]
struct Contact {
    time_s: f64,
    is_right: bool,
    /// How hard, 1 on average.
    strength: f64,
}

impl Gait {
    /// `walker` stands for `standing_s`, follows `course` with its stops, and stands again for `standing_s`.
    pub fn new(walker: &WalkerProfile, course: Course, pauses: &[Pause], standing_s: f64, seed: u64) -> Self {
        Self::with_paces(walker, course, pauses, &[], standing_s, seed)
    }

    /// The same with changes of speed, in order of their places.
    pub fn with_paces(
        walker: &WalkerProfile,
        course: Course,
        pauses: &[Pause],
        paces: &[Pace],
        standing_s: f64,
        seed: u64,
    ) -> Self {
        let planned = pace::plan(walker, &course, pauses, paces, standing_s, seed);
        let steps: Vec<Step> = planned.iter().flatten().copied().collect();
        let mut noise = Noise::new(seed, "gait", 0);
        let mut jolts = Noise::new(seed, "jolts", 0);
        Self {
            walker: *walker,
            bouts: planned.iter().filter_map(|steps| Bout::of(steps, &course, &mut jolts)).collect(),
            course,
            end_s: steps.last().map_or(0.0, |step| step.end_s) + standing_s,
            steps,
            stray: SmoothNoise::new(&mut noise, walker.stray_m, [0.02, 0.12]),
            sway_phase_rad: noise.within(-0.3, 0.3),
        }
    }

    /// The steps taken, in order.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Who walks.
    pub fn walker(&self) -> &WalkerProfile {
        &self.walker
    }

    /// How long it all takes, in seconds.
    pub fn duration_s(&self) -> f64 {
        self.end_s
    }

    /// How far along the path the walker is at `time_s`, in metres.
    pub fn walked_m(&self, time_s: f64) -> f64 {
        self.bouts[..self.begun(time_s)].last().map_or(0.0, |bout| bout.at_m.at(time_s))
    }

    /// When the walker comes to the place `at_m` along the path, in seconds.
    pub fn time_at_s(&self, at_m: f64) -> f64 {
        let (mut low_s, mut high_s) = (0.0, self.end_s);
        for _ in 0..40 {
            let middle_s = 0.5 * (low_s + high_s);
            if self.walked_m(middle_s) < at_m { low_s = middle_s } else { high_s = middle_s }
        }
        0.5 * (low_s + high_s)
    }

    /// Number of bouts begun by `time_s`.
    fn begun(&self, time_s: f64) -> usize {
        self.bouts.partition_point(|bout| bout.start_s <= time_s)
    }

    /// The body at `time_s`.
    pub fn body(&self, time_s: f64) -> Body {
        let bout = self.bouts[..self.begun(time_s)].last();
        let at_m = bout.map_or(0.0, |bout| bout.at_m.at(time_s));
        let heading_rad = wrap_rad(self.course.heading_rad(at_m));
        let (sin, cos) = libm::sincos(heading_rad);
        let right = Point2::new(cos, -sin);
        let position = self.course.position(at_m) + right * self.stray.at(at_m);
        let height_m = bout.map_or(self.course.height_m(0.0), |bout| bout.height_m.at(time_s));
        let still = Body { position, height_m, heading_rad, ..Body::default() };
        bout.map_or(still, |bout| self.in_bout(bout, time_s, still))
    }

    fn in_bout(&self, bout: &Bout, time_s: f64, still: Body) -> Body {
        let first_s = (time_s - bout.start_s) / (bout.full_s[0] - bout.start_s);
        let last_s = (bout.end_s - time_s) / (bout.end_s - bout.full_s[1]);
        let vigour = smooth_step(first_s) * smooth_step(last_s);
        let (jolt_m, is_right_down) = self.jolt_m(bout, time_s);
        let still = Body { jolt_m, is_right_down, ..still };
        if vigour <= 0.0 {
            return still;
        }
        let step_phase = bout.phase.at(time_s) + if bout.is_first_right { 0.0 } else { 1.0 };
        let length_m = bout.length_m.at(time_s);
        let half_rise_m = 0.5 * self.walker.rise_m(length_m);
        let step_rad = TAU * step_phase;
        let step_hz = bout.step_hz.at(time_s);
        let wave = |amplitude_m: f64, phase_rad: f64, harmonic: f64| Wave {
            amplitude_m: vigour * amplitude_m,
            phase_rad,
            frequency_hz: harmonic * step_hz,
        };
        // Lowest just after the heel strike, when both feet are down, highest over the standing foot.
        let bounce = [
            wave(-half_rise_m, step_rad - 0.3, 1.0),
            wave(SECOND_HARMONIC * half_rise_m, 2.0 * step_rad + 0.8, 2.0),
            wave(STRIDE_SHARE * half_rise_m, 0.5 * step_rad + 0.4, 0.5),
        ];
        let climb_m = bout.climb_m.at(time_s);
        // Up, the body is lifted early in the step; down, it is let down late.
        let lag_rad = TAU * if climb_m > 0.0 { LIFTED_AT } else { LET_DOWN_AT };
        let up_m = UNEVEN_CLIMB * climb_m / TAU * libm::sin(step_rad - lag_rad);
        // Fastest when lowest.
        let ahead_m = SURGE * length_m / TAU * libm::sin(step_rad - 0.3);
        // Over the standing foot: to the left while the right foot swings.
        let stride_rad = 0.5 * step_rad + self.sway_phase_rad;
        let right_m =
            -self.walker.sway_m * (libm::sin(stride_rad) + SWAY_THIRD * libm::sin(3.0 * stride_rad));
        let offset_m = [right_m, ahead_m, up_m].map(|c| vigour * c);
        Body { step_phase, vigour, offset_m, bounce, ..still }
    }

    /// A burst after each contact, as strong as the step was long; and whether the right heel struck.
    fn jolt_m(&self, bout: &Bout, time_s: f64) -> ([f64; 3], bool) {
        let k = bout.contacts.partition_point(|contact| contact.time_s <= time_s);
        let Some(contact) = k.checked_sub(1).map(|k| bout.contacts[k]) else { return ([0.0; 3], false) };
        let after_s = time_s - contact.time_s;
        if after_s >= JOLT_S {
            return ([0.0; 3], contact.is_right);
        }
        let window = libm::sin(PI * after_s / JOLT_S);
        let radians_s = TAU * JOLT_HZ;
        let peak_m = self.walker.heel_strike_m_s2 / (radians_s * radians_s);
        let drop_m = (-bout.climb_m.at(time_s)).max(0.0);
        let strength = bout.length_m.at(time_s) / self.walker.step_length_m(1.2) + LANDING_DOWN * drop_m;
        let ringing = window * window * window * window * libm::cos(radians_s * (after_s - 0.04) + PI);
        let up_m = contact.strength * peak_m * strength * ringing;
        let aside = if contact.is_right { -JOLT_ASIDE } else { JOLT_ASIDE };
        ([aside * up_m, -JOLT_BACK * up_m, up_m], contact.is_right)
    }
}

impl Bout {
    fn of(steps: &[Step], course: &Course, noise: &mut Noise) -> Option<Self> {
        let (first, last) = (steps.first()?, steps.last()?);
        let times_s: Vec<f64> = [first.start_s].into_iter().chain(steps.iter().map(|s| s.end_s)).collect();
        let places_m = [first.from_m].into_iter().chain(steps.iter().map(|s| s.from_m + s.length_m));
        let places_m: Vec<f64> = places_m.collect();
        let heights_m: Vec<f64> = places_m.iter().map(|&at_m| course.height_m(at_m)).collect();
        let climbs_m = heights_m.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let phases = (0..times_s.len()).map(|k| k as f64);
        let middles_s: Vec<f64> = steps.iter().map(|s| 0.5 * (s.start_s + s.end_s)).collect();
        Some(Self {
            start_s: first.start_s,
            end_s: last.end_s,
            full_s: [first.end_s, last.start_s],
            at_m: Spline::new(times_s.clone(), places_m, Ends::Level),
            phase: Spline::new(times_s.clone(), phases.collect(), Ends::Straight),
            height_m: Spline::new(times_s.clone(), heights_m, Ends::Level),
            climb_m: Spline::new(middles_s.clone(), climbs_m, Ends::Straight),
            step_hz: Spline::new(
                middles_s.clone(),
                steps.iter().map(|s| 1.0 / (s.end_s - s.start_s)).collect(),
                Ends::Straight,
            ),
            length_m: Spline::new(middles_s, steps.iter().map(|s| s.length_m).collect(), Ends::Straight),
            contacts: steps
                .iter()
                .map(|step| Contact {
                    time_s: step.end_s,
                    is_right: step.is_right,
                    strength: noise.typical(1.0, JOLT_SD),
                })
                .collect(),
            is_first_right: first.is_right,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk(pauses: &[Pause]) -> Gait {
        let line = [(0.0, 0.0), (0.0, 20.0), (15.0, 20.0), (15.0, 2.0)].map(|(x, y)| Point2::new(x, y));
        Gait::new(&WalkerProfile::default(), Course::new(&line), pauses, 1.5, 7)
    }

    #[test]
    fn steps_follow_each_other_and_cover_the_path() {
        let gait = walk(&[Pause { at_m: 30.0, duration_s: 4.0 }]);
        let steps = gait.steps();
        assert!(steps.windows(2).all(|p| p[0].end_s <= p[1].start_s && p[0].is_right != p[1].is_right));
        let total_m: f64 = steps.iter().map(|s| s.length_m).sum();
        assert!((total_m - 53.0).abs() < 1e-2, "{total_m}");
        assert!((75..95).contains(&steps.len()), "{} steps", steps.len());
        let gap_s = steps.windows(2).map(|p| p[1].start_s - p[0].end_s).fold(0.0, f64::max);
        assert!((gap_s - 4.0).abs() < 1e-9);
        let end = gait.body(gait.duration_s()).position;
        assert!(end.distance_m(Point2::new(15.0, 2.0)) < 0.3, "{end:?}");
        assert_eq!(gait.body(0.5).vigour, 0.0);
    }

    #[test]
    fn a_walker_changes_speed_where_asked() {
        let line = [Point2::new(0.0, 0.0), Point2::new(0.0, 120.0)];
        let paces = [Pace { from_m: 40.0, factor: 0.6 }, Pace { from_m: 80.0, factor: 1.4 }];
        let walker = WalkerProfile::default();
        let gait = Gait::with_paces(&walker, Course::new(&line), &[], &paces, 1.5, 7);
        let speed_m_s =
            |from_m: f64, to_m: f64| (to_m - from_m) / (gait.time_at_s(to_m) - gait.time_at_s(from_m));
        for (from_m, to_m, expected_m_s) in [(5.0, 38.0, 1.2), (43.0, 78.0, 0.72), (83.0, 115.0, 1.68)] {
            let walked_m_s = speed_m_s(from_m, to_m);
            assert!((walked_m_s / expected_m_s - 1.0).abs() < 0.1, "{walked_m_s} m/s, meant {expected_m_s}");
        }
    }

    #[test]
    fn the_body_never_walks_backwards_nor_turns_too_fast() {
        let gait = walk(&[]);
        let h = 0.01;
        let n = (gait.duration_s() / h) as usize;
        for k in 0..n {
            let (now, next) = (gait.body(k as f64 * h), gait.body((k + 1) as f64 * h));
            let ahead_m = gait.walked_m((k + 1) as f64 * h) - gait.walked_m(k as f64 * h);
            assert!(ahead_m > -1e-4 && ahead_m / h < 1.9, "{} m/s", ahead_m / h);
            let turning_rad_s = wrap_rad(next.heading_rad - now.heading_rad) / h;
            assert!(turning_rad_s.abs() < 3.5, "{turning_rad_s} rad/s");
        }
    }

    #[test]
    fn the_trunk_accelerates_as_published() {
        // Vertical acceleration of the trunk at 1.2 m/s: about 1.5 to 2.5 m/s² root mean square; along and across less.
        let gait = walk(&[]);
        let h = 0.002;
        let mut squares = [0.0; 3];
        let mut n = 0.0;
        for k in 0..400 {
            let t = 5.0 + 0.013 * f64::from(k);
            let place = |t: f64| {
                let body = gait.body(t);
                [0, 1, 2]
                    .map(|c| body.offset_m[c] + body.jolt_m[c] + if c == 2 { body.bounced_m() } else { 0.0 })
            };
            let (a, b, c) = (place(t - h), place(t), place(t + h));
            for d in 0..3 {
                let acceleration = (a[d] - 2.0 * b[d] + c[d]) / (h * h);
                squares[d] += acceleration * acceleration;
            }
            n += 1.0;
        }
        let rms = squares.map(|s| (s / n).sqrt());
        println!("trunk: right, ahead, up {rms:.2?} m/s² rms");
        assert!((1.2..3.0).contains(&rms[2]) && rms[0] < rms[2] && rms[1] < rms[2], "{rms:?}");
    }
}
