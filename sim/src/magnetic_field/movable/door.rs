//! Doors with a leaf of steel: left open or shut, and used while one walks by.

use std::f64::consts::FRAC_PI_2;

use fieldwalk::geometry::Point2;

use crate::building::Building;
use crate::magnetic_field::{MovableParams, Source};
use crate::noise::{Noise, smooth_step};

/// How long a leaf takes to swing, and stays open, in seconds.
const SWING_S: f64 = 1.5;
const OPEN_S: f64 = 2.5;

/// A leaf of steel.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    hinge: Point2,
    /// From the hinge to the free edge when shut, and when open, in metres.
    shut: Point2,
    open: Point2,
    pole_ut_m2: f64,
    is_left_open: bool,
    /// When somebody uses the door.
    uses_s: Vec<f64>,
}

/// The leaves of steel of `building` during a walk.
pub(super) fn leaves(
    building: &Building,
    params: &MovableParams,
    duration_s: f64,
    [building_seed, seed]: [u64; 2],
) -> Vec<Leaf> {
    let leaf = |(door, index)| {
        let door: &crate::building::Door = door;
        let mut lasting = Noise::new(building_seed, "door leaf", index);
        let is_steel = lasting.chance(params.steel_doors);
        let pole_ut_m2 = lasting.normal(params.leaf_ut_m2);
        let mut today = Noise::new(seed, "door", index);
        let is_left_open = today.chance(0.4);
        let per_minute = if is_left_open { 0.0 } else { params.door_uses_per_minute };
        let busy_s = 2.0 * SWING_S + OPEN_S;
        let uses_s = today.arrivals_s(-busy_s, duration_s, per_minute, busy_s);
        let width_m = 0.9 * door.width_m;
        is_steel.then(|| Leaf {
            hinge: door.centre - door.along * (0.5 * door.width_m),
            shut: door.along * width_m,
            open: building.inward(door) * width_m,
            pole_ut_m2,
            is_left_open,
            uses_s,
        })
    };
    building.doors.iter().zip(0u64..).filter_map(leaf).collect()
}

impl Leaf {
    /// Whether nobody uses the door during the walk.
    pub(super) fn is_still(&self) -> bool {
        self.uses_s.is_empty()
    }

    /// The leaf's two halves. Shut, the free edge meets the other jamb; open, it stands in the room.
    pub(super) fn at(&self, time_s: f64) -> [Source; 2] {
        let used = self.uses_s.iter().map(|start_s| {
            let after_s = time_s - start_s;
            smooth_step(after_s / SWING_S) - smooth_step((after_s - SWING_S - OPEN_S) / SWING_S)
        });
        let opened = if self.is_left_open { 1.0 } else { used.fold(0.0, f64::max) };
        let (sin, cos) = libm::sincos(FRAC_PI_2 * opened);
        let edge = self.shut * cos + self.open * sin;
        [0.25, 0.9].map(|share| {
            let p = self.hinge + edge * share;
            Source::Bar {
                north_pole_m: [p.x_m, p.y_m, 2.0],
                south_pole_m: [p.x_m, p.y_m, 0.02],
                pole_ut_m2: 0.5 * self.pole_ut_m2,
            }
        })
    }
}
