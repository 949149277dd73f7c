//! The plan of a walk: step by step, how long and how far.

use crate::building::GOING_M;
use crate::noise::{Noise, SmoothNoise};
use crate::walker::{Course, Flight, WalkerProfile};

/// A walker turns no faster than this, in rad/s: before a sharp corner the pace slackens.
///
/// # Source
/// Ours: healthy adults turn at peak rates of about 2 to 3.5 rad/s.
const MAX_TURNING_RAD_S: f64 = 2.6;
/// Nobody walks slower than this through a corner, in m/s.
const MIN_SPEED_M_S: f64 = 0.45;
/// The first step takes longer than the others by this factor: the body starts from rest.
const FIRST_STEP_TIME: f64 = 1.2;

/// Steps a second up and down stairs of 30° at a usual pace.
///
/// # Source
/// Riener, Rabuffetti and Frigo 2002, *Stair ascent and descent at different inclinations*: strides of 1.41 and 1.20 s.
const UPSTAIRS_HZ: f64 = 1.42;
const DOWNSTAIRS_HZ: f64 = 1.67;
/// The step frequency on the level that goes with those, in Hz.
const USUAL_HZ: f64 = 1.77;

/// A stop on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pause {
    /// How far along the path, in metres.
    pub at_m: f64,
    /// How long, in seconds.
    pub duration_s: f64,
}

/// A change of speed on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// From how far along the path it holds, in metres.
    pub from_m: f64,
    /// What the walker's own speed is multiplied by; 1 before the first change.
    pub factor: f64,
}

/// A step as it was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// When the other foot left the ground, in seconds from the start of the recording.
    pub start_s: f64,
    /// When this foot met it.
    pub end_s: f64,
    /// How far along the path the step began, in metres.
    pub from_m: f64,
    /// Its length along the path, in metres.
    pub length_m: f64,
    /// Whether it was a step of the right foot.
    pub is_right: bool,
}

/// Steps without a stop.
pub(super) type Bout = Vec<Step>;

/// Plans the steps along `course`, with a stop at each of `pauses`, at the speeds of `paces`, in order of their places;
/// the first begins at `start_s`.
pub(super) fn plan(
    walker: &WalkerProfile,
    course: &Course,
    pauses: &[Pause],
    paces: &[Pace],
    start_s: f64,
    seed: u64,
) -> Vec<Bout> {
    let mut noise = Noise::new(seed, "steps", 0);
    // The pace wavers by 3 % over ten to forty seconds.
    let waver = SmoothNoise::new(&mut noise, 0.03, [0.025, 0.1]);
    let flights: Vec<Flight> = course.flights().collect();
    let (mut time_s, mut at_m, mut is_right) = (start_s, 0.0, noise.chance(0.5));
    let mut bouts = Vec::new();
    let mut bout = Bout::new();
    for mark in marks(course, &flights, pauses) {
        let mut last_length_m = None;
        while mark.at_m - at_m > 1e-3 && bout.len() < 100_000 {
            let flight =
                flights.iter().find(|flight| flight.from_m - 1e-3 <= at_m && at_m < flight.to_m - 1e-3);
            let speed_m_s = speed_m_s(walker, course, at_m, factor(paces, at_m) * (1.0 + waver.at(time_s)));
            let (mut usual_m, mut usual_hz) =
                (walker.step_length_m(speed_m_s), walker.step_frequency_hz(speed_m_s));
            let mut length_sd = walker.length_sd;
            if let Some(flight) = flight {
                usual_hz *= if flight.rise_m > 0.0 { UPSTAIRS_HZ } else { DOWNSTAIRS_HZ } / USUAL_HZ;
                // Feet go from tread to tread.
                let n = ((flight.to_m - flight.from_m) / GOING_M).round().max(1.0);
                (usual_m, length_sd) = ((flight.to_m - flight.from_m) / n, 0.0);
            }
            let usual_m = usual_m * (1.0 + noise.normal(length_sd));
            let side = if is_right { walker.asymmetry } else { -walker.asymmetry };
            let usual_s = (1.0 + side + noise.normal(walker.time_sd)) / usual_hz;
            let left_m = mark.at_m - at_m;
            let length_m = match last_length_m.take() {
                Some(last_m) => left_m.min(last_m),
                None if flight.is_some() => usual_m.min(left_m),
                None if bout.is_empty() => (0.5 * usual_m).min(left_m),
                None if left_m <= 0.65 * usual_m => left_m,
                None if left_m <= 1.3 * usual_m => {
                    last_length_m = Some(0.45 * left_m + 1e-6);
                    0.55 * left_m
                }
                None => usual_m,
            };
            let duration_s = usual_s * if bout.is_empty() { FIRST_STEP_TIME } else { 1.0 };
            bout.push(Step { start_s: time_s, end_s: time_s + duration_s, from_m: at_m, length_m, is_right });
            time_s += duration_s;
            at_m += length_m;
            is_right = !is_right;
        }
        if let Some(duration_s) = mark.stop_s {
            time_s += duration_s;
            bouts.push(std::mem::take(&mut bout));
        }
    }
    bouts
}

/// A place where a foot comes down: before and after stairs, and where the walker stops for so many seconds.
struct Mark {
    at_m: f64,
    stop_s: Option<f64>,
}

fn marks(course: &Course, flights: &[Flight], pauses: &[Pause]) -> Vec<Mark> {
    let mut marks = vec![Mark { at_m: course.length_m(), stop_s: Some(0.0) }];
    for flight in flights {
        marks.extend([flight.from_m, flight.to_m].map(|at_m| Mark { at_m, stop_s: None }));
    }
    let is_on_stairs =
        |at_m: f64| flights.iter().any(|flight| flight.from_m - 1.0 < at_m && at_m < flight.to_m + 1.0);
    let is_within = |at_m: f64| at_m > 1.0 && at_m < course.length_m() - 1.0;
    let stops = pauses.iter().filter(|pause| is_within(pause.at_m) && !is_on_stairs(pause.at_m));
    marks.extend(stops.map(|pause| Mark { at_m: pause.at_m, stop_s: Some(pause.duration_s) }));
    marks.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
    marks
}

/// The factor on the walker's speed that holds at `at_m`.
fn factor(paces: &[Pace], at_m: f64) -> f64 {
    paces.iter().take_while(|pace| pace.from_m <= at_m).last().map_or(1.0, |pace| pace.factor)
}

/// The pace at `at_m`, slackened for the corner that the next step meets.
fn speed_m_s(walker: &WalkerProfile, course: &Course, at_m: f64, factor: f64) -> f64 {
    let free_m_s = walker.speed_m_s * factor;
    let sharpest_rad_m = course.sharpest_rad_m(at_m - 0.2, at_m + walker.step_length_m(free_m_s));
    let limit_m_s = MAX_TURNING_RAD_S / sharpest_rad_m.max(1e-9);
    free_m_s.min(limit_m_s.max(MIN_SPEED_M_S.min(free_m_s)))
}
