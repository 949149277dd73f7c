//! Ways to carry a phone: its place on the body and its attitude, swaying with the gait.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::noise::{Noise, SmoothNoise};
use crate::vector::{Quaternion, Vector3, about, add, compose, rotate};
use crate::walker::Body;

const RIGHT: Vector3 = [1.0, 0.0, 0.0];
const AHEAD: Vector3 = [0.0, 1.0, 0.0];
const UP: Vector3 = [0.0, 0.0, 1.0];

/// Where a phone is while its owner walks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CarryMode {
    /// Held before the chest, screen up, top edge ahead and a little up.
    HeldLevel,
    /// In the right front trouser pocket, top down, screen outward; it swings with the thigh.
    FrontPocket,
    /// At the right ear.
    AtEar,
    /// In the right hand beside the body, swinging with the arm.
    SwingingHand,
    /// On a table where the owner stood when it was put down.
    OnTable,
}

impl CarryMode {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::HeldLevel, Self::FrontPocket, Self::AtEar, Self::SwingingHand, Self::OnTable];
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
        }
    }

    /// The phone's place (right, ahead, up, from the floor under the trunk), and the rotation from its frame.
    pub(super) fn pose(&self, mode: CarryMode, body: &Body, time_s: f64) -> (Vector3, Quaternion) {
        let (step_rad, stride_rad) = (TAU * body.step_phase, PI * body.step_phase);
        let lively = body.vigour * self.liveliness;
        let swing = |phase: usize| lively * libm::sin(stride_rad + self.phase_rad[phase]);
        let height_m = self.height_m;
        let (place, attitude) = match mode {
            CarryMode::HeldLevel => ([0.0, 0.32, 0.64 * height_m], about(RIGHT, 0.45)),
            CarryMode::FrontPocket => {
                let thigh = about(RIGHT, 0.42 * swing(0));
                let hip = [0.11, 0.04, 0.53 * height_m];
                (add(hip, rotate(thigh, [0.0, 0.07, -0.16])), compose(thigh, about(RIGHT, -FRAC_PI_2 - 0.1)))
            }
            CarryMode::AtEar => {
                let upright = compose(about(UP, -FRAC_PI_2), about(RIGHT, FRAC_PI_2));
                ([0.1, 0.03, 0.93 * height_m], compose(about(RIGHT, 0.6), upright))
            }
            CarryMode::SwingingHand => {
                // Hands hang a little ahead, and swing against the leg of their side.
                let arm = about(RIGHT, 0.15 - 0.35 * swing(0));
                let shoulder = [0.22, 0.0, 0.82 * height_m];
                let in_hand = compose(about(RIGHT, -0.6), about(AHEAD, -FRAC_PI_2));
                (add(shoulder, rotate(arm, [0.0, 0.05, -0.4 * height_m])), compose(arm, in_hand))
            }
            CarryMode::OnTable => return ([0.3, 0.5, 0.75], about(UP, self.table_turn_rad)),
        };
        let sway =
            [0.02 * lively * libm::sin(step_rad + self.phase_rad[1]), 0.02 * swing(1), 0.035 * swing(2)];
        let turn = [0, 1, 2].map(|c| self.turn_rad[c] + self.waver[c].at(time_s) + sway[c]);
        let held = compose(about(UP, turn[2]), compose(about(AHEAD, turn[1]), about(RIGHT, turn[0])));
        (place, compose(held, attitude))
    }

    /// How much of a heel strike's jolt reaches the phone.
    pub(super) fn jolt_share(mode: CarryMode) -> f64 {
        match mode {
            CarryMode::HeldLevel | CarryMode::SwingingHand => 0.5,
            CarryMode::FrontPocket => 1.5,
            CarryMode::AtEar => 0.6,
            CarryMode::OnTable => 0.0,
        }
    }
}
