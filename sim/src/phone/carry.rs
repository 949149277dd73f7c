//! Ways to carry a phone: its place on the body and its attitude, swaying with the gait.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::noise::{Noise, SmoothNoise};
use crate::phone::hold::Hold;
use crate::vector::{Quaternion, Vector3, about, add, compose, rotate};
use crate::walker::{Body, JOLT_HZ};

const RIGHT: Vector3 = [1.0, 0.0, 0.0];
const AHEAD: Vector3 = [0.0, 1.0, 0.0];
const UP: Vector3 = [0.0, 0.0, 1.0];
/// The phone's frequency when it is shaken, in Hz, and the hand's way to either side, in metres.
const SHAKEN_HZ: f64 = 3.2;
const SHAKEN_M: f64 = 0.05;

/// Where a phone is while its owner walks.
///
/// # Source
/// The attitudes are those of mass-centred 2019, Table 1 (its names in capitals). Angles and swings of the hand, the ear
/// and the pockets are rounded from the motion capture of Michel et al. 2017 (one person, two phones).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CarryMode {
    /// Held before the chest, screen up, top edge ahead and a little up (UFH): reading, texting.
    HeldLevel,
    /// Held before the face, screen to the eyes, top edge ahead and far up (UFNH): a picture is taken.
    HeldUpright,
    /// Held level, top edge to the left (UL): a film is watched.
    HeldLandscape,
    /// Held level towards somebody half to the left, while the body goes on (UNF).
    HeldAskew,
    /// At the right ear.
    AtEar,
    /// In the right hand beside the body, swinging with the arm.
    SwingingHand,
    /// In the right front trouser pocket, top down, screen outward; it swings with the thigh.
    FrontPocket,
    /// In the right back trouser pocket, top up, screen to the back.
    BackPocket,
    /// Shaken by the hand that holds it.
    Shaken,
    /// On a table where the owner stood when it was put down.
    OnTable,
    /// An ID card on a strap before the chest, upright, its back ahead.
    OnStrap {
        /// Height over the floor, in centimetres.
        height_cm: u16,
    },
}

impl CarryMode {
    /// All ways to carry a phone; a card's is none.
    pub const ALL: [Self; 10] = [
        Self::HeldLevel,
        Self::HeldUpright,
        Self::HeldLandscape,
        Self::HeldAskew,
        Self::AtEar,
        Self::SwingingHand,
        Self::FrontPocket,
        Self::BackPocket,
        Self::Shaken,
        Self::OnTable,
    ];

    /// Whether a hand holds it before the body.
    fn is_held(self) -> bool {
        use CarryMode::{HeldAskew, HeldLandscape, HeldLevel, HeldUpright, Shaken};
        matches!(self, HeldLevel | HeldUpright | HeldLandscape | HeldAskew | Shaken)
    }
}

/// One person's way of holding a phone: what is constant over a walk, and how the hand wavers.
#[derive(Clone, Debug)]
pub struct Grip {
    /// Height of the person, in metres.
    height_m: f64,
    /// Constant turn against the usual attitude, about right, ahead and up, in radians.
    turn_rad: [f64; 3],
    /// Slow wavering about the same axes.
    waver: [SmoothNoise; 3],
    /// Phases of the sway against the gait, in radians.
    phase_rad: [f64; 3],
    /// Size of limbs' swings and of the sway, 1 on average.
    liveliness: f64,
    /// Turn of the phone on a table, in radians.
    table_turn_rad: f64,
    hold: Hold,
}

impl Grip {
    /// The grip of a person of `height_m` by chance.
    pub fn drawn(height_m: f64, seed: u64) -> Self {
        let mut noise = Noise::new(seed, "grip", 0);
        Self {
            height_m,
            turn_rad: [0.12, 0.05, 0.08].map(|sd| noise.typical(0.0, sd)),
            waver: [0.02, 0.015, 0.03].map(|sd| SmoothNoise::new(&mut noise, sd, [0.02, 0.25])),
            phase_rad: [0; 3].map(|_| noise.within(-0.5, 0.5)),
            liveliness: noise.typical(1.0, 0.15),
            table_turn_rad: noise.within(-PI, PI),
            hold: Hold::drawn(&mut noise),
        }
    }

    /// The phone's place (right, ahead, up, from the floor under the trunk), and the rotation from its frame.
    pub(super) fn pose(&self, mode: CarryMode, body: &Body, time_s: f64) -> (Vector3, Quaternion) {
        let (step_rad, stride_rad) = (TAU * body.step_phase, PI * body.step_phase);
        let lively = body.vigour * self.liveliness;
        // The right leg is farthest back when the left heel strikes, at even numbers, and farthest ahead half a stride on.
        let swing = |phase: usize| -lively * libm::cos(stride_rad + 0.4 * self.phase_rad[phase]);
        // Legs are thrown ahead and set down: the thigh's swing is no pure tone.
        let thrown = lively * libm::sin(2.0 * stride_rad + self.phase_rad[2]);
        let height_m = self.height_m;
        let (place, attitude) = match mode {
            CarryMode::HeldLevel => ([0.0, 0.32, 0.64 * height_m], about(RIGHT, 0.25)),
            CarryMode::HeldUpright => ([0.0, 0.35, 0.78 * height_m], about(RIGHT, 1.1)),
            CarryMode::HeldLandscape => {
                ([0.0, 0.32, 0.66 * height_m], compose(about(RIGHT, 0.25), about(UP, FRAC_PI_2)))
            }
            CarryMode::HeldAskew => {
                ([-0.1, 0.3, 0.66 * height_m], compose(about(UP, 0.9), about(RIGHT, 0.2)))
            }
            CarryMode::Shaken => return self.shaken(body, time_s),
            CarryMode::BackPocket => {
                // The seat turns with the pelvis and is pushed by the thigh.
                let pelvis =
                    compose(about(UP, 0.2 * swing(2)), about(RIGHT, 0.15 * swing(0) + 0.05 * thrown));
                let seat = compose(about(UP, 2.5), about(RIGHT, 1.3));
                (add([0.09, -0.1, 0.52 * height_m], rotate(pelvis, [0.0, -0.1, -0.1])), compose(pelvis, seat))
            }
            CarryMode::FrontPocket => {
                let thigh = about(RIGHT, 0.4 * swing(0) + 0.11 * thrown);
                let hip = [0.11, 0.04, 0.53 * height_m];
                (add(hip, rotate(thigh, [0.0, 0.08, -0.2])), compose(thigh, about(RIGHT, -FRAC_PI_2 - 0.1)))
            }
            CarryMode::AtEar => {
                let upright = compose(about(UP, -FRAC_PI_2), about(RIGHT, FRAC_PI_2));
                ([0.1, 0.03, 0.93 * height_m], compose(about(RIGHT, 0.7), upright))
            }
            CarryMode::SwingingHand => {
                // Hands hang a little ahead, and swing against the leg of their side.
                let arm = about(RIGHT, 0.2 - 0.5 * swing(0));
                let shoulder = [0.22, 0.0, 0.82 * height_m];
                let in_hand = compose(about(RIGHT, -0.4), about(AHEAD, -FRAC_PI_2));
                (add(shoulder, rotate(arm, [0.0, 0.05, -0.4 * height_m])), compose(arm, in_hand))
            }
            CarryMode::OnTable => return ([0.3, 0.5, 0.75], about(UP, self.table_turn_rad)),
            CarryMode::OnStrap { height_cm } => {
                // It twists on its strap and leans on the chest, top to the back.
                let twisted = about(UP, 0.1 * swing(2));
                let upright = about(RIGHT, FRAC_PI_2 + 0.1);
                ([0.0, 0.14, 0.01 * f64::from(height_cm)], compose(twisted, upright))
            }
        };
        // An ear turns with the head at every stride, but tilts no more than a hand.
        let turning = if mode == CarryMode::AtEar { 2.0 } else { 1.0 };
        let sway = [
            0.035 * lively * libm::sin(step_rad + self.phase_rad[1]),
            0.04 * swing(1),
            turning * 0.06 * swing(2),
        ];
        let turn = [0, 1, 2].map(|c| self.turn_rad[c] + self.waver[c].at(time_s) + sway[c]);
        let held = compose(about(UP, turn[2]), compose(about(AHEAD, turn[1]), about(RIGHT, turn[0])));
        (place, compose(held, attitude))
    }

    /// A hand before the chest that shakes the phone from side to side.
    fn shaken(&self, body: &Body, time_s: f64) -> (Vector3, Quaternion) {
        let (place, attitude) = self.pose(CarryMode::HeldLevel, body, time_s);
        // Hands tire and begin again.
        let shaking = self.liveliness * (0.8 + 4.0 * self.waver[1].at(time_s));
        let phase_rad = TAU * SHAKEN_HZ * time_s + 8.0 * self.waver[2].at(time_s);
        let (sin, cos) = libm::sincos(phase_rad);
        let offset = [SHAKEN_M * shaking * sin, 0.3 * SHAKEN_M * shaking * cos, 0.0];
        (add(place, offset), compose(about(AHEAD, 0.25 * shaking * sin), attitude))
    }

    /// The phone's rise by the trunk's bounce, in metres.
    pub(super) fn bounced_m(&self, mode: CarryMode, body: &Body) -> f64 {
        if mode.is_held() { self.hold.bounced_m(body) } else { body.bounced_m() }
    }

    /// How much of a heel strike's jolt reaches the phone. In a right pocket the right foot is felt most.
    pub(super) fn jolt_share(&self, mode: CarryMode, body: &Body) -> f64 {
        let own_leg = |near: f64, far: f64| if body.is_right_down { near } else { far };
        match mode {
            CarryMode::SwingingHand => 0.5,
            CarryMode::FrontPocket => own_leg(2.0, 0.8),
            CarryMode::BackPocket => own_leg(1.8, 1.0),
            CarryMode::AtEar => 0.6,
            CarryMode::OnTable => 0.0,
            CarryMode::OnStrap { .. } => 1.0,
            _ => self.hold.response(JOLT_HZ).0,
        }
    }
}
