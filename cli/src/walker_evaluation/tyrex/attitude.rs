//! Attitudes against the trials' names and the capture, once a second.
//!
//! A moment is a whole second of the capture. What counts is what the detector says there, having heard nothing later.
//! By name, UFH is every moment of a trial of texting and of no other, and texting alone faces up. The capture is the
//! second opinion, for phones on their way to the pocket and cameras that look down.
//!
//! No trial has the screen up and the top edge elsewhere than ahead, so the trials of texting are also replayed with
//! the phone turned in quarters about its screen's normal.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;

use fieldwalk::attitude::{Attitude, AttitudeEstimate, AttitudeParams, CarryMode, EventCounts, EventTable};
use fieldwalk::pedestrian::{Pedestrian, PedestrianParams};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_formats::tyrex::{Motion, Truth};
use rayon::prelude::*;

use super::training::{count_strides, table_of};
use super::{CapturedTrial, DATASET};
use crate::plot::{Chart, Series};
use crate::walker_evaluation::auc::auc;
use crate::walker_evaluation::{ALL, Metric, MetricRow, MetricScores, Plot};

/// What the detector said at a moment, and what was so.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// When, on the clock of the capture.
    pub time: Timestamp,
    /// The detector's answer.
    pub said: AttitudeEstimate,
    /// Mean of the vertical's share out of the screen over the last second, by the capture: 1 for a level phone.
    pub captured_upward: Option<f64>,
}

/// The moments of one trial for one system.
#[derive(Clone, Debug)]
pub struct TrialMoments<'a> {
    /// The trial.
    pub trial: &'a CapturedTrial,
    /// Its moments, in order of time.
    pub moments: Vec<Moment>,
    /// Of a trial of texting, the moments with the phone turned to the left, back and to the right.
    pub turned: Vec<Moment>,
}

/// The systems' names, each with its parameters for the trials of each half.
fn systems(trials: &[CapturedTrial], table: Option<EventTable>) -> Vec<(&'static str, [AttitudeParams; 2])> {
    let with = |table: EventTable| AttitudeParams { table, ..AttitudeParams::default() };
    let counts: Vec<EventCounts> = trials
        .par_iter()
        .map(|trial| match trial.trial.motion {
            Motion::Texting => count_strides(&trial.samples),
            _ => EventCounts::default(),
        })
        .collect();
    let trained_without = |half: usize| {
        let mut others = EventCounts::default();
        for (of_trial, _) in counts.iter().zip(halves(trials)).filter(|(_, its_half)| *its_half != half) {
            others.merge(of_trial);
        }
        with(table_of(&others))
    };
    let mut systems = vec![
        ("printed", [AttitudeParams::printed(); 2]),
        ("trained", [0, 1].map(trained_without)),
        ("shipped", [AttitudeParams::default(); 2]),
    ];
    systems.extend(table.map(|table| ("file", [with(table); 2])));
    systems
}

/// The half of each trial: the trials of a motion, by name, in turns.
fn halves(trials: &[CapturedTrial]) -> Vec<usize> {
    let earlier = |k: usize| {
        let motion = trials[k].trial.motion;
        trials[..k].iter().filter(move |other| other.trial.motion == motion)
    };
    (0..trials.len()).map(|k| earlier(k).count() % 2).collect()
}

/// A trial with fewer right decisions of UFH than this, in percent, is pictured.
const PICTURED_BELOW_PERCENT: f64 = 99.0;

/// Adds the rows of every subset: phones, persons where there are several, disturbed or not, texting against each other
/// motion, and all. A trial that the `trained` system often gets wrong gives a picture.
pub fn score(trials: &[CapturedTrial], table: Option<EventTable>, scores: &mut MetricScores) {
    let halves = halves(trials);
    let mut rows: Vec<(usize, MetricRow)> = Vec::new();
    for (system, params) in systems(trials, table) {
        let of_trials: Vec<TrialMoments<'_>> = trials
            .par_iter()
            .zip(&halves)
            .map(|(trial, &half)| TrialMoments {
                trial,
                moments: moments(trial, &trial.samples, params[half]),
                turned: turned_moments(trial, params[half]),
            })
            .collect();
        if system == "trained" {
            scores.plots.extend(of_trials.iter().filter_map(plot));
        }
        for (k, (subset, chosen)) in subsets(&of_trials).into_iter().enumerate() {
            rows.extend(subset_rows(&subset, system, &chosen).into_iter().map(|row| (k, row)));
        }
    }
    rows.sort_by_key(|(subset, _)| *subset);
    scores.rows.extend(rows.into_iter().map(|(_, row)| row));
}

/// What was said and captured over a trial, if it was often wrong.
fn plot(of_trial: &TrialMoments<'_>) -> Option<Plot> {
    let trial = &of_trial.trial.trial;
    let is_right = |moment: &&Moment| {
        (moment.said.attitude == Attitude::UpwardForwardHorizontal) == (trial.motion == Motion::Texting)
    };
    let n = of_trial.moments.len();
    let right_percent = 100.0 * of_trial.moments.iter().filter(is_right).count() as f64 / n as f64;
    if n == 0 || right_percent >= PICTURED_BELOW_PERCENT {
        return None;
    }
    let line = |name: &str, of: &dyn Fn(&Moment) -> Option<f64>| {
        let point = |moment: &Moment| Some((moment.time.secs_since(Timestamp::default()), of(moment)?));
        Series::line(name, of_trial.moments.iter().filter_map(point).collect())
    };
    let chart = Chart::new(
        format!("{}: UFH rightly told {right_percent:.1} % of the time", trial.name),
        "time (s)",
        "share, probability",
    )
    .with(line("upward, captured", &|moment| moment.captured_upward))
    .with(line("upward, felt (g)", &|moment| Some(f64::from(moment.said.upward_g))))
    .with(line("P(forward)", &|moment| Some(f64::from(moment.said.p_forward))))
    .with(line("UFH score", &|moment| Some(f64::from(moment.said.ufh_score))));
    Some(Plot { file_name: format!("attitude-{}.svg", trial.name), svg: chart.to_svg() })
}

type Chosen<'a> = Vec<&'a TrialMoments<'a>>;

fn subsets<'a>(trials: &'a [TrialMoments<'a>]) -> Vec<(String, Chosen<'a>)> {
    let mut subsets: Vec<(String, Chosen<'a>)> = Vec::new();
    let mut add = |name: String, is_in: &dyn Fn(&CapturedTrial) -> bool| {
        let chosen: Chosen<'a> = trials.iter().filter(|of_trial| is_in(of_trial.trial)).collect();
        if !chosen.is_empty() {
            subsets.push((name, chosen));
        }
    };
    let names = |of: &dyn Fn(&CapturedTrial) -> String| {
        trials.iter().map(|of_trial| of(of_trial.trial)).collect::<BTreeSet<_>>()
    };
    let persons = names(&|trial| trial.trial.person.clone());
    if persons.len() > 1 {
        for person in persons {
            add(format!("person {person}"), &|trial| trial.trial.person == person);
        }
    }
    for phone in names(&|trial| trial.trial.phone.clone()) {
        add(format!("phone {phone}"), &|trial| trial.trial.phone == phone);
    }
    add("undisturbed".into(), &|trial| !trial.trial.is_disturbed);
    add("disturbed".into(), &|trial| trial.trial.is_disturbed);
    for motion in Motion::ALL.into_iter().filter(|&motion| motion != Motion::Texting) {
        if trials.iter().any(|of_trial| of_trial.trial.trial.motion == motion) {
            let is_in = move |trial: &CapturedTrial| [motion, Motion::Texting].contains(&trial.trial.motion);
            add(format!("Texting and {}", motion.name()), &is_in);
        }
    }
    add(ALL.into(), &|_| true);
    subsets
}

fn subset_rows(subset: &str, system: &str, trials: &[&TrialMoments<'_>]) -> Vec<MetricRow> {
    let params = AttitudeParams::default();
    let level_from = (f64::from(params.level_share) * FRAC_PI_2).cos();
    let upward_from = f64::from(params.upward_g);
    let moments = || {
        trials.iter().flat_map(|of_trial| {
            let motion = of_trial.trial.trial.motion;
            of_trial.moments.iter().map(move |moment| (motion, moment))
        })
    };
    let n = moments().count();
    // Scores of the moments with and without the property; `is_so` may have no opinion.
    let area = |score: &dyn Fn(&AttitudeEstimate) -> f32, is_so: &dyn Fn(Motion, &Moment) -> Option<bool>| {
        let mut scores = [Vec::new(), Vec::new()];
        for (motion, moment) in moments() {
            if let Some(is_so) = is_so(motion, moment) {
                scores[usize::from(is_so)].push(f64::from(score(&moment.said)));
            }
        }
        (auc(&scores[1], &scores[0]), scores[0].len() + scores[1].len())
    };
    let share_percent = |is_right: &dyn Fn(Motion, &Moment) -> bool| {
        (100.0 * moments().filter(|(motion, moment)| is_right(*motion, moment)).count() as f64 / n as f64, n)
    };
    let ufh = |said: &AttitudeEstimate| said.ufh_score;
    let non_upward = |said: &AttitudeEstimate| -said.upward_g;
    let captured_ufh = |motion: Motion, moment: &Moment| {
        let is_level = moment.captured_upward? > level_from;
        (is_level == (motion == Motion::Texting)).then_some(is_level)
    };
    let is_ufh = |said: &AttitudeEstimate| said.attitude == Attitude::UpwardForwardHorizontal;
    let p_forward = |moment: &Moment| f64::from(moment.said.p_forward);
    let texting = trials.iter().filter(|of_trial| of_trial.trial.trial.motion == Motion::Texting);
    let ahead: Vec<f64> =
        texting.clone().flat_map(|of_trial| of_trial.moments.iter().map(p_forward)).collect();
    let turned: Vec<f64> = texting.flat_map(|of_trial| of_trial.turned.iter().map(p_forward)).collect();
    [
        (Metric::AucForwardTurned, (auc(&ahead, &turned), ahead.len() + turned.len())),
        (Metric::AucUfh, area(&ufh, &|motion, _| Some(motion == Motion::Texting))),
        (Metric::AucNonUpward, area(&non_upward, &|motion, _| Some(motion != Motion::Texting))),
        (Metric::AucUfhCaptured, area(&ufh, &captured_ufh)),
        (
            Metric::AucNonUpwardCaptured,
            area(&non_upward, &|_, moment| moment.captured_upward.map(|upward| upward <= upward_from)),
        ),
        (
            Metric::UfhCorrectPercent,
            share_percent(&|motion, moment| is_ufh(&moment.said) == (motion == Motion::Texting)),
        ),
        (
            Metric::CarryModeCorrectPercent,
            share_percent(&|motion, moment| is_carried_so(motion, moment.said.carry_mode)),
        ),
    ]
    .map(|(metric, (value, n))| MetricRow {
        dataset: DATASET,
        subset: subset.into(),
        system: system.into(),
        metric,
        value,
        n,
    })
    .into()
}

/// Whether `mode` is how the phone is carried in `motion`.
pub fn is_carried_so(motion: Motion, mode: CarryMode) -> bool {
    match motion {
        Motion::AugmentedReality => mode == CarryMode::HeldUpright,
        Motion::Texting => mode == CarryMode::HeldUp,
        Motion::Phoning => mode == CarryMode::Calling,
        Motion::Swinging | Motion::RunningInHand => mode == CarryMode::Swinging,
        Motion::FrontPocket => mode == CarryMode::FrontPocket,
        Motion::BackPocket => mode == CarryMode::BackPocket,
        Motion::RunningInPocket => matches!(mode, CarryMode::FrontPocket | CarryMode::BackPocket),
    }
}

/// What a detector with `params` says at every whole second of the capture.
///
/// It hears `samples`: the trial's, as they are or turned.
pub fn moments(trial: &CapturedTrial, samples: &[Sample], params: AttitudeParams) -> Vec<Moment> {
    let mut pedestrian =
        Pedestrian::new(PedestrianParams { attitude: params, ..PedestrianParams::default() });
    let (Some(first), Some(last)) = (trial.truth.poses.first(), trial.truth.poses.last()) else {
        return Vec::new();
    };
    let second = Duration::from_millis(1_000);
    let mut next = first.time + second;
    let mut moments = Vec::new();
    for sample in samples {
        while sample.time > next && next <= last.time {
            moments.push(Moment {
                time: next,
                said: pedestrian.attitude(),
                captured_upward: captured_upward(&trial.truth, next),
            });
            next = next + second;
        }
        pedestrian.push(sample);
    }
    moments
}

/// The moments of a trial of texting with the phone turned by one, two and three quarters; of others none.
fn turned_moments(trial: &CapturedTrial, params: AttitudeParams) -> Vec<Moment> {
    if trial.trial.motion != Motion::Texting {
        return Vec::new();
    }
    let mut samples = trial.samples.clone();
    let mut turned = Vec::new();
    for _ in 0..3 {
        samples.iter_mut().for_each(turn_left);
        turned.extend(moments(trial, &samples, params));
    }
    turned
}

/// The sample of a phone turned by a quarter to the left about its screen's normal, otherwise moved alike.
pub fn turn_left(sample: &mut Sample) {
    let left = |[x, y, z]: [f32; 3]| [y, -x, z];
    match &mut sample.reading {
        Reading::SpecificForce(v) | Reading::AngularRate(v) | Reading::MagneticField(v) => *v = left(*v),
        Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
            *field_ut = left(*field_ut);
            *bias_ut = left(*bias_ut);
        }
        _ => {}
    }
}

/// Mean over the second before `time` of the vertical's share out of the screen.
fn captured_upward(truth: &Truth, time: Timestamp) -> Option<f64> {
    let from = truth.poses.partition_point(|pose| time.secs_since(pose.time) > 1.0);
    let to = truth.poses.partition_point(|pose| pose.time <= time);
    let poses = truth.poses.get(from..to).filter(|poses| poses.len() >= 10)?;
    let sum: f64 = poses.iter().map(|pose| pose.to_earth([0.0, 0.0, 1.0])[2]).sum();
    Some(sum / poses.len() as f64)
}
