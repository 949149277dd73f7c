//! A phone that is not carried as a survey needs it, and what to do about that.

use fieldwalk::survey;

/// The phone is not carried as a survey needs it: level before the chest, the screen up, the top edge ahead. The map is worth
/// less then.
#[derive(Clone, Debug, PartialEq, Eq, uniffi::Record)]
pub struct CarryWarning {
    /// What is wrong.
    pub what: CarryFault,
    /// What that means, in English.
    pub explanation: String,
    /// What to do about it, in English.
    pub remedy: String,
}

/// What may be wrong with the way in which a phone is carried; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
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
    /// Something that this boundary has no name for yet.
    Other,
}

impl CarryWarning {
    /// `fault` with its texts.
    pub(crate) fn of(fault: survey::CarryFault) -> Self {
        let what = CarryFault::from(fault);
        let (explanation, remedy) = match what {
            CarryFault::NotHeld => (
                "the phone is in a pocket, at the ear or in a hand that swings",
                "hold it still before the chest, level, the screen up and the top edge ahead",
            ),
            CarryFault::NotUpward => {
                ("the screen does not face up", "hold the phone level, the screen up and the top edge ahead")
            }
            CarryFault::NotForward => (
                "the top edge does not point ahead",
                "turn the phone so that its top edge points where you go",
            ),
            CarryFault::NotLevel => {
                ("the phone is inclined", "hold it level, as if to read from it on a table")
            }
            CarryFault::Other => (
                "the phone is not carried as a survey needs it",
                "hold it level, the screen up and the top edge ahead",
            ),
        };
        Self { what, explanation: explanation.into(), remedy: remedy.into() }
    }
}

impl From<survey::CarryFault> for CarryFault {
    fn from(fault: survey::CarryFault) -> Self {
        match fault {
            survey::CarryFault::NotHeld => Self::NotHeld,
            survey::CarryFault::NotUpward => Self::NotUpward,
            survey::CarryFault::NotForward => Self::NotForward,
            survey::CarryFault::NotLevel => Self::NotLevel,
            _ => Self::Other,
        }
    }
}
