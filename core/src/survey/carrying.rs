//! Whether the phone is carried as a survey needs it: its directions of the field are those of a phone held level before
//! the chest, top edge ahead.

use serde::{Deserialize, Serialize};

use crate::attitude::{Attitude, AttitudeEstimate, CarryMode};
use crate::pedestrian::StepEvent;

/// What is wrong with the way in which a surveyor carries the phone, the gravest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CarryFault {
    /// It is in a pocket, at the ear, or in a hand that swings.
    NotHeld,
    /// It is held, but the screen does not face up.
    NotUpward,
    /// The screen faces up, but the top edge surely points to a side or back.
    NotForward,
    /// The top edge points ahead, but the phone is inclined.
    NotLevel,
}

impl CarryFault {
    /// Every fault, the gravest first.
    pub const ALL: [Self; 4] = [Self::NotHeld, Self::NotUpward, Self::NotForward, Self::NotLevel];

    /// What is wrong with a phone that is held like that; nothing when it is right or too little was heard.
    ///
    /// # Source
    /// Mass-centred 2019, Table 1: a survey is walked in the attitude UFH, the only one that its Eq. 11 compares with.
    pub fn of(estimate: &AttitudeEstimate) -> Option<Self> {
        let is_held = match estimate.carry_mode {
            CarryMode::Swinging | CarryMode::FrontPocket | CarryMode::BackPocket | CarryMode::Calling => {
                false
            }
            CarryMode::Unknown | CarryMode::HeldUp | CarryMode::HeldUpright | CarryMode::OnTable => true,
        };
        match estimate.attitude {
            Attitude::Unknown | Attitude::UpwardForwardHorizontal => None,
            Attitude::UpwardForwardInclined => Some(Self::NotLevel),
            Attitude::UpwardNotForward => (estimate.p_forward < P_FORWARD).then_some(Self::NotForward),
            Attitude::NotUpward if is_held => Some(Self::NotUpward),
            Attitude::NotUpward => Some(Self::NotHeld),
        }
    }

    /// What is wrong with most of the last steps, so that a glance at the screen or a stumble says nothing, and who takes
    /// the phone out of the pocket still reads why; nothing when they are right or too few.
    pub(super) fn of_last(steps: &[StepEvent]) -> Option<Self> {
        let last = &steps[steps.len().saturating_sub(N_LAST)..];
        let faults = || last.iter().filter_map(|step| Self::of(&step.attitude));
        if faults().count() < N_FAULTY {
            return None;
        }
        // Of equal numbers the gravest: `max_by_key` gives the last.
        let n_of = |fault: &Self| faults().filter(|other| other == fault).count();
        Self::ALL.into_iter().rev().max_by_key(n_of)
    }
}

/// The strides of some who hold the phone ahead make that less likely than not: a warning waits until it is as unlikely as
/// this. With one half it is wrong in 3 of 30 simulated survey walks and in 33 of 80 traces of a real floor, with this in none
/// and in 5; a phone held across is told in 26 of 30 either way, one held half to the left in none.
const P_FORWARD: f32 = 0.02;
/// Steps that the warning rests on: a change of grip is told within five and forgiven within four, two or three seconds.
const N_LAST: usize = 8;
/// As many of them must be faulty.
const N_FAULTY: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::StepCycle;
    use crate::time::Timestamp;

    fn step(attitude: Attitude, carry_mode: CarryMode) -> StepEvent {
        let time = Timestamp::from_millis(0);
        StepEvent {
            cycle: StepCycle {
                start: time,
                end: time,
                frequency_hz: 2.0,
                amplitude_m_s2: 3.0,
                is_first: false,
            },
            n_steps: 1,
            level_heading_rad: 0.0,
            forward_field: None,
            end_strength_ut: None,
            reads: [None; 3],
            attitude: AttitudeEstimate { attitude, carry_mode, ..AttitudeEstimate::default() },
            field_bias_reset: false,
        }
    }

    #[test]
    fn each_grip_has_its_fault_and_the_survey_s_none() {
        use Attitude::{
            NotUpward, Unknown, UpwardForwardHorizontal, UpwardForwardInclined, UpwardNotForward,
        };
        let of = |attitude, carry_mode| CarryFault::of(&step(attitude, carry_mode).attitude);
        assert_eq!(of(Unknown, CarryMode::Unknown), None);
        assert_eq!(of(UpwardForwardHorizontal, CarryMode::HeldUp), None);
        assert_eq!(of(UpwardForwardInclined, CarryMode::HeldUp), Some(CarryFault::NotLevel));
        assert_eq!(of(UpwardNotForward, CarryMode::HeldUp), Some(CarryFault::NotForward));
        let doubtful =
            AttitudeEstimate { p_forward: 0.1, ..step(UpwardNotForward, CarryMode::HeldUp).attitude };
        assert_eq!(CarryFault::of(&doubtful), None);
        assert_eq!(of(NotUpward, CarryMode::HeldUpright), Some(CarryFault::NotUpward));
        assert_eq!(of(NotUpward, CarryMode::Unknown), Some(CarryFault::NotUpward));
        for mode in [CarryMode::Swinging, CarryMode::FrontPocket, CarryMode::BackPocket, CarryMode::Calling] {
            assert_eq!(of(NotUpward, mode), Some(CarryFault::NotHeld));
        }
    }

    #[test]
    fn most_of_the_last_steps_decide() {
        let good = step(Attitude::UpwardForwardHorizontal, CarryMode::HeldUp);
        let pocketed = step(Attitude::NotUpward, CarryMode::FrontPocket);
        let inclined = step(Attitude::UpwardForwardInclined, CarryMode::HeldUp);
        assert_eq!(CarryFault::of_last(&[]), None);
        assert_eq!(CarryFault::of_last(&[pocketed; 4]), None, "too few");
        let mut steps = vec![pocketed; 5];
        assert_eq!(CarryFault::of_last(&steps), Some(CarryFault::NotHeld));
        steps.extend([good; 3]);
        assert_eq!(
            CarryFault::of_last(&steps),
            Some(CarryFault::NotHeld),
            "it is read after it is taken out"
        );
        steps.push(good);
        assert_eq!(CarryFault::of_last(&steps), None);
        steps.extend([inclined, inclined, pocketed, inclined]);
        assert_eq!(CarryFault::of_last(&steps), None, "a glance at it");
        steps.push(pocketed);
        assert_eq!(CarryFault::of_last(&steps), Some(CarryFault::NotLevel), "what most have");
        steps.push(pocketed);
        assert_eq!(CarryFault::of_last(&steps), Some(CarryFault::NotHeld), "of as many the graver");
    }
}
