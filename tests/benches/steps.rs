//! What positioning costs: a step of each system, a second of sensors, building and opening a map.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration as Elapsed, Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::Point2;
use fieldwalk::heading::{FusedHeading, FusedHeadingParams, HeadingEstimator};
use fieldwalk::map::{FloorIndex, FloorMap, GridFrame, Layers};
use fieldwalk::observation::radio::RadioObservation;
use fieldwalk::pedestrian::StepEvent;
use fieldwalk::positioner::Positioner;
use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::survey::{SurveyError, SurveyParams, build_floor};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk::tracker::Tracker;
use fieldwalk_formats::{decode_floor, encode_floor};
use fieldwalk_tests::synthetic::{FLOOR_NAME, FLOOR_ORDINAL, Floor};

/// Time of one step, the walk begun anew whenever its steps are used up.
fn steps(criterion: &mut Criterion) {
    let floor = Floor::new(1);
    let index = Arc::new(FloorIndex::new(surveyed(&floor)));
    let walk = floor.round_trip(1).survey_walk("round trip");
    let events: &[StepEvent] = walk.steps();
    let n_transmitters = index.map().transmitters.len() as u32;
    let radio: Vec<RadioObservation> =
        (0..n_transmitters).map(|transmitter| RadioObservation { transmitter, rssi_dbm: -80.0 }).collect();
    let Some(start) = walk.waypoints().first() else { return };
    let mut group = criterion.benchmark_group("step");
    for recipe in [Recipe::fused(), Recipe::mass_centered(), Recipe::dead_reckoning()] {
        let name = format!("{}/{}", recipe.name, recipe.n_particles);
        group.bench_function(name, |bencher| {
            let mut tracker = Tracker::new(recipe.clone(), Arc::clone(&index), 1);
            bencher.iter_custom(|n_steps| {
                let mut elapsed = Elapsed::ZERO;
                for k in 0..n_steps {
                    let at = (k % events.len() as u64) as usize;
                    if at == 0 {
                        tracker.place(start.point, 2.0);
                        // The first step also orients the particles, once a walk: not what is asked here.
                        tracker.step(&events[0], &radio);
                    }
                    let before = Instant::now();
                    tracker.step(black_box(&events[at]), &radio);
                    elapsed += before.elapsed();
                }
                elapsed
            });
        });
    }
    group.finish();
}

/// One second of four sensors at 200 Hz through the reorder window, the level frame and the step detector.
fn front_end(criterion: &mut Criterion) {
    const RATE_HZ: i64 = 200;
    let floor = Floor::new(1);
    let index = Arc::new(FloorIndex::new(surveyed(&floor)));
    let recorded = floor.round_trip(1);
    let last = |kind: fn(&Reading) -> bool| {
        recorded.samples.iter().take(2_000).rev().map(|sample| sample.reading).find(kind)
    };
    let readings = [
        last(|reading| matches!(reading, Reading::AngularRate(_))),
        last(|reading| matches!(reading, Reading::SpecificForce(_))),
        last(|reading| matches!(reading, Reading::UncalibratedMagneticField { .. })),
        Some(Reading::Pressure { pressure_hpa: 1_013.0 }),
    ];
    let mut positioner = Positioner::new(index, Recipe::dead_reckoning(), 1);
    let mut now = recorded.samples[0].time;
    criterion.bench_function("front_end/200 Hz x 4, one second", |bencher| {
        bencher.iter(|| {
            for _ in 0..RATE_HZ {
                now = now + Duration::from_nanos(1_000_000_000 / RATE_HZ);
                for reading in readings.into_iter().flatten() {
                    black_box(positioner.push(Sample { time: now, reading }));
                }
            }
        });
    });
}

/// The same second through the fused heading, which runs beside the front end where it is wanted.
fn heading(criterion: &mut Criterion) {
    const RATE_HZ: i64 = 200;
    let device = |t: f64, amount: f64| {
        let (sin, cos) = libm::sincos(3.0 * t);
        [amount * sin, amount * cos, amount * 0.5 * sin].map(|c| c as f32)
    };
    let mut fused = FusedHeading::new(FusedHeadingParams::default());
    let mut now = Timestamp::from_millis(0);
    criterion.bench_function("heading/200 Hz x 3, one second", |bencher| {
        bencher.iter(|| {
            for k in 0..RATE_HZ {
                now = now + Duration::from_nanos(1_000_000_000 / RATE_HZ);
                let t = k as f64 / RATE_HZ as f64;
                let [x, y, _] = device(t, 2.0);
                for reading in [
                    Reading::AngularRate(device(t, 1.0)),
                    Reading::SpecificForce([x, y, 9.8]),
                    Reading::UncalibratedMagneticField {
                        field_ut: [x + 80.0, 22.0, y - 40.0],
                        bias_ut: [80.0, 0.0, 0.0],
                    },
                ] {
                    fused.push(&Sample { time: now, reading });
                }
            }
            black_box(fused.earth_from_device())
        });
    });
}

fn maps(criterion: &mut Criterion) {
    let floor = Floor::new(1);
    let walks = floor.survey();
    let mut group = criterion.benchmark_group("map");
    group.sample_size(10);
    group.bench_function("build_floor/synthetic 30 m x 20 m", |bencher| {
        let params = SurveyParams::default();
        bencher.iter(|| build_floor(FLOOR_NAME, FLOOR_ORDINAL, floor.plan(), black_box(&walks), &params));
    });
    let mall = mall_floor();
    if let Ok(bytes) = encode_floor(&mall) {
        group.bench_function("open_map/240 m x 176 m", |bencher| {
            bencher.iter(|| decode_floor(black_box(&bytes)).map(FloorIndex::new));
        });
    }
    group.finish();
}

fn surveyed(floor: &Floor) -> FloorMap {
    let map: Result<FloorMap, SurveyError> = floor.surveyed_map();
    map.unwrap_or_default()
}

/// A mall's floor: 240 m × 176 m at half a metre, with an outline and 170 shops.
fn mall_floor() -> FloorMap {
    let (width_m, height_m) = (240.0, 176.0);
    let frame = GridFrame::covering(width_m, height_m, 0.5);
    let mut layers = Layers::default();
    for (name, _) in Layers::default().named() {
        if let Some(layer) = layers.named_mut(name) {
            *layer = (0..frame.len()).map(|node| (node % 977) as f32 * 0.05).collect();
        }
    }
    let shop = |n: u32| {
        let centre = Point2::new(f64::from(n % 17) * 14.0 + 7.0, f64::from(n / 17) * 17.0 + 8.0);
        let ring = (0..8).map(|k| centre + Point2::from_polar(5.0, f64::from(k) * 0.785)).collect();
        Unit { name: format!("shop {n}"), walkable: false, polygon: Polygon { rings: vec![ring] } }
    };
    let outline = [(0.0, 0.0), (width_m, 0.0), (width_m, height_m), (0.0, height_m)];
    let plan = FloorPlan {
        width_m,
        height_m,
        outline: vec![Polygon { rings: vec![outline.map(|(x, y)| Point2::new(x, y)).to_vec()] }],
        units: (0..170).map(shop).collect(),
        ..FloorPlan::default()
    };
    FloorMap { name: "mall".into(), plan, frame, layers, ..FloorMap::default() }
}

criterion_group!(benches, steps, front_end, heading, maps);
criterion_main!(benches);
