//! The methods: fitted to some captures, scored on others.

use fieldwalk::geometry::Point2;
use fieldwalk::map::Fingerprints;
use fieldwalk::radio::RadioObservation;
use fieldwalk::radio::fingerprint::{FingerprintMatcher, FingerprintParams};
use fieldwalk::radio::path_loss::PathLoss;
use fieldwalk::radio::range::Range;
use fieldwalk::radio::trilateration::{
    GradientDescentParams, TrilaterationParams, gradient_descent, random_start, trilaterate,
};
use fieldwalk_formats::ble_annotated::Area;

use super::rounds::{Capture, Round};
use super::{Metric, NEAR_M};

/// Kwak's `R_BLE`: a particle farther from the matched cell twice in a row is dropped, in metres.
pub const FILTER_M: f64 = 6.0;
/// Side of a fingerprint's cell, in metres: small enough for each fixed point to have its own.
const CELL_M: f64 = 0.5;
/// Seed of the printed algorithm's random starts.
const SEED: u64 = 1;
/// Receivers that must be near.
const N_NEAR: usize = 3;

/// The windows over which power is averaged, in rounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// One second.
    One,
    /// Five seconds.
    Five,
}

/// What is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    /// Ranges as the path loss gives them.
    RawRange(Window),
    /// The same, unbiased.
    UnbiasedRange(Window),
    /// Gradient descent as printed, on unbiased ranges.
    Printed(Window),
    /// The robust trilateration.
    Robust(Window),
    /// The nearest fingerprint.
    Radar,
    /// The card's filter by the matched cell.
    BleFilter,
}

/// One scored round of one system; of ranges, one receiver's.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// The system.
    pub system: System,
    /// Distance of the place from the truth, or range minus distance, in metres; nothing without a place.
    pub error_m: Option<f64>,
    /// Whether three receivers hang near the truth.
    pub is_near: bool,
    /// Whether the trilateration calls its geometry good.
    pub is_reliable: bool,
    /// Whether the filter would drop a particle at the truth.
    pub is_dropped: bool,
}

impl Window {
    const ALL: [Self; 2] = [Self::One, Self::Five];

    fn n_rounds(self) -> usize {
        match self {
            Self::One => 1,
            Self::Five => 5,
        }
    }
}

impl System {
    /// Every system, in the order of the rows.
    pub const ALL: [Self; 10] = [
        Self::RawRange(Window::One),
        Self::UnbiasedRange(Window::One),
        Self::RawRange(Window::Five),
        Self::UnbiasedRange(Window::Five),
        Self::Printed(Window::One),
        Self::Robust(Window::One),
        Self::Printed(Window::Five),
        Self::Robust(Window::Five),
        Self::Radar,
        Self::BleFilter,
    ];

    /// The name in rows.
    pub fn name(self) -> &'static str {
        use Window::{Five, One};
        match self {
            Self::RawRange(One) => "raw_range_1s",
            Self::RawRange(Five) => "raw_range_5s",
            Self::UnbiasedRange(One) => "unbiased_range_1s",
            Self::UnbiasedRange(Five) => "unbiased_range_5s",
            Self::Printed(One) => "trilateration_printed_1s",
            Self::Printed(Five) => "trilateration_printed_5s",
            Self::Robust(One) => "trilateration_1s",
            Self::Robust(Five) => "trilateration_5s",
            Self::Radar => "radar",
            Self::BleFilter => "ble_filter",
        }
    }

    /// What is told of it.
    pub fn metrics(self) -> &'static [Metric] {
        match self {
            Self::RawRange(_) | Self::UnbiasedRange(_) => &[Metric::RangeBiasM, Metric::RangeErrorMedianM],
            Self::Printed(_) | Self::Radar => {
                &[Metric::PlaceErrorMedianM, Metric::PlaceErrorP80M, Metric::PlacedPercent]
            }
            Self::Robust(_) => &[
                Metric::PlaceErrorMedianM,
                Metric::PlaceErrorP80M,
                Metric::PlacedPercent,
                Metric::ReliablePercent,
            ],
            Self::BleFilter => &[Metric::TruthNearMatchPercent, Metric::TruthDroppedPercent],
        }
    }
}

/// What was fitted.
pub struct Fitted {
    /// The path loss of each receiver, for each of [`Window::ALL`].
    path_loss: Vec<Vec<PathLoss>>,
    fingerprints: Fingerprints,
}

impl Fitted {
    /// Fits to `captures`; why not where they are too few.
    pub fn of(area: &Area, captures: &[&Capture]) -> Result<Self, String> {
        let mut path_loss = Vec::new();
        for window in Window::ALL {
            let mut sightings = vec![Vec::new(); area.receivers.len()];
            for (truth, powers_dbm) in captures.iter().flat_map(|capture| capture.windows(window.n_rounds()))
            {
                for ((receiver, power_dbm), sightings) in
                    area.receivers.iter().zip(powers_dbm).zip(&mut sightings)
                {
                    sightings.extend(power_dbm.map(|dbm| (receiver.position.distance_m(truth), dbm)));
                }
            }
            let fits = area.receivers.iter().zip(&sightings).map(|(receiver, sightings)| {
                PathLoss::fit(sightings).map_err(|error| format!("{}: {error}", receiver.alias))
            });
            path_loss.push(fits.collect::<Result<Vec<_>, _>>()?);
        }
        let rounds = captures.iter().flat_map(|capture| &capture.rounds);
        let sightings = rounds.filter_map(|round| Some((round, round.truth?))).flat_map(|(round, truth)| {
            let means = round.heard.iter().zip(0u32..);
            means.filter_map(move |(heard, receiver)| Some((truth, receiver, heard.mean_of_dbm()?)))
        });
        Ok(Self { path_loss, fingerprints: Fingerprints::of(CELL_M, area.receivers.len(), sightings) })
    }
}

/// Every system's outcomes on a capture.
pub fn score_capture(area: &Area, fitted: &Fitted, capture: &Capture) -> Vec<Outcome> {
    let mut outcomes = Vec::new();
    for (window, path_loss) in Window::ALL.into_iter().zip(&fitted.path_loss) {
        for ((truth, powers_dbm), round) in capture.windows(window.n_rounds()).zip(0..) {
            score_window(area, path_loss, window, truth, &powers_dbm, round, &mut outcomes);
        }
    }
    score_rounds(area, &fitted.fingerprints, &capture.rounds, &mut outcomes);
    outcomes
}

/// Ranges and places from one window's powers.
fn score_window(
    area: &Area,
    path_loss: &[PathLoss],
    window: Window,
    truth: Point2,
    powers_dbm: &[Option<f64>],
    round: u64,
    outcomes: &mut Vec<Outcome>,
) {
    let is_near = is_near(area, truth);
    let outcome =
        |system, error_m| Outcome { system, error_m, is_near, is_reliable: false, is_dropped: false };
    let mut ranges = Vec::new();
    for ((receiver, path_loss), power_dbm) in area.receivers.iter().zip(path_loss).zip(powers_dbm) {
        let range = power_dbm.and_then(|power_dbm| Range::new(receiver.position, path_loss, power_dbm));
        if let Some(range) = range {
            let distance_m = receiver.position.distance_m(truth);
            outcomes.push(outcome(System::RawRange(window), Some(range.raw_m - distance_m)));
            outcomes.push(outcome(System::UnbiasedRange(window), Some(range.unbiased_m - distance_m)));
            ranges.push(range);
        }
    }
    let start = random_start(&ranges, SEED, round).unwrap_or_default();
    let printed = gradient_descent(&GradientDescentParams::default(), &ranges, start).ok();
    outcomes.push(outcome(System::Printed(window), printed.map(|place| place.distance_m(truth))));
    let robust = trilaterate(&TrilaterationParams::default(), &ranges);
    let place = match &robust {
        Ok(place) => Some(place),
        Err(error) => error.place(),
    };
    let error_m = place.map(|place| place.point.distance_m(truth));
    outcomes.push(Outcome { is_reliable: robust.is_ok(), ..outcome(System::Robust(window), error_m) });
}

/// Fingerprints matched round by round.
fn score_rounds(area: &Area, fingerprints: &Fingerprints, rounds: &[Round], outcomes: &mut Vec<Outcome>) {
    let mut matcher = FingerprintMatcher::new(fingerprints);
    let mut was_outside = false;
    for round in rounds {
        let Some(truth) = round.truth else { continue };
        let heard: Vec<RadioObservation> = round
            .heard
            .iter()
            .zip(0u32..)
            .filter_map(|(heard, transmitter)| {
                Some(RadioObservation { transmitter, rssi_dbm: heard.mean_of_dbm()? as f32 })
            })
            .collect();
        let found = matcher.nearest(&FingerprintParams::default(), fingerprints, &heard);
        let error_m = found.map(|found| found.place.distance_m(truth));
        let is_outside = error_m.is_some_and(|m| m > FILTER_M);
        let outcome = Outcome {
            system: System::Radar,
            error_m,
            is_near: is_near(area, truth),
            is_reliable: false,
            is_dropped: is_outside && was_outside,
        };
        outcomes.extend([outcome, Outcome { system: System::BleFilter, ..outcome }]);
        was_outside = is_outside;
    }
}

/// Whether three receivers hang near a place.
fn is_near(area: &Area, place: Point2) -> bool {
    let near = area.receivers.iter().filter(|receiver| receiver.position.distance_m(place) <= NEAR_M);
    near.count() >= N_NEAR
}
