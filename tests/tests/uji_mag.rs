//! The corridors of a laboratory: the reader on every walk of the collection, and `fused` on some.
//!
//! Needs the collection that [`fieldwalk_tests::recordings`] finds; skipped, and said so, without it.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{PositionHint, Positioner};
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::survey::{SurveyParams, SurveyWalk, Waypoint, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk_formats::Record;
use fieldwalk_formats::uji_mag::{UjiMagCollection, UjiMagWalk};
use fieldwalk_tests::recordings::collection;

fn open(path: &Path) -> UjiMagWalk {
    UjiMagWalk::read(BufReader::new(File::open(path).unwrap()), path).unwrap()
}

/// A walk's samples, and the same as a survey walk.
fn read(path: &Path, lab: &UjiMagCollection) -> (Vec<Sample>, SurveyWalk) {
    let (mut samples, mut survey) = (Vec::new(), SurveyWalk::new(path.display().to_string()));
    for record in open(path).records(lab.plan.georeference.unwrap()) {
        match record {
            Record::Sample(sample) => {
                samples.push(sample);
                survey.push(&sample);
            }
            Record::Waypoint { time, point } => survey.push_waypoint(Waypoint { time, point }),
        }
    }
    survey.finish();
    (samples, survey)
}

#[test]
fn every_walk_is_read_and_gravity_stands_where_it_should() {
    let Some(folder) = collection("uji-mag") else { return };
    let lab = UjiMagCollection::open(&folder).unwrap();
    assert!(lab.lines.len() >= 8 && lab.walks.len() >= 8);
    // The laboratory has 260 m²; its corridors reach across 15 m by 17 m, and the frame is 5 m wider all round.
    assert!((20.0..35.0).contains(&lab.plan.width_m) && (20.0..35.0).contains(&lab.plan.height_m));
    let (mut n_stuck, mut strengths_m_s2) = (0, Vec::new());
    for path in lab.lines.iter().chain(&lab.walks) {
        let walk = open(path);
        assert!(walk.rejections().total() <= 1, "{}: {}", path.display(), walk.rejections());
        n_stuck += usize::from(walk.is_motion_stuck());
        for record in walk.records(lab.plan.georeference.unwrap()) {
            if let Record::Sample(Sample { reading: Reading::SpecificForce(f), .. }) = record {
                strengths_m_s2.push(f64::from(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]).sqrt());
            }
        }
    }
    assert!(10 * n_stuck <= lab.lines.len() + lab.walks.len(), "{n_stuck} walks without motion");
    let mean_m_s2 = strengths_m_s2.iter().sum::<f64>() / strengths_m_s2.len() as f64;
    assert!((mean_m_s2 - 9.81).abs() < 0.2, "{mean_m_s2}");
}

#[test]
fn fused_follows_walks_on_the_map_of_the_lines() {
    let Some(folder) = collection("uji-mag") else { return };
    let lab = UjiMagCollection::open(&folder).unwrap();
    let lines: Vec<SurveyWalk> = lab.lines.iter().map(|path| read(path, &lab).1).collect();
    let map = build_floor("F1", 0, &lab.plan, &lines, &SurveyParams::default()).unwrap();
    let index = Arc::new(FloorIndex::new(map));
    // The lines of a corridor coincide.
    assert_eq!(index.way_band_m(), 0.5);
    let mut errors_m = Vec::new();
    for path in lab.walks.iter().step_by(6) {
        let (samples, survey) = read(path, &lab);
        let waypoints = survey.waypoints();
        let mut positioner = Positioner::new(Arc::clone(&index), Recipe::fused(), 1);
        let point = waypoints[0].point + Point2::new(0.9, -0.6);
        positioner
            .hint(PositionHint { point, radius_m: 2.0, floor: 0, time: waypoints[0].time, direction: None })
            .unwrap();
        // Halfway along the last segment, where no waypoint is near.
        let [from, to] = waypoints.last_chunk::<2>().unwrap();
        let (time, place) = (from.time.midpoint(to.time), from.point.lerp(to.point, 0.5));
        for sample in samples.iter().take_while(|sample| sample.time <= time) {
            positioner.push(*sample);
        }
        errors_m.push(positioner.fix_at(time).unwrap().position.distance_m(place));
    }
    let mean_m = errors_m.iter().sum::<f64>() / errors_m.len() as f64;
    assert!(mean_m < 2.5, "{mean_m} m over {} walks", errors_m.len());
}
