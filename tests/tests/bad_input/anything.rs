//! Anything at all, in any order.

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::geometry::Point2;
use fieldwalk::positioner::{HintedDirection, PositionHint};
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::survey::{SurveyParams, SurveyWalk, Waypoint, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_tests::synthetic::{FLOOR_ORDINAL, WALK_START};
use proptest::prelude::*;

use crate::{WORLD, fresh, is_sound, placed};

fn any_component() -> impl Strategy<Value = f32> {
    prop_oneof![
        4 => -50.0f32..50.0,
        1 => any::<f32>(),
        1 => proptest::sample::select(vec![0.0, f32::NAN, f32::INFINITY, 1e-40, 2_000.0, -10_000.0, 200.0]),
    ]
}

fn any_vector() -> impl Strategy<Value = [f32; 3]> {
    [any_component(), any_component(), any_component()]
}

fn any_reading() -> impl Strategy<Value = Reading> {
    let known = WORLD.index.map().transmitters[0].id;
    prop_oneof![
        4 => any_vector().prop_map(Reading::SpecificForce),
        2 => any_vector().prop_map(Reading::AngularRate),
        1 => any_vector().prop_map(Reading::MagneticField),
        2 => (any_vector(), any_vector())
            .prop_map(|(field_ut, bias_ut)| Reading::UncalibratedMagneticField { field_ut, bias_ut }),
        1 => any_component().prop_map(|pressure_hpa| Reading::Pressure { pressure_hpa }),
        1 => (any_component(), any::<bool>()).prop_map(move |(rssi_dbm, is_known)| {
            let transmitter = if is_known { known } else { TransmitterId::WifiBssid([7; 6]) };
            Reading::Radio(RadioSighting { transmitter, rssi_dbm })
        }),
    ]
}

/// What happens next: a sample of the walk, perhaps spoilt, or something from nowhere.
#[derive(Clone, Debug)]
enum Happening {
    Walk(usize),
    Spoilt(usize, Reading),
    Shifted(usize, i64),
    Nonsense(Timestamp, Reading),
    Hint(PositionHint),
    Flush,
}

fn any_happening() -> impl Strategy<Value = Happening> {
    let any_coordinate = || prop_oneof![3 => -5.0f64..35.0, 1 => any::<f64>()];
    let any_hint = (any_coordinate(), any_coordinate(), prop_oneof![0.1f64..5.0, any::<f64>()], any::<i64>());
    prop_oneof![
        12 => (1usize..200).prop_map(Happening::Walk),
        3 => (1usize..20, any_reading()).prop_map(|(n, reading)| Happening::Spoilt(n, reading)),
        2 => (1usize..100, -70_000i64..70_000).prop_map(|(n, ms)| Happening::Shifted(n, ms)),
        2 => (any::<i64>(), any_reading())
            .prop_map(|(ns, reading)| Happening::Nonsense(Timestamp::from_nanos(ns), reading)),
        1 => any_hint.prop_map(|(x_m, y_m, radius_m, ns)| Happening::Hint(PositionHint {
            point: Point2::new(x_m, y_m),
            radius_m,
            floor: FLOOR_ORDINAL,
            time: Timestamp::from_nanos(ns),
            // Any number is some direction or none.
            direction: (ns % 2 == 0).then_some(HintedDirection { heading_rad: x_m, sd_rad: radius_m }),
        })),
        1 => Just(Happening::Flush),
    ]
}

fn small(name: &str) -> Recipe {
    Recipe { n_particles: 60, ..Recipe::named(name).unwrap() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happens_fixes_are_sound(
        happenings in proptest::collection::vec(any_happening(), 1..40),
        name in proptest::sample::select(Recipe::NAMES.to_vec()),
        asked_ns in any::<i64>(),
    ) {
        let mut positioner = fresh(&small(name));
        let mut walk = WORLD.walk.samples.iter().copied();
        let mut n_pushed = 0;
        for happening in happenings {
            let (n, change): (usize, Box<dyn Fn(Sample) -> Sample>) = match happening {
                Happening::Walk(n) => (n, Box::new(|sample| sample)),
                Happening::Spoilt(n, reading) => (n, Box::new(move |sample| Sample { reading, ..sample })),
                Happening::Shifted(n, ms) => {
                    (n, Box::new(move |s| Sample { time: s.time + Duration::from_millis(ms), ..s }))
                }
                Happening::Nonsense(time, reading) => (1, Box::new(move |_| Sample { time, reading })),
                Happening::Hint(hint) => {
                    let _ = positioner.hint(hint);
                    continue;
                }
                Happening::Flush => {
                    positioner.flush();
                    continue;
                }
            };
            for sample in walk.by_ref().take(n).map(change) {
                n_pushed += 1;
                let fix = positioner.push(sample);
                prop_assert!(fix.as_ref().is_none_or(is_sound), "{fix:?}");
            }
            if let Some(fix) = positioner.fix() {
                prop_assert!(is_sound(&fix), "{fix:?}");
            }
        }
        prop_assert!(positioner.rejections().total() <= n_pushed);
        if let Ok(fix) = positioner.fix_at(Timestamp::from_nanos(asked_ns)) {
            prop_assert!(is_sound(&fix), "{fix:?}");
        }
    }

    #[test]
    fn nonsense_alone_never_falls(
        nonsense in proptest::collection::vec((any_reading(), 0i64..300), 1..300),
        name in proptest::sample::select(Recipe::NAMES.to_vec()),
    ) {
        let mut positioner = placed(&small(name));
        let mut survey = SurveyWalk::new("nonsense");
        let mut time = WALK_START;
        for (reading, after_ms) in nonsense {
            time = time + Duration::from_millis(after_ms);
            let sample = Sample { time, reading };
            survey.push(&sample);
            let fix = positioner.push(sample);
            prop_assert!(fix.as_ref().is_none_or(is_sound), "{fix:?}");
        }
        survey.finish();
        survey.push_waypoint(Waypoint { time: WALK_START, point: Point2::new(1.0, 1.0) });
        survey.push_waypoint(Waypoint { time: WALK_START + Duration::from_millis(100_000), point: Point2::new(9.0, 1.0) });
        let small = FloorPlan { width_m: 10.0, height_m: 3.0, ..FloorPlan::default() };
        if let Ok(map) = build_floor("nonsense", 0, &small, &[survey], &SurveyParams::default()) {
            for (name, layer) in map.layers.named() {
                prop_assert!(layer.iter().all(|value| value.is_finite()), "{name}");
            }
        }
    }
}
