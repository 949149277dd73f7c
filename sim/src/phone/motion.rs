//! A phone in space and time: its pose, and what follows from it without any sensor.

use fieldwalk::gravity::STANDARD_GRAVITY_M_S2;

use crate::noise::smooth_step;
use crate::phone::{CarryMode, Grip};
use crate::vector::{
    Quaternion, Vector3, about, add, between, compose, inverse, rotate, rotate_back, rotation_vector, scale,
    subtract,
};
use crate::walker::{Body, Gait, Wave};

/// How long it takes to carry the phone otherwise, in seconds.
const CHANGE_S: f64 = 1.5;
/// Derivatives are central differences over this to either side, in seconds.
const DIFFERENCE_S: f64 = 1.0 / 512.0;

/// Place and attitude of a phone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Along the floor's x, along its y, and height over the floor, in metres.
    pub place_m: [f64; 3],
    /// Unit quaternion `[w, x, y, z]` that turns the device frame into the floor frame (x, y, up).
    pub floor_from_device: [f64; 4],
}

/// A phone carried through a walk: everything that its sensors could feel, exactly.
///
/// Specific force and angular rate are derivatives of one smooth pose, so that they agree with it and each other.
#[derive(Clone, Debug)]
pub struct Carried {
    gait: Gait,
    grip: Grip,
    /// From when on the phone is carried how, in order of time.
    schedule: Vec<(f64, CarryMode)>,
}

impl Carried {
    /// A phone in `grip` through `gait`; `schedule` says from which second on it is carried how.
    ///
    /// Its first entry holds from the beginning; an empty one means held level.
    pub fn new(gait: Gait, grip: Grip, schedule: &[(f64, CarryMode)]) -> Self {
        let mut schedule = schedule.to_vec();
        schedule.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { gait, grip, schedule }
    }

    /// The walk.
    pub fn gait(&self) -> &Gait {
        &self.gait
    }

    /// How the phone is carried at `time_s`.
    pub fn mode(&self, time_s: f64) -> CarryMode {
        self.entry(time_s).1
    }

    fn entry(&self, time_s: f64) -> (f64, CarryMode) {
        let begun = self.schedule.partition_point(|(from_s, _)| *from_s <= time_s);
        let first = self.schedule.first().map_or(CarryMode::HeldLevel, |(_, mode)| *mode);
        self.schedule[..begun].last().copied().unwrap_or((f64::NEG_INFINITY, first))
    }

    /// The phone's pose at `time_s`.
    pub fn pose(&self, time_s: f64) -> Pose {
        let body = self.gait.body(time_s);
        let (from_s, mode) = self.entry(time_s);
        let now = self.pose_as(mode, from_s, &body, time_s);
        let share = smooth_step((time_s - from_s) / CHANGE_S);
        if share >= 1.0 {
            return now;
        }
        // The entry before this one ended when this one began.
        let begun = self.schedule.partition_point(|(start_s, _)| *start_s <= time_s);
        let Some((last_from_s, last_mode)) = begun.checked_sub(2).map(|k| self.schedule[k]) else {
            return now;
        };
        let last = self.pose_as(last_mode, last_from_s, &body, time_s);
        Pose {
            place_m: add(last.place_m, scale(subtract(now.place_m, last.place_m), share)),
            floor_from_device: between(last.floor_from_device, now.floor_from_device, share),
        }
    }

    fn pose_as(&self, mode: CarryMode, from_s: f64, body: &Body, time_s: f64) -> Pose {
        // A phone on a table stays where its owner put it.
        let (body, time_s) = match mode {
            CarryMode::OnTable => (self.gait.body(from_s.max(0.0)), from_s.max(0.0)),
            _ => (*body, time_s),
        };
        let still =
            Body { vigour: 0.0, offset_m: [0.0; 3], bounce: [Wave::default(); 3], jolt_m: [0.0; 3], ..body };
        let body = if mode == CarryMode::OnTable { still } else { body };
        let (place_m, body_from_device) = self.grip.pose(mode, &body, time_s);
        let jolt = scale(body.jolt_m, self.grip.jolt_share(mode, &body));
        let jolt = add(jolt, [0.0, 0.0, self.grip.bounced_m(mode, &body)]);
        let floor_from_body: Quaternion = about([0.0, 0.0, 1.0], -body.heading_rad);
        let offset: Vector3 = add(add(place_m, body.offset_m), jolt);
        let trunk = [body.position.x_m, body.position.y_m, body.height_m];
        Pose {
            place_m: add(trunk, rotate(floor_from_body, offset)),
            floor_from_device: compose(floor_from_body, body_from_device),
        }
    }

    /// Specific force in the device frame at `time_s`, in m/s²: +9.81 upward at rest.
    pub fn specific_force_m_s2(&self, time_s: f64) -> [f64; 3] {
        let h = DIFFERENCE_S;
        let here = self.pose(time_s);
        let sum = add(self.pose(time_s - h).place_m, self.pose(time_s + h).place_m);
        let acceleration = scale(subtract(sum, scale(here.place_m, 2.0)), 1.0 / (h * h));
        let force = add(acceleration, [0.0, 0.0, f64::from(STANDARD_GRAVITY_M_S2)]);
        rotate_back(here.floor_from_device, force)
    }

    /// Angular rate in the device frame at `time_s`, in rad/s.
    pub fn angular_rate_rad_s(&self, time_s: f64) -> [f64; 3] {
        let h = DIFFERENCE_S;
        let (before, after) = (self.pose(time_s - h), self.pose(time_s + h));
        let turn = compose(inverse(before.floor_from_device), after.floor_from_device);
        scale(rotation_vector(turn), 0.5 / h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{dot, norm};
    use crate::walker::{Course, Pause, WalkerProfile};
    use fieldwalk::geometry::Point2;

    fn carried(mode: CarryMode) -> Carried {
        let line = [(0.0, 0.0), (0.0, 14.0), (12.0, 14.0), (12.0, 3.0)].map(|(x, y)| Point2::new(x, y));
        let walker = WalkerProfile::drawn(3);
        let pauses = [Pause { at_m: 20.0, duration_s: 3.0 }];
        let gait = Gait::new(&walker, Course::new(&line), &pauses, 1.5, 5);
        Carried::new(gait, Grip::drawn(walker.height_m, 9), &[(0.0, mode)])
    }

    #[test]
    fn at_rest_the_force_is_gravity_upward() {
        for mode in CarryMode::ALL.into_iter().filter(|mode| *mode != CarryMode::Shaken) {
            let carried = carried(mode);
            let force = carried.specific_force_m_s2(0.7);
            let up = rotate_back(carried.pose(0.7).floor_from_device, [0.0, 0.0, 1.0]);
            assert!((dot(force, up) - 9.806_65).abs() < 0.05, "{mode:?} {force:?}");
            assert!(norm(carried.angular_rate_rad_s(0.7)) < 0.1, "{mode:?}");
        }
        // But for the hand that shakes while its owner stands: half a g and more, screen up on the whole.
        let shaken = carried(CarryMode::Shaken);
        let (mut square, mut screen) = (0.0, 0.0);
        for k in 0..300 {
            let t = 0.004 * f64::from(k);
            let off_m_s2 = norm(shaken.specific_force_m_s2(t)) - f64::from(STANDARD_GRAVITY_M_S2);
            square += off_m_s2 * off_m_s2 / 300.0;
            screen += rotate_back(shaken.pose(t).floor_from_device, [0.0, 0.0, 1.0])[2] / 300.0;
        }
        assert!(square.sqrt() > 5.0 && screen > 0.8, "{square} {screen}");
        // Screen up on the table, and nearly so in the hand; top up at the ear; top down in the pocket.
        let up = |mode| rotate_back(carried(mode).pose(0.7).floor_from_device, [0.0, 0.0, 1.0]);
        assert!(up(CarryMode::OnTable)[2] > 0.999 && up(CarryMode::HeldLevel)[2] > 0.7);
        assert!(up(CarryMode::AtEar)[1] > 0.6 && up(CarryMode::FrontPocket)[1] < -0.8);
        assert!(up(CarryMode::SwingingHand)[0] > 0.7);
        // Held before the face the top is up; in the back pocket too, its screen looking back and a little down.
        assert!(up(CarryMode::HeldUpright)[1] > 0.7 && up(CarryMode::BackPocket)[1] > 0.85);
        for held in [CarryMode::HeldLandscape, CarryMode::HeldAskew] {
            assert!(up(held)[2] > 0.8, "{held:?}");
        }
    }

    #[test]
    fn top_edges_point_where_their_modes_say() {
        // How far ahead (+1), to the left (+1) the top edge points while standing, averaged over people.
        let top = |mode| {
            let mut sum = [0.0; 3];
            for seed in 0..20 {
                let Carried { gait, .. } = carried(mode);
                let carried = Carried::new(gait, Grip::drawn(1.7, seed), &[(0.0, mode)]);
                let heading = about([0.0, 0.0, 1.0], -carried.gait().body(0.7).heading_rad);
                let top = rotate(carried.pose(0.7).floor_from_device, [0.0, 1.0, 0.0]);
                sum = add(sum, scale(rotate_back(heading, top), 1.0 / 20.0));
            }
            [sum[1], -sum[0]]
        };
        assert!(top(CarryMode::HeldLevel)[0] > 0.9);
        assert!(top(CarryMode::HeldLandscape)[1] > 0.9);
        let [ahead, left] = top(CarryMode::HeldAskew);
        assert!((0.5..0.75).contains(&ahead) && left > 0.6, "{ahead} {left}");
        let [ahead, _] = top(CarryMode::SwingingHand);
        assert!(ahead > 0.6, "{ahead}");
    }

    #[test]
    fn the_angular_rate_integrates_to_the_attitude() {
        for mode in CarryMode::ALL {
            let carried = carried(mode);
            let (h, n) = (0.002, 10_000);
            let mut attitude = carried.pose(1.0).floor_from_device;
            for k in 0..n {
                let rate = carried.angular_rate_rad_s(1.0 + (f64::from(k) + 0.5) * h);
                let angle_rad = norm(rate) * h;
                if angle_rad > 0.0 {
                    attitude = compose(attitude, about(scale(rate, h / angle_rad), angle_rad));
                }
            }
            let truth = carried.pose(1.0 + f64::from(n) * h).floor_from_device;
            let off_rad = norm(rotation_vector(compose(inverse(truth), attitude)));
            assert!(off_rad < 2e-3, "{mode:?}: {off_rad} rad off after 20 s");
        }
    }

    #[test]
    fn the_specific_force_integrates_to_the_path() {
        for mode in CarryMode::ALL {
            let carried = carried(mode);
            let (h, n) = (0.001, 15_000);
            let start_s = 1.0;
            let mut place = carried.pose(start_s).place_m;
            let ahead = subtract(carried.pose(start_s + h).place_m, carried.pose(start_s - h).place_m);
            let mut velocity = scale(ahead, 0.5 / h);
            for k in 0..n {
                let t = start_s + (f64::from(k) + 0.5) * h;
                let force = rotate(carried.pose(t).floor_from_device, carried.specific_force_m_s2(t));
                let acceleration = subtract(force, [0.0, 0.0, f64::from(STANDARD_GRAVITY_M_S2)]);
                place = add(place, add(scale(velocity, h), scale(acceleration, 0.5 * h * h)));
                velocity = add(velocity, scale(acceleration, h));
            }
            let off_m = norm(subtract(place, carried.pose(start_s + f64::from(n) * h).place_m));
            assert!(off_m < 0.05, "{mode:?}: {off_m} m off after 15 s");
        }
    }

    #[test]
    fn a_phone_changes_hands_smoothly() {
        let Carried { gait, grip, .. } = carried(CarryMode::HeldLevel);
        let modes = [(0.0, CarryMode::HeldLevel), (6.0, CarryMode::FrontPocket), (14.0, CarryMode::AtEar)];
        let carried = Carried::new(gait, grip, &modes);
        assert_eq!((carried.mode(5.9), carried.mode(6.1)), (CarryMode::HeldLevel, CarryMode::FrontPocket));
        for k in 0..2_000 {
            let t = 1.0 + 0.01 * f64::from(k);
            assert!(
                norm(carried.specific_force_m_s2(t)) < 60.0 && norm(carried.angular_rate_rad_s(t)) < 15.0
            );
        }
    }
}
