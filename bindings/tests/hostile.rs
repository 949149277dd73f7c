//! Whatever bytes and numbers come in: a typed error or a count, and never a panic.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

mod walk;

use std::fs;
use std::sync::LazyLock;

use fieldwalk_ffi::{
    ApiError, BuildingMap, CardDecoder, HintedDirection, MagnetometerCalibrator, Point2, PositionHint,
    Positioner, Recorder, RecordingDetails, RecordingReader, Surveyor, decode_ibeacon,
    decode_ibeacon_manufacturer_data,
};
use proptest::prelude::*;

use walk::{Folder, OFFICE, SURVEYED, batch_of, record};

/// What may happen to bytes on their way.
#[derive(Clone, Debug)]
struct Damage {
    cut_to: f64,
    changes: Vec<(f64, u8)>,
}

fn damage() -> impl Strategy<Value = Damage> {
    let cut_to = prop_oneof![Just(1.0), 0.0..1.0];
    (cut_to, prop::collection::vec((0.0..1.0, any::<u8>()), 0..4))
        .prop_map(|(cut_to, changes)| Damage { cut_to, changes })
}

impl Damage {
    fn done_to(&self, bytes: &[u8]) -> Vec<u8> {
        let at = |share: f64, n: usize| ((n as f64 * share) as usize).min(n.saturating_sub(1));
        let mut damaged = bytes[..(bytes.len() as f64 * self.cut_to) as usize].to_vec();
        for &(share, byte) in &self.changes {
            let at = at(share, damaged.len());
            if let Some(old) = damaged.get_mut(at) {
                *old = byte;
            }
        }
        damaged
    }
}

static BATCH: LazyLock<Vec<u8>> = LazyLock::new(|| batch_of(&OFFICE.walk.samples[..400]));
static MAP: LazyLock<Vec<u8>> = LazyLock::new(|| SURVEYED.export().unwrap());
static RECORDING: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let folder = Folder::new("hostile-source");
    let path = folder.path("walk.mcap");
    record(&path, &OFFICE.walk, 100).finish().unwrap();
    fs::read(path).unwrap()
});

fn of_batch(error: &ApiError) -> bool {
    use ApiError::{BatchMalformed, BatchTooNew, BatchTorn};
    matches!(error, BatchMalformed { .. } | BatchTorn { .. } | BatchTooNew { .. })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_batch_is_refused_by_all_or_taken_by_all(damage in damage()) {
        let batch = damage.done_to(&BATCH);
        let folder = Folder::new("hostile-batch");
        let recorder =
            Recorder::new(folder.path("r.mcap").to_str().unwrap(), RecordingDetails::default()).unwrap();
        let surveyor = Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap();
        surveyor.begin_walk("w".into()).unwrap();
        let positioner = Positioner::new(&SURVEYED, 0, Default::default()).unwrap();
        positioner.hint(OFFICE.walk.hint()).unwrap();
        let calibrator = MagnetometerCalibrator::new();
        let results = [
            recorder.push_samples(&batch),
            surveyor.push_samples(&batch),
            calibrator.push_samples(&batch),
            positioner.push_samples(&batch).map(drop),
        ];
        prop_assert!(results.iter().all(|result| *result == results[0]), "{results:?}");
        if let Err(error) = &results[0] {
            prop_assert!(of_batch(error), "{error}");
            prop_assert_eq!(recorder.status().unwrap().n_samples, 0);
        }
        let faults = positioner.status().batch_faults;
        prop_assert_eq!(recorder.status().unwrap().batch_faults, faults);
        prop_assert_eq!(surveyor.status().unwrap().batch_faults, faults);
        prop_assert_eq!(calibrator.batch_faults().unwrap(), faults);
    }

    #[test]
    fn a_damaged_map_is_refused_or_is_the_same_map(damage in damage()) {
        match BuildingMap::from_file(&damage.done_to(&MAP)) {
            // Changed was a byte that says nothing, or the building's name.
            Ok(map) => prop_assert_eq!(map.floors(), SURVEYED.floors()),
            Err(error) => prop_assert!(
                matches!(
                    error,
                    ApiError::MapMalformed { .. } | ApiError::MapCorrupt { .. } | ApiError::MapTooNew { .. }
                ),
                "{error}"
            ),
        }
    }

    #[test]
    fn a_damaged_recording_gives_parts_and_at_most_one_error(damage in damage()) {
        let folder = Folder::new("hostile-recording");
        let path = folder.path("walk.mcap");
        fs::write(&path, damage.done_to(&RECORDING)).unwrap();
        let of_recording = |error: &ApiError| {
            use ApiError::{RecordingCorrupt, RecordingMalformed, RecordingTooNew};
            matches!(error, RecordingCorrupt { .. } | RecordingMalformed { .. } | RecordingTooNew { .. })
        };
        match RecordingReader::open(path.to_str().unwrap()) {
            Err(error) => prop_assert!(of_recording(&error), "{error}"),
            Ok(reader) => {
                let mut n_errors = 0;
                for _ in 0..100_000 {
                    match reader.next_part(1_000) {
                        Ok(Some(_)) => prop_assert_eq!(n_errors, 0, "a part after an error"),
                        Ok(None) => break,
                        Err(error) => {
                            prop_assert!(of_recording(&error), "{error}");
                            n_errors += 1;
                        }
                    }
                }
                prop_assert!(n_errors <= 1 && reader.next_part(1).unwrap().is_none());
            }
        }
        let surveyor = Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap();
        if let Err(error) = surveyor.add_recording(path.to_str().unwrap(), "w".into()) {
            prop_assert!(of_recording(&error) || matches!(error, ApiError::WrongFloor { .. }), "{error}");
        }
    }

    #[test]
    fn a_hint_is_taken_or_refused_by_its_kind(
        (x_m, y_m, radius_m) in (any::<f64>(), any::<f64>(), any::<f64>()),
        direction in prop::option::of((any::<f64>(), any::<f64>())),
        floor: i32,
        time_ns: i64,
    ) {
        let positioner = Positioner::new(&SURVEYED, 0, Default::default()).unwrap();
        let direction = direction.map(|(heading_rad, sd_rad)| HintedDirection { heading_rad, sd_rad });
        let hint = PositionHint { point: Point2 { x_m, y_m }, radius_m, floor, time_ns, direction };
        match positioner.hint(hint) {
            Ok(()) => prop_assert_eq!(floor, 0),
            Err(ApiError::WrongFloor { .. }) => prop_assert_ne!(floor, 0),
            Err(error) => prop_assert!(matches!(error, ApiError::BadHint { .. }), "{error}"),
        }
        prop_assert!(positioner.fix_at(time_ns).is_ok());
        prop_assert!(positioner.restore(&time_ns.to_le_bytes()).is_err());
    }

    #[test]
    fn an_advertisement_is_read_or_refused_by_its_kind(
        bytes in prop::collection::vec(any::<u8>(), 0..64),
        company_id in prop_oneof![Just(0xffff), Just(0x004c), any::<u16>()],
    ) {
        let decoder = CardDecoder::new();
        let errors = [
            decoder.decode_advertisement(&bytes).map(drop),
            decoder.decode_manufacturer_data(company_id, &bytes).map(drop),
            decode_ibeacon(&bytes).map(drop),
            decode_ibeacon_manufacturer_data(company_id, &bytes).map(drop),
        ];
        for error in errors.into_iter().filter_map(Result::err) {
            use ApiError::{AdvertisementForeign, AdvertisementMalformed, AdvertisementTooNew};
            let is_expected = matches!(
                error,
                AdvertisementForeign { .. } | AdvertisementMalformed { .. } | AdvertisementTooNew { .. }
            );
            prop_assert!(is_expected, "{error}");
        }
    }
}
