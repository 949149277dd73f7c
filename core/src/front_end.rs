//! Which way a wearer's samples become steps: by what is worn.

use serde::{Deserialize, Serialize};

use crate::attitude::AttitudeEstimate;
use crate::pedestrian::{Pedestrian, PedestrianParams, StepEvent};
use crate::sensor::Sample;

/// What is worn, and how its samples are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FrontEndRule {
    /// A phone, carried in any way: [`Pedestrian`] with its defaults.
    #[default]
    Phone,
}

/// Samples in, steps out, as the recipe's [`FrontEndRule`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FrontEnd {
    /// Of [`FrontEndRule::Phone`].
    Phone(Box<Pedestrian>),
}

impl FrontEnd {
    /// A front end that has seen nothing.
    pub fn new(rule: FrontEndRule) -> Self {
        match rule {
            FrontEndRule::Phone => Self::Phone(Box::new(Pedestrian::new(PedestrianParams::default()))),
        }
    }

    /// The rule that it follows.
    pub fn rule(&self) -> FrontEndRule {
        match self {
            Self::Phone(_) => FrontEndRule::Phone,
        }
    }

    /// Consumes a sample (in order of time); returns the next step that counts, if any.
    pub fn push(&mut self, sample: &Sample) -> Option<StepEvent> {
        match self {
            Self::Phone(pedestrian) => pedestrian.push(sample),
        }
    }

    /// Heading of the device's forward axis now, in the frame of [`StepEvent::level_heading_rad`].
    pub fn level_heading_rad(&self) -> f32 {
        match self {
            Self::Phone(pedestrian) => pedestrian.level_heading_rad(),
        }
    }

    /// How the device is held now; unknown of what is not held.
    pub fn attitude(&self) -> AttitudeEstimate {
        match self {
            Self::Phone(pedestrian) => pedestrian.attitude(),
        }
    }
}
