//! Bytes from an app at the entries of the library for other languages: batches, maps, snapshots, plans, advertisements.
//! Each is taken or refused by a case of its kind; a refusal changes nothing; all that take batches agree on them.
#![no_main]

use std::sync::{Arc, LazyLock};

use fieldwalk::floor_plan::FloorPlan;
use fieldwalk::map::FloorMap;
use fieldwalk_ffi::{
    ApiError, BuildingMap, CardDecoder, MagnetometerCalibrator, Point2, PositionHint, Positioner, Surveyor,
    decode_ibeacon,
};
use libfuzzer_sys::fuzz_target;

const PLAN: &[u8] = br#"{ "type": "FeatureCollection", "fieldwalk": { "frame": "metres" }, "features": [{
    "type": "Feature", "properties": { "kind": "outline" },
    "geometry": { "type": "Polygon", "coordinates": [[[0, 0], [20, 0], [20, 20], [0, 20], [0, 0]]] } }] }"#;

static MAP: LazyLock<Arc<BuildingMap>> = LazyLock::new(|| {
    let plan = FloorPlan { width_m: 20.0, height_m: 20.0, ..FloorPlan::default() };
    let floor = FloorMap { name: "F1".into(), plan, ..FloorMap::default() };
    let file = fieldwalk_formats::encode_floor(&floor).expect("a floor can be written");
    BuildingMap::from_floor_files("Hall".into(), vec![file]).expect("what was written can be read")
});

fuzz_target!(|bytes: &[u8]| {
    let positioner = positioner();
    let before = positioner.fix();
    let taken = positioner.push_samples(bytes);
    if let Err(error) = &taken {
        use ApiError::{BatchMalformed, BatchTooNew, BatchTorn};
        assert!(matches!(error, BatchMalformed { .. } | BatchTorn { .. } | BatchTooNew { .. }), "{error}");
        assert_eq!(positioner.fix(), before);
        assert_eq!(positioner.status().rejections, Default::default());
    }
    let taken = taken.map(drop);
    let calibrator = MagnetometerCalibrator::new();
    assert_eq!(calibrator.push_samples(bytes), taken);
    assert_eq!(calibrator.batch_faults(), Ok(positioner.status().batch_faults));
    let _ = calibrator.verdict();
    let surveyor = Surveyor::new(PLAN, "F1".into(), 0).expect("the plan is one");
    surveyor.begin_walk("w".into()).expect("the first walk");
    assert_eq!(surveyor.push_samples(bytes), taken);
    surveyor.end_walk().expect("a walk has begun");

    let before = positioner.fix();
    if let Err(error) = positioner.restore(bytes) {
        use ApiError::{SnapshotForeign, SnapshotMalformed};
        assert!(matches!(error, SnapshotForeign { .. } | SnapshotMalformed { .. }), "{error}");
        assert_eq!(positioner.fix(), before);
    }
    if let Err(error) = BuildingMap::from_file(bytes) {
        use ApiError::{MapCorrupt, MapMalformed, MapTooNew};
        assert!(matches!(error, MapCorrupt { .. } | MapMalformed { .. } | MapTooNew { .. }), "{error}");
    }
    if let Err(error) = Surveyor::new(bytes, "F1".into(), 0) {
        assert!(matches!(error, ApiError::PlanMalformed { .. }), "{error}");
    }
    for error in [CardDecoder::new().decode_advertisement(bytes).err(), decode_ibeacon(bytes).err()] {
        use ApiError::{AdvertisementForeign, AdvertisementMalformed, AdvertisementTooNew};
        assert!(matches!(
            error,
            None | Some(
                AdvertisementForeign { .. } | AdvertisementMalformed { .. } | AdvertisementTooNew { .. }
            )
        ));
    }
});

/// A positioner that knows where it is.
fn positioner() -> Arc<Positioner> {
    let positioner = Positioner::new(&MAP, 0, Default::default()).expect("the floor is there");
    let point = Point2 { x_m: 3.0, y_m: 4.0 };
    let hint = PositionHint { point, radius_m: 1.0, floor: 0, time_ns: 0, direction: None };
    positioner.hint(hint).expect("the place is on the plan");
    positioner
}
