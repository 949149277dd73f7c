//! Which way a wearer's samples become steps: by what is worn.

use serde::{Deserialize, Serialize};

use crate::attitude::AttitudeEstimate;
use crate::card::{CardCounts, CardFrontEnd};
use crate::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use crate::sensor::Sample;

/// What is worn, and how its samples are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrontEndRule {
    /// A phone, carried in any way: [`Pedestrian`] with its defaults.
    #[default]
    Phone,
    /// An ID card, by its frames; a phone's samples are read as a card would read its sensors: [`CardFrontEnd`].
    Card,
}

/// Samples in, steps out, as the recipe's [`FrontEndRule`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FrontEnd {
    /// Of [`FrontEndRule::Phone`].
    Phone(Box<Pedestrian>),
    /// Of [`FrontEndRule::Card`].
    Card(Box<CardFrontEnd>),
}

impl FrontEnd {
    /// A front end that has seen nothing.
    pub fn new(rule: FrontEndRule) -> Self {
        match rule {
            FrontEndRule::Phone => Self::Phone(Box::new(Pedestrian::new(PedestrianParams::default()))),
            FrontEndRule::Card => Self::Card(Box::default()),
        }
    }

    /// The rule that it follows.
    pub fn rule(&self) -> FrontEndRule {
        match self {
            Self::Phone(_) => FrontEndRule::Phone,
            Self::Card(_) => FrontEndRule::Card,
        }
    }

    /// Consumes a sample (in order of time); returns the next step that counts, if any: [`Self::pop`] gives the rest.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        match self {
            Self::Phone(pedestrian) => pedestrian.push(sample),
            Self::Card(card) => card.push(sample),
        }
    }

    /// The next step that the last sample completed beside the one that it returned.
    pub fn pop(&mut self) -> Option<StepEvent> {
        match self {
            Self::Phone(_) => None,
            Self::Card(card) => card.pop(),
        }
    }

    /// What became of a card's frames; nothing where none are read.
    pub fn card_counts(&self) -> Option<CardCounts> {
        match self {
            Self::Phone(_) => None,
            Self::Card(card) => Some(card.counts()),
        }
    }

    /// Heading of the device's forward axis now, in the frame of [`StepEvent::level_heading_rad`].
    pub fn level_heading_rad(&self) -> f32 {
        match self {
            Self::Phone(pedestrian) => pedestrian.level_heading_rad(),
            Self::Card(card) => card.heading_rad(),
        }
    }

    /// How the device is held now; unknown of what is not held.
    pub fn attitude(&self) -> AttitudeEstimate {
        match self {
            Self::Phone(pedestrian) => pedestrian.attitude(),
            Self::Card(_) => AttitudeEstimate::default(),
        }
    }
}
