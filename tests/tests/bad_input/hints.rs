//! Hints that make no sense, and times that have passed.

use std::sync::Arc;

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::map::FloorIndex;
use fieldwalk::positioner::{HintedDirection, Mode, PositionError, PositionHint, Positioner};
use fieldwalk::survey::{SurveyParams, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_tests::synthetic::{FLOOR_NAME, FLOOR_ORDINAL};

use crate::{WORLD, assert_sound, fixes, followers, fresh, hint, placed, recipes, samples};

#[test]
fn hints_that_make_no_sense_are_refused_and_change_nothing() {
    let off_plan = |x_m, y_m| PositionHint { point: Point2::new(x_m, y_m), ..hint() };
    let radius = |radius_m| PositionHint { radius_m, ..hint() };
    let direction = |heading_rad, sd_rad| PositionHint {
        direction: Some(HintedDirection { heading_rad, sd_rad }),
        ..hint()
    };
    let bad = [
        off_plan(f64::NAN, 3.0),
        off_plan(3.0, f64::NAN),
        off_plan(f64::INFINITY, 3.0),
        off_plan(3.0, f64::NEG_INFINITY),
        off_plan(32.0, 3.0),
        off_plan(3.0, -2.0),
        radius(f64::NAN),
        radius(f64::INFINITY),
        radius(0.0),
        radius(-1.0),
        radius(0.05),
        radius(1_001.0),
        direction(f64::NAN, 0.1),
        direction(f64::INFINITY, 0.1),
        direction(1.0, f64::NAN),
        direction(1.0, 0.0),
        direction(1.0, -0.1),
        direction(1.0, 3.2),
    ];
    for recipe in recipes() {
        let mut positioner = placed(&recipe);
        fixes(&mut positioner, samples()[..2_000].iter().copied());
        let before = positioner.fix();
        for hint in bad {
            assert_eq!(positioner.hint(hint), Err(PositionError::BadHint), "{hint:?}");
            assert_eq!(positioner.fix(), before);
        }
        let elsewhere = PositionHint { floor: FLOOR_ORDINAL + 1, ..hint() };
        let expected = PositionError::WrongFloor { hinted: FLOOR_ORDINAL + 1, mapped: FLOOR_ORDINAL };
        assert_eq!(positioner.hint(elsewhere), Err(expected.clone()));
        assert!(expected.to_string().contains("open that floor's map"), "{expected}");
        assert_eq!(positioner.fix(), before);
    }
}

#[test]
fn a_hint_just_off_the_plan_is_taken_within_its_radius() {
    let mut positioner = fresh(&Recipe::fused());
    assert_eq!(positioner.hint(PositionHint { point: Point2::new(31.0, 21.0), ..hint() }), Ok(()));
    assert!(positioner.fix().unwrap().position.distance_m(Point2::new(31.0, 21.0)) < hint().radius_m);
}

#[test]
fn a_hint_far_from_any_survey_goes_on_without_a_map() {
    // A plan of 300 m × 200 m, surveyed in one corner alone.
    let plan = FloorPlan { width_m: 300.0, height_m: 200.0, ..FloorPlan::default() };
    let walks = WORLD.floor.survey();
    let map = build_floor(FLOOR_NAME, FLOOR_ORDINAL, &plan, &walks[..2], &SurveyParams::default()).unwrap();
    let index = Arc::new(FloorIndex::new(map));
    for recipe in followers() {
        let mut positioner = Positioner::new(Arc::clone(&index), recipe.clone(), 1);
        let far = Point2::new(200.0, 120.0);
        positioner.hint(PositionHint { point: far, ..hint() }).unwrap();
        let fixes = fixes(&mut positioner, samples().iter().copied());
        let last = fixes.last().unwrap();
        let truth = WORLD.walk.truth(last.time).unwrap() - hint().point + far;
        let error_m = last.position.distance_m(truth);
        assert!(error_m < 12.0, "{}: {error_m:.1} m", recipe.name);
        assert!(last.radius_95_m < 40.0, "{}: {:.1}", recipe.name, last.radius_95_m);
    }
}

#[test]
fn the_past_is_refused() {
    for recipe in recipes() {
        let mut positioner = placed(&recipe);
        fixes(&mut positioner, samples()[..2_000].iter().copied());
        positioner.flush();
        let consumed = samples()[1_999].time;
        let asked = consumed - Duration::from_nanos(1);
        assert_eq!(positioner.fix_at(asked), Err(PositionError::TimeInPast { asked, consumed }));
        assert_eq!(positioner.fix_at(consumed).map(|fix| fix.time), Ok(consumed));
        let forever = positioner.fix_at(Timestamp::MAX).unwrap();
        assert_eq!(forever.mode, Mode::Stale);
        assert_sound(&forever);
        let error = positioner.fix_at(consumed - Duration::from_millis(250)).unwrap_err().to_string();
        assert!(error.contains("250 ms before"), "{error}");
    }
}

#[test]
fn the_time_before_a_hint_is_past() {
    for recipe in recipes() {
        let positioner = placed(&recipe);
        let hinted = hint().time;
        let asked = hinted - Duration::from_nanos(1);
        let refused = Err(PositionError::TimeInPast { asked, consumed: hinted });
        assert_eq!(positioner.fix_at(asked), refused, "nothing is consumed yet");
        assert_eq!(positioner.fix_at(hinted).map(|fix| (fix.time, fix.mode)), Ok((hinted, Mode::Started)));

        // A hint given on the way supersedes what was consumed before it.
        let mut positioner = placed(&recipe);
        fixes(&mut positioner, samples()[..2_000].iter().copied());
        let later = samples()[1_999].time + Duration::from_millis(700);
        positioner.hint(PositionHint { time: later, ..hint() }).unwrap();
        let asked = later - Duration::from_millis(1);
        assert_eq!(positioner.fix_at(asked), Err(PositionError::TimeInPast { asked, consumed: later }));
        assert_eq!(positioner.fix().map(|fix| fix.time), Some(later));
    }
}
