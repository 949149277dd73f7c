//! The attitude's detector on simulated walkers: trained on a hundred of them, tested on others.

use fieldwalk::attitude::{AttitudeEstimate, AttitudeParams, EventCounts, EventTable};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk_sim::phone::{CarryMode, PhoneModel, SensorModel};
use fieldwalk_sim::scenario::{Scenario, Walk};
use fieldwalk_sim::walker::WalkerProfile;

use crate::plot::{Chart, Series};
use crate::reproduce::{Estimate, Finding, Findings, Picture, Run, test_bed};
use crate::walker_evaluation::auc;
use crate::walker_evaluation::tyrex::attitude::turn_left;
use crate::walker_evaluation::tyrex::training::StrideCounter;

/// Users who train, and steps of each.
///
/// # Source
/// Mass-centred 2019, Tables 2 and 3.
const N_TRAINED: u64 = 100;
const TRAINED_STEPS: f64 = 100.0;
/// Users who test, and steps of each in each scenario.
///
/// # Source
/// Mass-centred 2019 has 350 steps of each scenario; the number of users is ours.
const N_TESTED: u64 = 12;
const TESTED_STEPS: f64 = 350.0;
/// Testers are others than those who train.
const TESTERS_FROM: u64 = 1_000;

/// `k` of the paper, which leaves it open: a phone before the eyes, inclined by 63°, still faces up in its terms.
const UPWARD_G: f32 = 0.3;

/// How the phone is held in the five scenarios.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    /// Screen up, top edge ahead, about level.
    UpwardForwardHorizontal,
    /// Screen to the eyes, top edge ahead and up.
    UpwardForwardInclined,
    /// Screen up, top edge to the left, back and to the right, a third of the way each.
    UpwardNotForward,
    /// Screen down.
    Downward,
    /// In the swinging hand.
    Swinging,
}

impl Held {
    const ALL: [Self; 5] = [
        Self::UpwardForwardHorizontal,
        Self::UpwardForwardInclined,
        Self::UpwardNotForward,
        Self::Downward,
        Self::Swinging,
    ];

    fn is_upward(self) -> bool {
        !matches!(self, Self::Downward | Self::Swinging)
    }
}

/// A phone without magnetometer and barometer, which nothing here reads.
fn phone() -> PhoneModel {
    let without = |sensor: SensorModel| SensorModel { rate_hz: 0.0, ..sensor };
    let usual = PhoneModel::default();
    PhoneModel { magnetometer: without(usual.magnetometer), barometer: without(usual.barometer), ..usual }
}

/// What a phone carried as `mode` says over about `n_steps` steps of a walker by chance, corners included.
fn samples(office: &Scenario, mode: CarryMode, n_steps: f64, person: u64) -> Vec<Sample> {
    let walker = WalkerProfile::drawn(person);
    let path = office.building.ways.wander(person, n_steps * walker.step_length_m(walker.speed_m_s));
    let walk = Walk {
        walker,
        device: person,
        phone: phone(),
        carrying: vec![(0.0, mode)],
        ..Walk::along("attitude", path, person)
    };
    office.simulate(&walk).samples
}

/// The sample of a phone turned upside down about its long edge, otherwise moved alike.
fn turn_over(sample: &mut Sample) {
    if let Reading::SpecificForce(v) | Reading::AngularRate(v) = &mut sample.reading {
        *v = [-v[0], v[1], -v[2]];
    }
}

/// What the detector says at each step.
fn said(samples: &[Sample], params: AttitudeParams) -> Vec<AttitudeEstimate> {
    let mut pedestrian =
        Pedestrian::new(PedestrianParams { attitude: params, ..PedestrianParams::default() });
    samples.iter().filter_map(|sample| pedestrian.push(sample)).map(|event| event.attitude).collect()
}

/// What the detector says of one tester in each scenario.
fn test(office: &Scenario, table: EventTable, person: u64) -> [Vec<AttitudeEstimate>; 5] {
    let params = AttitudeParams { table, upward_g: UPWARD_G, ..AttitudeParams::printed() };
    let held = |mode, n_steps| samples(office, mode, n_steps, person);
    Held::ALL.map(|scenario| match scenario {
        Held::UpwardForwardHorizontal => said(&held(CarryMode::HeldLevel, TESTED_STEPS), params),
        Held::UpwardForwardInclined => said(&held(CarryMode::HeldUpright, TESTED_STEPS), params),
        Held::Swinging => said(&held(CarryMode::SwingingHand, TESTED_STEPS), params),
        Held::Downward => {
            let mut samples = held(CarryMode::HeldLevel, TESTED_STEPS);
            samples.iter_mut().for_each(turn_over);
            said(&samples, params)
        }
        Held::UpwardNotForward => {
            let mut samples = held(CarryMode::HeldLevel, TESTED_STEPS / 3.0);
            let mut all = Vec::new();
            for _ in 0..3 {
                samples.iter_mut().for_each(turn_left);
                all.extend(said(&samples, params));
            }
            all
        }
    })
}

/// One of the paper's classifiers: how sure it is, and what it should tell from the rest.
struct Classifier {
    id: &'static str,
    name: &'static str,
    score: fn(&AttitudeEstimate) -> f64,
    is_so: fn(Held) -> bool,
}

const CLASSIFIERS: [Classifier; 4] = [
    Classifier {
        id: "mc-auc-nu",
        name: "non-upward",
        score: |said| -f64::from(said.upward_g),
        is_so: |held| !held.is_upward(),
    },
    Classifier {
        id: "mc-auc-unf",
        name: "upward non-forward",
        score: |said| upward(said) * (1.0 - f64::from(said.p_forward)),
        is_so: |held| held == Held::UpwardNotForward,
    },
    Classifier {
        id: "mc-auc-ufnh",
        name: "upward forward non-horizontal",
        score: |said| upward(said) * f64::from(said.p_forward) * (1.0 - level(said)),
        is_so: |held| held == Held::UpwardForwardInclined,
    },
    Classifier {
        id: "mc-auc-ufh",
        name: "upward forward horizontal",
        score: |said| upward(said) * f64::from(said.p_forward) * level(said),
        is_so: |held| held == Held::UpwardForwardHorizontal,
    },
];

/// Soft thresholds at the detector's two tests of gravity.
fn upward(said: &AttitudeEstimate) -> f64 {
    soft(f64::from(said.upward_g - UPWARD_G))
}

fn level(said: &AttitudeEstimate) -> f64 {
    let share = f64::from(said.incline_rad) / std::f64::consts::FRAC_PI_2;
    soft(f64::from(AttitudeParams::default().level_share) - share)
}

fn soft(margin: f64) -> f64 {
    1.0 / (1.0 + (-margin / 0.1).exp())
}

impl Classifier {
    /// Scores of what is so and of what is not.
    fn scores(&self, testers: &[&[Vec<AttitudeEstimate>; 5]]) -> [Vec<f64>; 2] {
        let mut scores = [Vec::new(), Vec::new()];
        for tester in testers {
            for (held, said) in Held::ALL.into_iter().zip(tester.iter()) {
                let of = usize::from(!(self.is_so)(held));
                scores[of].extend(said.iter().map(self.score));
            }
        }
        scores
    }

    /// The receiver's curve: shares of false and of true alarms, in percent.
    fn curve(&self, testers: &[&[Vec<AttitudeEstimate>; 5]]) -> Vec<(f64, f64)> {
        let [so, not] = self.scores(testers).map(|mut scores| {
            scores.sort_by(f64::total_cmp);
            scores
        });
        let above = |sorted: &[f64], bound: f64| {
            let n = sorted.len() - sorted.partition_point(|score| *score < bound);
            100.0 * n as f64 / sorted.len().max(1) as f64
        };
        let bounds = (0..=200).rev().filter_map(|k| so.get(k * so.len().saturating_sub(1) / 200));
        let curve = bounds.map(|&bound| (above(&not, bound), above(&so, bound)));
        [(0.0, 0.0)].into_iter().chain(curve).chain([(100.0, 100.0)]).collect()
    }
}

/// The strides of one who trains: upward and forward at any inclination, so level and inclined in turns.
fn count(office: &Scenario, person: u64) -> EventCounts {
    let mode = if person.is_multiple_of(2) { CarryMode::HeldLevel } else { CarryMode::HeldUpright };
    let mut counter = StrideCounter::new(UPWARD_G);
    samples(office, mode, TRAINED_STEPS, person).iter().for_each(|sample| counter.push(sample));
    *counter.counts()
}

/// Trains, tests and draws the receiver's curves.
pub fn run(run: &Run) -> Findings {
    let office = test_bed::mass_centered_office(1);
    let counts: Vec<EventCounts> = run.per_seed(N_TRAINED, |person| count(&office, person));
    let mut all = EventCounts::default();
    counts.iter().for_each(|counts| all.merge(counts));
    // Equal priors, as in the paper.
    let table = all.table([0.25; 4]);
    let tested = run.per_seed(N_TESTED, |seed| test(&office, table, TESTERS_FROM + seed));
    let testers: Vec<&[Vec<AttitudeEstimate>; 5]> = tested.iter().collect();
    let mut findings = Findings::default();
    let mut chart =
        Chart::new("Attitude", "false alarms (%)", "true alarms (%)").y_up_to(100.0).x_up_to(100.0);
    for classifier in &CLASSIFIERS {
        let area = Estimate::pooled(&tested, |testers| {
            let [so, not] = classifier.scores(testers);
            auc(&so, &not)
        });
        findings = findings.with(Finding::new(classifier.id, tested.len(), [area]));
        chart = chart.with(Series::line(classifier.name, classifier.curve(&testers)));
    }
    findings.with_picture(Picture::of(
        format!(
            "{} walkers in five scenarios, judged step by step; {} others trained.",
            tested.len(),
            counts.len()
        ),
        chart.to_svg(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phone_turned_over_faces_down() {
        let mut sample = Sample {
            time: fieldwalk::time::Timestamp::from_nanos(0),
            reading: Reading::SpecificForce([1.0, 2.0, 9.0]),
        };
        turn_over(&mut sample);
        assert_eq!(sample.reading, Reading::SpecificForce([-1.0, 2.0, -9.0]));
    }
}
