//! The walker, the phone in the hand, and seeded noise.

use std::f64::consts::{PI, TAU};

use fieldwalk::geometry::{Point2, wrap_rad};
use fieldwalk::random::CounterRng;
use fieldwalk::sensor::Reading;
use fieldwalk::survey::Waypoint;
use fieldwalk::time::Duration;
use rand::Rng as _;

use super::WALK_START;

const STAND_BEFORE_S: f64 = 1.5;
const STAND_AFTER_S: f64 = 1.0;
/// A turn at a corner takes this long, centred on it, in seconds.
const TURN_S: f64 = 0.8;
/// The gait swells and fades over this long, in seconds.
const GAIT_FADE_S: f64 = 0.3;
const GAIT_M_S2: f64 = 3.0;

/// Where a walker is when: an even pace along straight lines, standing before and after.
pub(super) struct Course {
    pub(super) waypoints: Vec<Waypoint>,
    /// Start of each line in seconds, and its heading.
    lines: Vec<(f64, f64)>,
    walk_s: std::ops::Range<f64>,
    pub(super) end_s: f64,
    places: Vec<(f64, Point2)>,
}

impl Course {
    pub(super) fn new(waypoints: &[Point2], pace_m_s: f64) -> Self {
        let mut s = STAND_BEFORE_S;
        let mut places = Vec::new();
        let mut lines = Vec::new();
        for (k, &point) in waypoints.iter().enumerate() {
            places.push((s, point));
            if let Some(&next) = waypoints.get(k + 1) {
                lines.push((s, (next - point).heading_rad()));
                s += point.distance_m(next) / pace_m_s;
            }
        }
        let waypoints = places
            .iter()
            .map(|&(s, point)| Waypoint { time: WALK_START + Duration::from_secs_f64(s), point })
            .collect();
        Self { waypoints, lines, walk_s: STAND_BEFORE_S..s, end_s: s + STAND_AFTER_S, places }
    }

    pub(super) fn position(&self, s: f64) -> Point2 {
        let between = self.places.windows(2).find(|pair| (pair[0].0..pair[1].0).contains(&s));
        match (between, self.places.first(), self.places.last()) {
            (Some(pair), _, _) => pair[0].1.lerp(pair[1].1, (s - pair[0].0) / (pair[1].0 - pair[0].0)),
            (None, Some(first), _) if s < first.0 => first.1,
            (None, _, last) => last.map_or(Point2::default(), |last| last.1),
        }
    }

    /// The walker's heading and its rate of change: half a cosine about every corner.
    pub(super) fn heading(&self, s: f64) -> (f64, f64) {
        let (mut heading_rad, mut turning_rad_s) = (self.lines.first().map_or(0.0, |line| line.1), 0.0);
        for pair in self.lines.windows(2) {
            let turn_rad = wrap_rad(pair[1].1 - pair[0].1);
            let share = ((s - pair[1].0) / TURN_S + 0.5).clamp(0.0, 1.0);
            heading_rad += turn_rad * 0.5 * (1.0 - libm::cos(PI * share));
            turning_rad_s += turn_rad * 0.5 * PI / TURN_S * libm::sin(PI * share);
        }
        (heading_rad, turning_rad_s)
    }
}

/// The walker's body at one instant.
pub(super) struct Body {
    pub(super) position: Point2,
    pub(super) heading_rad: f64,
    pub(super) turning_rad_s: f64,
    /// Right, ahead and up.
    pub(super) force_m_s2: [f64; 3],
}

impl Body {
    pub(super) fn at(course: &Course, step_hz: f64, s: f64) -> Self {
        let (heading_rad, turning_rad_s) = course.heading(s);
        let into_s = (s - course.walk_s.start).min(course.walk_s.end - s);
        let gait = (into_s / GAIT_FADE_S).clamp(0.0, 1.0);
        let phase_rad = TAU * step_hz * (s - course.walk_s.start);
        // The body sways once in two steps.
        let sway_rad = 0.03 * gait;
        let swaying_rad_s = sway_rad * 0.5 * TAU * step_hz * libm::cos(0.5 * phase_rad);
        let up_m_s2 = libm::sin(phase_rad) + 0.25 * libm::sin(2.0 * phase_rad + 0.7);
        Self {
            position: course.position(s),
            heading_rad: heading_rad + sway_rad * libm::sin(0.5 * phase_rad),
            turning_rad_s: turning_rad_s + swaying_rad_s,
            force_m_s2: [
                0.5 * gait * libm::sin(0.5 * phase_rad + 0.4),
                0.8 * gait * libm::sin(phase_rad + 1.3),
                9.806_65 + GAIT_M_S2 * gait * up_m_s2,
            ],
        }
    }
}

/// `field` of the floor frame, in the frame right, ahead and up of a walker.
pub(super) fn in_walker_frame(field: [f64; 3], heading_rad: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(heading_rad);
    [field[0] * cos - field[1] * sin, field[0] * sin + field[1] * cos, field[2]]
}

/// A phone held in front of the body, its top edge ahead and a little up.
pub(super) struct Phone {
    pitch_rad: f64,
    gyroscope_bias_rad_s: [f64; 3],
    hard_iron_ut: [f64; 3],
    os_bias_ut: [f64; 3],
}

impl Phone {
    pub(super) fn new(noise: &mut Noise) -> Self {
        let mut three = |low: f64, high: f64| [0; 3].map(|_| noise.within(low, high));
        Self {
            gyroscope_bias_rad_s: three(-0.004, 0.004),
            hard_iron_ut: three(-2.5, 2.5),
            os_bias_ut: three(-30.0, 30.0),
            pitch_rad: noise.within(0.3, 0.7),
        }
    }

    /// `v` (right, ahead, up) in the device frame, with a bias and noise.
    pub(super) fn read(&self, v: [f64; 3], bias: [f64; 3], sd: f64, noise: &mut Noise) -> [f32; 3] {
        let (sin, cos) = libm::sincos(self.pitch_rad);
        let device = [v[0], v[1] * cos + v[2] * sin, v[2] * cos - v[1] * sin];
        [0, 1, 2].map(|c| (device[c] + bias[c] + noise.normal(sd)) as f32)
    }

    pub(super) fn angular_rate(&self, rate_rad_s: [f64; 3], noise: &mut Noise) -> Reading {
        Reading::AngularRate(self.read(rate_rad_s, self.gyroscope_bias_rad_s, 0.01, noise))
    }

    pub(super) fn specific_force(&self, force_m_s2: [f64; 3], noise: &mut Noise) -> Reading {
        Reading::SpecificForce(self.read(force_m_s2, [0.0; 3], 0.1, noise))
    }

    pub(super) fn field(&self, field_ut: [f64; 3], noise: &mut Noise) -> Reading {
        let bias = [0, 1, 2].map(|c| self.hard_iron_ut[c] + self.os_bias_ut[c]);
        Reading::UncalibratedMagneticField {
            field_ut: self.read(field_ut, bias, 0.4, noise),
            bias_ut: self.os_bias_ut.map(|c| c as f32),
        }
    }
}

/// Seeded random numbers, the same on every machine.
pub(super) struct Noise {
    rng: CounterRng,
}

impl Noise {
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        Self { rng: CounterRng::new(seed, stream) }
    }

    /// Uniform in (0, 1).
    pub(super) fn unit(&mut self) -> f64 {
        (f64::from(self.rng.next_u32()) + 0.5) / 4_294_967_296.0
    }

    pub(super) fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Normal about 0, by Box and Muller.
    pub(super) fn normal(&mut self, sd: f64) -> f64 {
        let radius = (-2.0 * libm::log(self.unit())).sqrt();
        sd * radius * libm::cos(TAU * self.unit())
    }

    pub(super) fn direction(&mut self) -> [f64; 3] {
        let v = [0; 3].map(|_| self.normal(1.0));
        let norm = v.iter().map(|c| c * c).sum::<f64>().sqrt();
        v.map(|c| c / norm)
    }
}
