//! A survey as an app makes it: the map is that of the core, and every slip of a surveyor can be mended.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod walk;

use fieldwalk::sensor::Sample;
use fieldwalk::survey::{SurveyParams, SurveyWalk, Waypoint as CoreWaypoint, build_floor};
use fieldwalk::time::Timestamp;
use fieldwalk_ffi::{
    ApiError, Attitude, BuildingMap, CarryFault, CarryMode, MissingInput, Point2, Positioner, SurveyStatus,
    Surveyor, WalkRefusal, Waypoint,
};
use fieldwalk_sim::phone::CarryMode as Carried;

use walk::{AppWalk, Folder, OFFICE, SURVEYED, batch_of, record, survey};

fn surveyor() -> std::sync::Arc<Surveyor> {
    Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap()
}

fn core_walk(walk: &AppWalk) -> SurveyWalk {
    let mut condensed = SurveyWalk::new("");
    walk.samples.iter().for_each(|sample| condensed.push(sample));
    for waypoint in &walk.waypoints {
        let time = Timestamp::from_nanos(waypoint.time_ns);
        condensed.push_waypoint(CoreWaypoint { time, point: waypoint.point.into() });
    }
    condensed.finish();
    condensed
}

#[test]
fn a_surveyed_map_is_the_core_s_and_positions_a_walk() {
    let walks: Vec<SurveyWalk> = OFFICE.surveys.iter().map(core_walk).collect();
    let plan = fieldwalk_formats::read_plan(&OFFICE.plan).unwrap();
    let floor = build_floor("F1", 0, &plan, &walks, &SurveyParams::default()).unwrap();
    let building = fieldwalk::map::BuildingMap { name: "office".into(), floors: vec![floor] };
    let file = SURVEYED.export().unwrap();
    assert!(file == fieldwalk_formats::pack_building(&building).unwrap(), "another map");

    // As one file and as a folder it is the same, and a walk is followed on it.
    let folder = Folder::new("survey-map");
    SURVEYED.save(folder.path("office.map").to_str().unwrap()).unwrap();
    std::fs::write(folder.path("office.tar"), &file).unwrap();
    let open = |name: &str| BuildingMap::open(folder.path(name).to_str().unwrap()).unwrap();
    let opened =
        [SURVEYED.clone(), BuildingMap::from_file(&file).unwrap(), open("office.map"), open("office.tar")];
    let fixes = opened.map(|map| {
        let positioner = Positioner::new(&map, 0, Default::default()).unwrap();
        positioner.hint(OFFICE.walk.hint()).unwrap();
        positioner.push_samples(&batch_of(&OFFICE.walk.samples)).unwrap()
    });
    assert!(fixes[0].len() > 30, "{} fixes", fixes[0].len());
    assert!(fixes.iter().all(|others| *others == fixes[0]));
    let Point2 { x_m, y_m } = fixes[0][fixes[0].len() - 1].position;
    let Some(Waypoint { point: truth, .. }) = OFFICE.walk.waypoints.last() else { panic!("no waypoint") };
    assert!((x_m - truth.x_m).hypot(y_m - truth.y_m) < 4.0, "{x_m} {y_m} {truth:?}");
}

#[test]
fn coverage_grows_while_a_line_is_walked_and_shrinks_when_its_end_is_taken_back() {
    let surveyor = surveyor();
    let covered = || surveyor.coverage().unwrap().totals.covered_m2;
    surveyor.begin_walk("one line".into()).unwrap();
    let tap = |time_ns, x_m, y_m| surveyor.push_waypoint(Waypoint { time_ns, point: Point2 { x_m, y_m } });
    tap(1_000_000_000, 4.0, 4.0).unwrap();
    assert_eq!(covered(), 0.0);
    tap(9_000_000_000, 12.0, 4.0).unwrap();
    let one_line = surveyor.coverage().unwrap();
    assert!(one_line.totals.covered_m2 > 8.0 && one_line.totals.route_m == 8.0, "{:?}", one_line.totals);
    assert_eq!(one_line.nodes.len(), (one_line.n_columns * one_line.n_rows) as usize);
    let n_covered = one_line.nodes.iter().filter(|&&node| node == 2).count();
    assert_eq!(n_covered as f64 * one_line.cell_m.powi(2), one_line.totals.covered_m2);

    tap(15_000_000_000, 12.0, 12.0).unwrap();
    assert!(covered() > one_line.totals.covered_m2);
    let taken_back = surveyor.undo_waypoint().unwrap().unwrap();
    assert_eq!(taken_back, Waypoint { time_ns: 15_000_000_000, point: Point2 { x_m: 12.0, y_m: 12.0 } });
    assert_eq!(surveyor.coverage().unwrap(), one_line);
    assert_eq!(surveyor.status().unwrap().last_waypoint.unwrap().time_ns, 9_000_000_000);

    // After a pause nothing leads back to before it.
    surveyor.pause().unwrap();
    assert!(matches!(tap(16_000_000_000, 4.0, 12.0), Err(ApiError::OutOfTurn { .. })));
    surveyor.resume().unwrap();
    tap(20_000_000_000, 16.0, 12.0).unwrap();
    assert_eq!(surveyor.coverage().unwrap(), one_line);
    assert_eq!(surveyor.undo_waypoint().unwrap().unwrap().time_ns, 20_000_000_000);
    assert_eq!(surveyor.undo_waypoint().unwrap(), None);

    // Nobody walked, so the map has no use for it.
    let report = surveyor.end_walk().unwrap();
    assert!(!report.is_used && report.remedy.contains("walk between"), "{report:?}");
    assert_eq!(report.refusal, Some(WalkRefusal::NoSteps));
    surveyor.begin_walk("no line".into()).unwrap();
    assert_eq!(surveyor.end_walk().unwrap().refusal, Some(WalkRefusal::NoWaypoints));
    assert_eq!(covered(), 0.0);
}

#[test]
fn a_pause_costs_the_line_that_it_interrupts_and_no_other() {
    let walk = OFFICE.surveys.iter().max_by_key(|walk| walk.waypoints.len()).unwrap();
    let [first, second, third, ..] = walk.waypoints[..] else { panic!("{} waypoints", walk.waypoints.len()) };
    let surveyor = surveyor();
    surveyor.begin_walk("interrupted".into()).unwrap();
    let until = |ns: i64| walk.samples.partition_point(|sample| sample.time.as_nanos() <= ns);
    let (line_end, pause_end) = (until(second.time_ns), until(third.time_ns));
    surveyor.push_samples(&batch_of(&walk.samples[..line_end])).unwrap();
    surveyor.push_waypoint(first).unwrap();
    surveyor.push_waypoint(second).unwrap();
    surveyor.pause().unwrap();
    surveyor.push_samples(&batch_of(&walk.samples[line_end..pause_end])).unwrap();
    assert!(surveyor.status().unwrap().is_paused);
    surveyor.resume().unwrap();
    surveyor.push_waypoint(third).unwrap();
    surveyor.push_samples(&batch_of(&walk.samples[pause_end..])).unwrap();
    let report = surveyor.end_walk().unwrap();
    assert!(report.is_used && report.refusal.is_none() && report.n_steps > 3, "{report:?}");
    let line_m = (first.point.x_m - second.point.x_m).hypot(first.point.y_m - second.point.y_m);
    let coverage = surveyor.coverage().unwrap();
    assert!((coverage.totals.route_m - line_m).abs() < 1e-9, "{:?}", coverage.totals);
    let map = surveyor.build().unwrap();
    assert!((map.coverage().route_m - line_m).abs() < 1e-9, "{:?}", map.coverage());
}

#[test]
fn expected_accuracy_takes_two_walks_and_states_errors_of_metres() {
    let surveyor = surveyor();
    survey(&surveyor, &OFFICE.surveys[0], 1_000);
    assert_eq!(surveyor.build().unwrap().expected_accuracy(), None);
    for walk in &OFFICE.surveys[1..] {
        survey(&surveyor, walk, 1_000);
    }
    let floor = surveyor.build().unwrap();
    let accuracy = floor.expected_accuracy().unwrap();
    assert!((0.01..5.0).contains(&accuracy.median_m), "{}", accuracy.median_m);
    assert!(accuracy.median_m <= accuracy.p80_m && accuracy.p80_m <= accuracy.p90_m);
    let n_taps: usize = OFFICE.surveys.iter().map(|walk| walk.waypoints.len()).sum();
    assert!(accuracy.places.len() > n_taps / 3 && accuracy.places.len() < n_taps);
    let totals = floor.coverage();
    assert!(totals.covered_m2 > 0.8 * totals.open_m2 && totals.route_m > 50.0, "{totals:?}");

    // The last walk goes as it came.
    let n = surveyor.status().unwrap().n_walks;
    assert_eq!(surveyor.undo_walk().unwrap().as_deref(), Some("a walk"));
    assert_eq!(surveyor.status().unwrap().n_walks, n - 1);
}

#[test]
fn recordings_give_the_map_of_the_live_survey_even_after_a_crash() {
    let folder = Folder::new("survey-recordings");
    let (live, after_crash) = (surveyor(), surveyor());
    for (k, walk) in OFFICE.surveys.iter().enumerate() {
        survey(&live, walk, 57);
        let path = folder.path(&format!("{k}.mcap"));
        record(&path, walk, 57).flush().unwrap(); // and never finished
        assert!(after_crash.add_recording(path.to_str().unwrap(), "a walk".into()).unwrap().is_used);
    }
    let file = |surveyor: &Surveyor| {
        BuildingMap::of_survey("x".into(), vec![surveyor.build().unwrap()]).unwrap().export().unwrap()
    };
    assert!(file(&live) == file(&after_crash));
}

#[test]
fn what_does_not_fit_is_refused_and_changes_nothing() {
    let surveyor = surveyor();
    let out_of_turn = |result: Result<(), ApiError>| matches!(result, Err(ApiError::OutOfTurn { .. }));
    let tap = |time_ns, x_m| Waypoint { time_ns, point: Point2 { x_m, y_m: 4.0 } };
    let batch = batch_of(&OFFICE.walk.samples[..50]);
    assert!(out_of_turn(surveyor.push_samples(&batch)));
    assert!(out_of_turn(surveyor.push_waypoint(tap(0, 1.0))));
    assert!(out_of_turn(surveyor.pause()) && out_of_turn(surveyor.resume()));
    assert!(out_of_turn(surveyor.end_walk().map(drop)) && out_of_turn(surveyor.discard_walk().map(drop)));
    assert_eq!(surveyor.undo_walk().unwrap(), None);
    surveyor.begin_walk("w".into()).unwrap();
    assert!(out_of_turn(surveyor.begin_walk("v".into())) && out_of_turn(surveyor.resume()));
    surveyor.push_waypoint(tap(10, 1.0)).unwrap();
    for bad in [tap(10, 2.0), tap(9, 2.0), tap(20, -1.0), tap(20, f64::NAN), tap(20, 1e9)] {
        assert!(matches!(surveyor.push_waypoint(bad), Err(ApiError::BadWaypoint { .. })), "{bad:?}");
    }
    assert_eq!(surveyor.status().unwrap().last_waypoint, Some(tap(10, 1.0)));
    let missing = surveyor.status().unwrap().missing;
    assert_eq!(missing.iter().map(|missing| missing.what).collect::<Vec<_>>(), [MissingInput::Samples]);
    assert_eq!(surveyor.discard_walk().unwrap(), "w");
    assert!(matches!(surveyor.build(), Err(ApiError::SurveyIncomplete { .. })));
    assert!(matches!(BuildingMap::of_survey("x".into(), vec![]), Err(ApiError::SurveyIncomplete { .. })));

    for plan in [&b"{}"[..], b"", b"\xff\xff", br#"{"type":"FeatureCollection","features":[]}"#] {
        assert!(matches!(Surveyor::new(plan, "F1".into(), 0), Err(ApiError::PlanMalformed { .. })));
    }
    let folder = Folder::new("survey-refusals");
    let missing = surveyor.add_recording(folder.path("none").to_str().unwrap(), "w".into());
    assert!(matches!(missing, Err(ApiError::RecordingNotFound { .. })));
    let path = folder.path("f1.mcap");
    record(&path, &OFFICE.walk, 100).finish().unwrap();
    let upstairs = Surveyor::new(&OFFICE.plan, "F2".into(), 1).unwrap();
    let refusal = upstairs.add_recording(path.to_str().unwrap(), "w".into());
    assert!(matches!(refusal, Err(ApiError::WrongFloor { .. })), "{refusal:?}");
}

/// What the survey says of every second of a walk.
fn statuses(walk: &AppWalk) -> Vec<SurveyStatus> {
    let surveyor = surveyor();
    surveyor.begin_walk("carried".into()).unwrap();
    assert_eq!(surveyor.status().unwrap().attitude, Attitude::Unknown);
    let second = |sample: &Sample| sample.time.as_nanos() / 1_000_000_000;
    let seconds = walk.samples.chunk_by(|a, b| second(a) == second(b));
    let status = |samples: &[Sample]| {
        surveyor.push_samples(&batch_of(samples)).unwrap();
        surveyor.status().unwrap()
    };
    seconds.map(status).collect()
}

fn warned(status: &SurveyStatus) -> Option<CarryFault> {
    status.carry_warning.as_ref().map(|warning| warning.what)
}

#[test]
fn a_phone_held_level_is_never_warned_of() {
    for walk in &OFFICE.surveys {
        let statuses = statuses(walk);
        assert_eq!(statuses.iter().find_map(warned), None);
        let walking = &statuses[statuses.len() / 2];
        assert_eq!(walking.attitude, Attitude::UpwardForwardHorizontal);
        assert_eq!(walking.carry_mode, CarryMode::HeldUp);
    }
}

#[test]
fn every_other_way_to_carry_a_phone_is_warned_of() {
    let expected = [
        (Carried::SwingingHand, CarryFault::NotHeld),
        (Carried::FrontPocket, CarryFault::NotHeld),
        (Carried::BackPocket, CarryFault::NotHeld),
        (Carried::AtEar, CarryFault::NotHeld),
        (Carried::HeldLandscape, CarryFault::NotForward),
        (Carried::HeldUpright, CarryFault::NotUpward),
    ];
    for (carried, fault) in expected {
        let statuses = statuses(&OFFICE.carried(&[(0.0, carried)]));
        let whats: Vec<Option<CarryFault>> = statuses.iter().map(warned).collect();
        let n = whats.iter().filter(|what| **what == Some(fault)).count();
        assert!(2 * n > statuses.len(), "{carried:?}: {whats:?}");
    }
}

#[test]
fn the_warning_goes_when_the_phone_is_held_again() {
    let carrying = [(0.0, Carried::HeldLevel), (6.0, Carried::FrontPocket), (13.0, Carried::HeldLevel)];
    let statuses = statuses(&OFFICE.carried(&carrying));
    let whats: Vec<Option<CarryFault>> = statuses.iter().map(warned).collect();
    assert!(whats[..6].iter().all(Option::is_none) && whats[11..13].iter().all(Option::is_some), "{whats:?}");
    assert!(whats[18..].iter().all(Option::is_none), "{whats:?}");
    let warning = statuses[12].carry_warning.as_ref().unwrap();
    assert!(!warning.explanation.is_empty() && warning.remedy.contains("level"), "{warning:?}");
}
