//! A walk as it is meant: who, along which line, with which phone.

use fieldwalk::geometry::Point2;
use fieldwalk::survey::Waypoint;
use fieldwalk::time::Duration;

use crate::card::CardModel;
use crate::noise::Noise;
use crate::phone::{CarryMode, PhoneModel};
use crate::radio::RadioModel;
use crate::scenario::ORIGIN;
use crate::walker::{Gait, Pace, Pause, WalkerProfile};

/// Marks on long stretches are at most this far apart, in metres.
const MARK_SPACING_M: f64 = 10.0;
/// Standard deviation of the moment at which a surveyor taps, in seconds.
const TAP_SD_S: f64 = 0.15;

/// A walk to simulate.
#[derive(Clone, Debug, PartialEq)]
pub struct Walk {
    /// The name of its recording.
    pub name: String,
    /// The line that the walker means to follow.
    pub path: Vec<Point2>,
    /// Height of the floor over the ground floor at each point of `path`, in metres; where there are fewer, the last
    /// holds on; none for the ground floor. A stretch whose ends differ is a flight of stairs.
    pub heights_m: Vec<f64>,
    /// Stops on the way.
    pub pauses: Vec<Pause>,
    /// Changes of speed on the way, in order of their places.
    pub paces: Vec<Pace>,
    /// Who walks.
    pub walker: WalkerProfile,
    /// From which second on the phone is carried how.
    pub carrying: Vec<(f64, CarryMode)>,
    /// The make of the phone.
    pub phone: PhoneModel,
    /// Its radio; silent where there is a card.
    pub radio: RadioModel,
    /// A card at the chest, heard by the scenario's beacons as access points; one that sends frames is carried instead of
    /// the phone.
    pub card: Option<CardModel>,
    /// Which copy of that make: its biases and iron.
    pub device: u64,
    /// What is by chance in this walk.
    pub seed: u64,
}

impl Walk {
    /// A walk of a middling walker along `path`, a middling phone held level.
    pub fn along(name: impl Into<String>, path: Vec<Point2>, seed: u64) -> Self {
        Self {
            name: name.into(),
            path,
            heights_m: Vec::new(),
            pauses: Vec::new(),
            paces: Vec::new(),
            walker: WalkerProfile::default(),
            carrying: vec![(0.0, CarryMode::HeldLevel)],
            phone: PhoneModel::default(),
            radio: RadioModel::default(),
            card: None,
            device: seed,
            seed,
        }
    }

    /// What the walker taps: the marks at the path's corners and, on long stretches, between them, each at about the
    /// moment of passing it. The walker cuts corners and strays; the marks do not.
    pub(super) fn waypoints(&self, gait: &Gait, standing_s: f64, tap_sd_m: f64) -> Vec<Waypoint> {
        let mut noise = Noise::new(self.seed, "taps", 0);
        let mut misses = Noise::new(self.seed, "taps", 1);
        let mut waypoints: Vec<Waypoint> = Vec::new();
        let mut tap = |time_s: f64, point: Point2| {
            let time = ORIGIN + Duration::from_secs_f64(time_s);
            let point = point + Point2::new(misses.normal(tap_sd_m), misses.normal(tap_sd_m));
            if waypoints.last().is_none_or(|last| last.time < time) {
                waypoints.push(Waypoint { time, point });
            }
        };
        let Some(first) = self.path.first() else { return waypoints };
        tap(0.5 * standing_s, *first);
        let mut at_m = 0.0;
        let n_stretches = self.path.len() - 1;
        for (k, pair) in self.path.windows(2).enumerate() {
            let length_m = pair[0].distance_m(pair[1]);
            let n = (length_m / MARK_SPACING_M).ceil().max(1.0) as usize;
            for i in 1..=n {
                let share = i as f64 / n as f64;
                let is_end = k + 1 == n_stretches && i == n;
                let time_s = if is_end {
                    gait.duration_s() - 0.5 * standing_s
                } else {
                    gait.time_at_s(at_m + share * length_m) + noise.normal(TAP_SD_S)
                };
                tap(time_s, pair[0].lerp(pair[1], share));
            }
            at_m += length_m;
        }
        waypoints
    }
}
