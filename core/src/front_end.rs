//! Which way a wearer's samples become steps: by what is worn.

mod standing;
mod waist;

use serde::{Deserialize, Serialize};

pub use standing::StandingPhone;
pub use waist::WaistFrontEnd;

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
    /// A phone that also tells of every second in which its wearer stands: [`StandingPhone`].
    StandingPhone,
    /// A wearable at the waist, whose field says nothing but the heading: [`WaistFrontEnd`].
    Waist,
}

/// Samples in, steps out, as the recipe's [`FrontEndRule`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FrontEnd {
    /// Of [`FrontEndRule::Phone`].
    Phone(Box<Pedestrian>),
    /// Of [`FrontEndRule::Card`].
    Card(Box<CardFrontEnd>),
    /// Of [`FrontEndRule::StandingPhone`].
    StandingPhone(Box<StandingPhone>),
    /// Of [`FrontEndRule::Waist`].
    Waist(Box<WaistFrontEnd>),
}

impl FrontEnd {
    /// A front end that has seen nothing.
    pub fn new(rule: FrontEndRule) -> Self {
        match rule {
            FrontEndRule::Phone => Self::Phone(Box::new(Pedestrian::new(PedestrianParams::default()))),
            FrontEndRule::Card => Self::Card(Box::default()),
            FrontEndRule::StandingPhone => {
                Self::StandingPhone(Box::new(StandingPhone::new(PedestrianParams::default())))
            }
            FrontEndRule::Waist => Self::Waist(Box::default()),
        }
    }

    /// The rule that it follows.
    pub fn rule(&self) -> FrontEndRule {
        match self {
            Self::Phone(_) => FrontEndRule::Phone,
            Self::Card(_) => FrontEndRule::Card,
            Self::StandingPhone(_) => FrontEndRule::StandingPhone,
            Self::Waist(_) => FrontEndRule::Waist,
        }
    }

    /// Consumes a sample (in order of time); returns the next step that counts, if any: [`Self::pop`] gives the rest.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        match self {
            Self::Phone(pedestrian) => pedestrian.push(sample),
            Self::Card(card) => card.push(sample),
            Self::StandingPhone(phone) => phone.push(sample),
            Self::Waist(waist) => waist.push(sample),
        }
    }

    /// The next step that the last sample completed beside the one that it returned.
    pub fn pop(&mut self) -> Option<StepEvent> {
        match self {
            Self::Phone(_) | Self::StandingPhone(_) | Self::Waist(_) => None,
            Self::Card(card) => card.pop(),
        }
    }

    /// What became of a card's frames; nothing where none are read.
    pub fn card_counts(&self) -> Option<CardCounts> {
        match self {
            Self::Phone(_) | Self::StandingPhone(_) | Self::Waist(_) => None,
            Self::Card(card) => Some(card.counts()),
        }
    }

    /// Heading of the device's forward axis now, in the frame of [`StepEvent::level_heading_rad`].
    pub fn level_heading_rad(&self) -> f32 {
        match self {
            Self::Phone(pedestrian) => pedestrian.level_heading_rad(),
            Self::Card(card) => card.heading_rad(),
            Self::StandingPhone(phone) => phone.pedestrian().level_heading_rad(),
            Self::Waist(waist) => waist.heading_rad(),
        }
    }

    /// How the device is held now; unknown of what is not held.
    pub fn attitude(&self) -> AttitudeEstimate {
        match self {
            Self::Phone(pedestrian) => pedestrian.attitude(),
            Self::StandingPhone(phone) => phone.pedestrian().attitude(),
            Self::Card(_) | Self::Waist(_) => AttitudeEstimate::default(),
        }
    }
}
