//! Whole systems in an open hall: surveyed when it is empty, walked when it is full.
//!
//! One phone surveys and is positioned, as in the paper. The clusters' places come with the map, and the path loss of each
//! beacon is fitted to what the survey heard of it near by.

use std::sync::Arc;

use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorIndex, Transmitter};
use fieldwalk::radio::path_loss::PathLoss;
use fieldwalk::sensor::Reading;
use fieldwalk::survey::{SurveyParams, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_sim::magnetic_field::MovableParams;
use fieldwalk_sim::scenario::{Recorded, Scenario, Walk};

use crate::evaluation::Start;
use crate::plot::cdf;
use crate::reproduce::estimate::{mean_of, quantile_of};
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::test_bed::{self, IBILL_HEIGHTS_M};
use crate::reproduce::{Estimate, Experiment, Finding, Findings, Picture, Run};
use crate::simulated::floor_name;

/// What is measured on walks.
pub const EXPERIMENTS: &[Experiment] = &[Experiment {
    name: "traces through the hall",
    claims: &["ibill-90", "ibill-beats-magicol", "ibill-users", "ibill-early"],
    is_timed: false,
    run,
}];

/// Halls, each with its own steel, beacons, traces and crowd.
const N_SEEDS: u64 = 96;
/// Of them those in which all users walk.
const N_SEEDS_OF_USERS: u64 = 48;
/// A trace begins at a cluster, so the place is known; the direction is not told.
const START: Start = Start::Known { radius_m: 1.0 };
/// Where the filters are compared with each other, the direction is known too.
///
/// # Source
/// iBILL 2017, §V-B, of Fig. 14: "the known initial location and direction". How well is ours.
const FACING: Start = Start::Facing { radius_m: 1.0, off_deg: 10.0 };
/// Scored once a second from here on.
const FIRST_SCORED_S: i64 = 3;
/// The user who surveys and walks, by the order of [`IBILL_HEIGHTS_M`].
const SURVEYOR: usize = 2;
/// A beacon's path loss is fitted to what was heard within this, in metres: twice the range that the paper calls accurate.
const FITTED_WITHIN_M: f64 = 8.0;

/// Errors of one hall, in metres, in the order of a trace's truth points.
struct Measured {
    ibill_m: Vec<f64>,
    magicol_m: Vec<f64>,
    reckoned_m: Vec<f64>,
    /// iBILL's filter alone, without beacons, and Magicol, both told the direction.
    filter_m: Vec<f64>,
    told_magicol_m: Vec<f64>,
    /// iBILL by user.
    users_m: Vec<Vec<f64>>,
}

fn walked_by(walk: Walk, user: usize, seed: u64) -> Walk {
    Walk { walker: test_bed::user(IBILL_HEIGHTS_M[user]), device: seed, ..walk }
}

/// The hall with the map of a quiet afternoon, ready for an evening with a crowd.
fn surveyed(seed: u64) -> Surveyed {
    let mut hall = test_bed::ibill_clusters(seed);
    let walks = hall.survey_walks().into_iter().map(|walk| walked_by(walk, SURVEYOR, seed));
    let recorded: Vec<Recorded> = walks.map(|walk| hall.simulate(&walk)).collect();
    let survey: Vec<_> = recorded.iter().map(Recorded::survey_walk).collect();
    let map = build_floor(&floor_name(0), 0, &hall.building.plan, &survey, &SurveyParams::default());
    let mut map = map.unwrap_or_default();
    map.transmitters = installed(&hall, &recorded);
    hall.movable = MovableParams::busy();
    Surveyed { scenario: hall, floor: Arc::new(FloorIndex::new(map)) }
}

/// The beacons where they hang, with the path loss that the survey heard.
fn installed(hall: &Scenario, recorded: &[Recorded]) -> Vec<Transmitter> {
    let of_beacon = |beacon: &fieldwalk_sim::radio::Transmitter| {
        let [x_m, y_m, _] = beacon.place_m;
        let position = Point2::new(x_m, y_m);
        let packets = recorded.iter().flat_map(|walk| walk.samples.iter().map(move |sample| (walk, sample)));
        let sightings: Vec<(f64, f64)> = packets
            .filter_map(|(walk, sample)| match sample.reading {
                Reading::Radio(heard) if heard.transmitter == beacon.id => {
                    let distance_m = walk.truth_at(sample.time)?.position.distance_m(position);
                    (distance_m <= FITTED_WITHIN_M).then_some((distance_m, f64::from(heard.rssi_dbm)))
                }
                _ => None,
            })
            .collect();
        let path_loss = PathLoss::fit(&sightings).ok()?;
        Some(Transmitter {
            id: beacon.id,
            position,
            power_at_1m_dbm: path_loss.power_at_1m_dbm,
            path_loss_exponent: path_loss.exponent,
            sigma_db: path_loss.sigma_db,
            n_sightings: sightings.len() as u32,
        })
    };
    hall.radio.transmitters.iter().filter_map(of_beacon).collect()
}

fn measure(seed: u64) -> Measured {
    let hall = surveyed(seed);
    let trace = Walk::along("trace", test_bed::ibill_trace(seed), seed);
    let by = |user: usize| hall.walked(&walked_by(trace.clone(), user, seed), FIRST_SCORED_S);
    let walk = by(SURVEYOR);
    let from = |start: Start, recipe: Recipe| -> Vec<f64> {
        walk.iter().flat_map(|walk| hall.errors_m(&recipe, start, seed, walk)).collect()
    };
    let of = |recipe: Recipe| from(START, recipe);
    let n_users = if seed <= N_SEEDS_OF_USERS { IBILL_HEIGHTS_M.len() } else { 0 };
    let users_m = (0..n_users)
        .map(|user| by(user).map_or(Vec::new(), |walk| hall.errors_m(&Recipe::ibill(), START, seed, &walk)));
    Measured {
        ibill_m: of(Recipe::ibill()),
        magicol_m: of(test_bed::magicol(5, 1)),
        reckoned_m: of(Recipe::dead_reckoning()),
        filter_m: from(FACING, Recipe { beacons: None, ..Recipe::ibill() }),
        told_magicol_m: from(FACING, test_bed::magicol(5, 1)),
        users_m: users_m.collect(),
    }
}

/// Mean errors of the first third of a trace.
fn early_m(errors_m: &[f64]) -> f64 {
    mean_of(&errors_m[..errors_m.len() / 3])
}

fn run(run: &Run) -> Findings {
    let measured = run.per_seed(N_SEEDS, measure);
    let n = measured.len();
    let of = |pick: fn(&Measured) -> &Vec<f64>| -> Vec<Vec<f64>> {
        measured.iter().map(|one| pick(one).clone()).collect()
    };
    let (ibill, magicol) = (of(|one| &one.ibill_m), of(|one| &one.magicol_m));
    let reckoned = of(|one| &one.reckoned_m);
    let (filter, told_magicol) = (of(|one| &one.filter_m), of(|one| &one.told_magicol_m));
    let p90 = |errors: &[Vec<f64>]| -> Vec<f64> {
        errors.iter().map(|one| quantile_of(one.iter().copied(), 0.9)).collect()
    };
    let early = |errors: &[Vec<f64>]| -> Vec<f64> { errors.iter().map(|one| early_m(one)).collect() };
    let users: Vec<Vec<Vec<f64>>> = (0..IBILL_HEIGHTS_M.len())
        .map(|user| measured.iter().filter_map(|one| one.users_m.get(user).cloned()).collect())
        .collect();
    let worst = users
        .iter()
        .map(|of_user| Estimate::pooled_quantile(of_user, 0.9))
        .max_by(|a, b| a.value.total_cmp(&b.value))
        .unwrap_or(Estimate::exact(f64::NAN));
    let systems = [
        ("ibill", ibill.concat()),
        ("ibill without beacons, direction told", filter.concat()),
        ("magicol, direction told", told_magicol.concat()),
        ("magicol", magicol.concat()),
        ("dead-reckoning", reckoned.concat()),
    ];
    let names = IBILL_HEIGHTS_M.map(|height_m| format!("{height_m:.2} m tall"));
    let by_user: Vec<Vec<f64>> = users.iter().map(|of_user| of_user.concat()).collect();
    fn lines<'a>(named: impl Iterator<Item = (&'a str, &'a Vec<f64>)>) -> Vec<(&'a str, &'a [f64])> {
        named.map(|(name, errors_m)| (name, &errors_m[..])).collect()
    }
    let systems_line = lines(systems.iter().map(|(name, errors_m)| (*name, errors_m)));
    let users_line = lines(names.iter().map(String::as_str).zip(&by_user));
    Findings::default()
        .with(Finding::new("ibill-90", n, [Estimate::pooled_quantile(&ibill, 0.9)]))
        .with(Finding::new(
            "ibill-beats-magicol",
            n,
            [Estimate::paired(&p90(&ibill), &p90(&magicol)), Estimate::paired(&p90(&magicol), &p90(&reckoned))],
        ))
        .with(Finding::new("ibill-users", users.first().map_or(0, Vec::len), [worst]))
        .with(
            Finding::new("ibill-early", n, [Estimate::paired(&early(&filter), &early(&told_magicol))])
                .because("Magicol carries its direction on by the gyroscope too"),
        )
        .with_picture(Picture::of(
            format!("{n} halls of 1800 m\u{b2}, surveyed empty, a trace through the crowd from cluster to cluster and back."),
            cdf("A trace through the hall", "error (m)", &systems_line).to_svg(),
        ))
        .with_picture(Picture::of(
            "Five users on the same traces; the third surveyed.",
            cdf("Users of iBILL", "error (m)", &users_line).to_svg(),
        ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hall_has_two_clusters_where_they_hang() {
        let hall = surveyed(1);
        let map = hall.floor.map();
        assert_eq!(map.transmitters.len(), 6);
        let clusters = fieldwalk::beacon_mode::find_clusters(&map.transmitters, 4.0);
        assert_eq!(clusters.len(), 2);
        assert!((clusters[0].centre.distance_m(clusters[1].centre) - 50.0).abs() < 0.1);
        let trace = test_bed::ibill_trace(1);
        assert!([0, 6].iter().all(|&k| trace[k].distance_m(clusters[0].centre) < 0.1), "{trace:?}");
        assert!(trace[3].distance_m(clusters[1].centre) < 0.1, "{trace:?}");
    }
}
