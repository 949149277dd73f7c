//! The ID card: what it makes of its sensors, and what a receiver makes of its frames.
//!
//! A card reads the magnetometer three times and the accelerometer fifteen times a second and broadcasts one frame a
//! second ([`CardRoundBuilder`]). A receiver puts the frames in order and turns each into a round's [`StepEvent`]
//! ([`CardReceiver`]). [`CardFrontEnd`] does the one or both: on frames it receives, on a phone's samples it is the card
//! too, so that the card's system runs on any recording.

mod builder;
mod emulator;
mod receiver;

pub use builder::{CardRoundBuilder, CardSensingParams};
pub use emulator::CardEmulator;
pub use receiver::{CardCounts, CardReceiver};

use serde::{Deserialize, Serialize};

use crate::pedestrian::StepEvent;
use crate::sensor::{Reading, Sample};

/// Frames of a card, or a phone's samples read as a card would, to rounds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CardFrontEnd {
    emulator: CardEmulator,
    receiver: CardReceiver,
    /// Once a frame was heard, what the phone's own sensors say is no card's.
    hears_frames: bool,
}

impl CardFrontEnd {
    /// Consumes a sample (in order of time); returns the first round that it completes, if any: [`Self::pop`] gives the
    /// rest.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        match &sample.reading {
            Reading::CardFrame(frame) => {
                self.hears_frames = true;
                self.receiver.push(sample.time, frame);
            }
            _ if self.hears_frames => {}
            _ => {
                if let Some(frame) = self.emulator.push(sample) {
                    self.receiver.push(sample.time, &frame);
                }
            }
        }
        self.pop()
    }

    /// The next round that is complete.
    pub fn pop(&mut self) -> Option<StepEvent> {
        self.receiver.pop()
    }

    /// The latest orientation, clockwise from magnetic north, in radians.
    pub fn heading_rad(&self) -> f32 {
        self.receiver.heading_rad()
    }

    /// What became of the frames so far.
    pub fn counts(&self) -> CardCounts {
        self.receiver.counts()
    }
}
