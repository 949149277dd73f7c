//! Positioning on recordings by others: one floor of a shopping mall, mapped from half of its walks.
//!
//! Needs the recordings that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without them.
#![allow(clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use fieldwalk::Rejections;
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::metrics::quantile;
use fieldwalk::positioner::{PositionHint, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::survey::{SurveyParams, SurveyTrack, SurveyWalk, Waypoint, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_formats::ilc::{Floor, TraceReader, floor_ordinal};
use fieldwalk_formats::{Record, decode_floor, encode_floor};
use fieldwalk_tests::recordings::ilc_floor;

const MAX_MAP_BYTES: usize = 4 * 1024 * 1024;

/// A recorded walk, as samples and as a survey walk.
struct Walk {
    samples: Vec<Sample>,
    survey: SurveyWalk,
}

fn read(path: &Path) -> Walk {
    let mut survey = SurveyWalk::new(path.display().to_string());
    let mut samples = Vec::new();
    for record in TraceReader::open(path).unwrap() {
        match record.unwrap_or_else(|error| panic!("{}: {error}", path.display())) {
            Record::Sample(sample) => {
                survey.push(&sample);
                samples.push(sample);
            }
            Record::Waypoint { time, point } => survey.push_waypoint(Waypoint { time, point }),
        }
    }
    survey.finish();
    Walk { samples, survey }
}

/// Errors at every waypoint but the first, in metres.
fn errors_m(index: &Arc<FloorIndex>, recipe: &Recipe, seed: u64, walk: &Walk) -> Vec<f64> {
    let waypoints = walk.survey.waypoints();
    let mut positioner = Positioner::new(Arc::clone(index), recipe.clone(), seed);
    let start = waypoints[0];
    let point = start.point + Point2::new(0.9, -0.6);
    positioner
        .hint(PositionHint {
            point,
            radius_m: 2.0,
            floor: index.map().ordinal,
            time: start.time,
            direction: None,
        })
        .unwrap();
    let mut samples = walk.samples.iter().peekable();
    waypoints[1..]
        .iter()
        .map(|waypoint| {
            while let Some(sample) = samples.next_if(|sample| sample.time <= waypoint.time) {
                positioner.push(*sample);
            }
            let fix = positioner.fix_at(waypoint.time).unwrap();
            assert!(fix.radius_95_m >= fix.radius_68_m && fix.radius_68_m > 0.0, "{fix:?}");
            fix.position.distance_m(waypoint.point)
        })
        .collect()
}

fn median_m(mut errors_m: Vec<f64>) -> f64 {
    errors_m.sort_by(f64::total_cmp);
    quantile(&errors_m, 0.5)
}

#[test]
fn a_floor_of_a_mall_is_read_mapped_written_and_walked() {
    let Some(folder) = ilc_floor("F1") else { return };
    let floor = Floor::open(&folder).unwrap();
    assert!(floor.traces.len() > 50, "{} traces", floor.traces.len());

    // Every trace reads, and its steps are those of a person who walks.
    let mut walks: Vec<Walk> = floor.traces.iter().map(|path| read(path)).collect();
    for walk in &walks {
        let Some(track) = SurveyTrack::of(&walk.survey) else { continue };
        let (first, last) = (track.waypoints()[0].time, track.waypoints().last().unwrap().time);
        let seconds = last.secs_since(first);
        let n = track.steps().len();
        assert!(
            (0.3 * seconds..3.5 * seconds).contains(&(n as f64)),
            "{}: {n} steps in {seconds:.0} s",
            walk.survey.name()
        );
        // Beacons are logged up to a second after they were heard; the motion sensors keep time.
        let mut motion = SurveyWalk::new("motion");
        let is_radio = |sample: &&Sample| matches!(sample.reading, Reading::Radio(_));
        walk.samples.iter().filter(|sample| !is_radio(sample)).for_each(|sample| motion.push(sample));
        assert_eq!(motion.rejections(), Rejections::default(), "{}", walk.survey.name());
    }

    // A map from every other walk.
    let surveyed: Vec<SurveyWalk> = walks.iter().step_by(2).map(|walk| walk.survey.clone()).collect();
    let ordinal = floor_ordinal(&floor.name);
    let map = build_floor(&floor.name, ordinal, &floor.plan, &surveyed, &SurveyParams::default()).unwrap();
    assert!(map.transmitters.len() > 10, "{} transmitters", map.transmitters.len());

    // It survives the disk: after one rounding to the file's precision, bit for bit.
    let bytes = encode_floor(&map).unwrap();
    assert!(bytes.len() <= MAX_MAP_BYTES, "{} bytes", bytes.len());
    let decoded = decode_floor(&bytes).unwrap();
    assert_eq!((&decoded.plan, &decoded.frame), (&map.plan, &map.frame));
    assert!(encode_floor(&decoded).unwrap() == bytes);
    assert!(decode_floor(&encode_floor(&decoded).unwrap()).unwrap() == decoded);

    // The walks that it has not seen, from the map as a phone would load it.
    let index = Arc::new(FloorIndex::new(decoded));
    let test_walks: Vec<Walk> = walks
        .drain(..)
        .skip(1)
        .step_by(2)
        .filter(|walk| walk.survey.waypoints().len() >= 5)
        .take(6)
        .collect();
    assert_eq!(test_walks.len(), 6);
    let median = |name: &str| {
        let recipe = Recipe::named(name).unwrap();
        median_m(test_walks.iter().flat_map(|walk| errors_m(&index, &recipe, 1, walk)).collect())
    };
    let (reckoned_m, fused_m) = (median("dead-reckoning"), median("fused"));
    assert!(fused_m < reckoned_m, "fused {fused_m:.2} m, dead reckoning {reckoned_m:.2} m");
    assert!(fused_m < 4.0, "{fused_m:.2} m");
}
