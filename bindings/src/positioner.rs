//! The positioner, behind a lock.

use std::convert::Infallible;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use fieldwalk::positioner as core;
use fieldwalk::system::Recipe;
use fieldwalk::time::Timestamp;
use fieldwalk_batch::SampleBatch;

use crate::building_map::BuildingMap;
use crate::error::{ApiError, api_error, locked};
use crate::fix::{Fix, PositionHint};
use crate::missing::{InputWatch, Missing, MissingInput};
use crate::samples::take_each;
use crate::snapshot::Remembered;
use crate::status::{BatchFaults, Status};

/// How a positioner works; the defaults are right for a phone.
#[derive(Clone, Debug, PartialEq, Eq, uniffi::Record)]
pub struct PositionerOptions {
    /// The system to run, one of those that `systems` lists.
    #[uniffi(default = "fused")]
    pub system: String,
    /// The seed of all that is random: the same seed and samples give the same fixes.
    #[uniffi(default = 1)]
    pub seed: u64,
}

impl Default for PositionerOptions {
    fn default() -> Self {
        Self { system: "fused".to_owned(), seed: 1 }
    }
}

/// Follows one wearer on one floor.
///
/// Give it a hint where one is known, and samples as they come; each completed step gives a fix.
#[derive(Debug, uniffi::Object)]
pub struct Positioner {
    state: Mutex<State>,
    /// Whether the system and the map have any use for radio.
    uses_radio: bool,
}

#[derive(Debug)]
struct State {
    positioner: core::Positioner,
    batch_faults: BatchFaults,
    watch: InputWatch,
}

#[uniffi::export]
impl Positioner {
    /// A positioner that has seen nothing, on the floor of `map` with that ordinal.
    ///
    /// # Errors
    /// When the map has no such floor, and when there is no such system.
    #[uniffi::constructor(default(options))]
    pub fn new(map: &BuildingMap, floor: i32, options: PositionerOptions) -> Result<Arc<Self>, ApiError> {
        let PositionerOptions { system, seed } = options;
        let recipe = Recipe::named(&system).ok_or_else(|| {
            api_error!(
                UnknownSystem,
                "there is no system of that name",
                format!("give one of {}", Recipe::NAMES.join(", "))
            )
        })?;
        let floor = map.floor(floor)?;
        let uses_radio = recipe.radio.is_some() && !floor.map().transmitters.is_empty();
        let positioner = core::Positioner::new(floor, recipe, seed);
        let (batch_faults, watch) = (BatchFaults::default(), InputWatch::default());
        let state = Mutex::new(State { positioner, batch_faults, watch });
        Ok(Arc::new(Self { state, uses_radio }))
    }

    /// Starts, or starts anew, from a place that somebody knows.
    ///
    /// # Errors
    /// When the hint is on another floor, or not a place on the plan.
    pub fn hint(&self, hint: PositionHint) -> Result<(), ApiError> {
        Ok(self.lock()?.positioner.hint(hint.into())?)
    }

    /// Takes a batch of samples in and gives a fix for every step that they complete, in order of time.
    ///
    /// A sample is held back until one that is 200 ms younger has come, so that late ones find their place. Bad records
    /// and bad samples are left out and counted in the status.
    ///
    /// # Errors
    /// When `batch` is no sample batch, is torn or is too new; nothing of it is taken in then.
    pub fn push_samples(&self, batch: &[u8]) -> Result<Vec<Fix>, ApiError> {
        let batch = SampleBatch::new(batch)?;
        let mut state = self.lock()?;
        let State { positioner, batch_faults, watch } = &mut *state;
        let mut fixes = Vec::new();
        let Ok(()) = take_each::<Infallible>(&batch, batch_faults, |sample| {
            watch.note(&sample);
            fixes.extend(positioner.push(sample).map(Fix::from));
            Ok(())
        });
        Ok(fixes)
    }

    /// Consumes the samples that still wait for late ones: a recording has ended, or the app goes to sleep.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn flush(&self) -> Result<(), ApiError> {
        self.lock()?.positioner.flush();
        Ok(())
    }

    /// The fix at the last consumed sample; nothing before a hint or a first step.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn fix(&self) -> Result<Option<Fix>, ApiError> {
        Ok(self.lock()?.positioner.fix().map(Fix::from))
    }

    /// The fix at `time_ns`, on the clock of the samples, the open step extrapolated; nothing before a hint or a first
    /// step. It changes nothing, so a display may ask as often as it draws.
    ///
    /// # Errors
    /// When the time is before the last consumed sample.
    pub fn fix_at(&self, time_ns: i64) -> Result<Option<Fix>, ApiError> {
        match self.lock()?.positioner.fix_at(Timestamp::from_nanos(time_ns)) {
            Ok(fix) => Ok(Some(fix.into())),
            Err(core::PositionError::NoFix) => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// All that is remembered, to go on from after a restart; for this version of the library only.
    ///
    /// # Errors
    /// Only after a fault of Fieldwalk itself.
    pub fn snapshot(&self) -> Result<Vec<u8>, ApiError> {
        let state = self.lock()?;
        Remembered::new(state.positioner.snapshot(), state.batch_faults).encode()
    }

    /// Goes on from `snapshot` as if nothing had happened in between.
    ///
    /// # Errors
    /// When the bytes are no snapshot, or one of another version, system, seed or floor; nothing has changed then.
    pub fn restore(&self, snapshot: &[u8]) -> Result<(), ApiError> {
        let remembered = Remembered::decode(snapshot)?;
        let batch_faults = remembered.batch_faults();
        // A restored positioner holds nothing of what a failed call left behind.
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.positioner.restore(remembered.positioner)?;
        state.batch_faults = batch_faults;
        self.state.clear_poison();
        Ok(())
    }

    /// What is missing now and how to mend it; what was left out so far, and why.
    pub fn status(&self) -> Status {
        // Counts are whole numbers at any time, even where a call has failed in the middle.
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let mut missing = state.watch.missing(self.uses_radio);
        if state.positioner.fix().is_none() {
            missing.insert(0, Missing::of(MissingInput::Start));
        }
        Status {
            rejections: state.positioner.rejections().into(),
            batch_faults: state.batch_faults,
            n_recoveries: state.positioner.n_recoveries(),
            missing,
        }
    }
}

impl Positioner {
    fn lock(&self) -> Result<MutexGuard<'_, State>, ApiError> {
        locked(&self.state)
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;
    use crate::fix::Point2;

    fn positioner() -> Arc<Positioner> {
        let plan = fieldwalk::floor_plan::FloorPlan { width_m: 20.0, height_m: 10.0, ..Default::default() };
        let floor = fieldwalk::map::FloorMap { name: "F1".into(), plan, ..Default::default() };
        let file = fieldwalk_formats::encode_floor(&floor).unwrap();
        let map = BuildingMap::from_floor_files("Hall".into(), vec![file]).unwrap();
        Positioner::new(&map, 0, PositionerOptions::default()).unwrap()
    }

    fn hint() -> PositionHint {
        PositionHint {
            point: Point2 { x_m: 3.0, y_m: 4.0 },
            radius_m: 1.0,
            floor: 0,
            time_ns: 5,
            direction: None,
        }
    }

    #[test]
    fn a_call_that_panicked_makes_later_ones_errors_until_a_snapshot_is_restored() {
        let positioner = positioner();
        positioner.hint(hint()).unwrap();
        let (before, snapshot) = (positioner.fix().unwrap(), positioner.snapshot().unwrap());
        assert!(before.is_some());
        let panicked = catch_unwind(AssertUnwindSafe(|| {
            let _guard = positioner.state.lock();
            panic!("in the middle of a call");
        }));
        assert!(panicked.is_err());
        assert!(matches!(positioner.fix(), Err(ApiError::Broken { .. })));
        assert!(matches!(positioner.push_samples(&empty_batch()), Err(ApiError::Broken { .. })));
        assert!(matches!(positioner.hint(hint()), Err(ApiError::Broken { .. })));
        let status = positioner.status();
        assert_eq!((status.rejections, status.batch_faults), Default::default());
        positioner.restore(&snapshot).unwrap();
        assert_eq!(positioner.fix().unwrap(), before);
    }

    fn empty_batch() -> Vec<u8> {
        fieldwalk_batch::SampleBatchWriter::new().finish()
    }

    #[test]
    fn a_snapshot_survives_no_damage_and_no_other_version() {
        let positioner = positioner();
        positioner.hint(hint()).unwrap();
        let snapshot = positioner.snapshot().unwrap();
        for at in (0..snapshot.len()).step_by(101) {
            let mut damaged = snapshot.clone();
            damaged[at] ^= 0x10;
            let refusal = positioner.restore(&damaged).unwrap_err();
            assert!(matches!(refusal, ApiError::SnapshotMalformed { .. }), "{at}: {refusal}");
        }
        let mut other = snapshot[..snapshot.len() - 4].to_vec();
        other[7] = b'9'; // the first digit of the version
        other.extend(crc32fast::hash(&other).to_le_bytes());
        assert!(matches!(positioner.restore(&other), Err(ApiError::SnapshotForeign { .. })));
        positioner.restore(&snapshot).unwrap();
    }

    #[test]
    fn no_error_tells_a_place_or_a_name() {
        let positioner = positioner();
        let off = PositionHint { point: Point2 { x_m: 98_765.4, y_m: 4.0 }, ..hint() };
        let errors = [
            BuildingMap::open("a-secret-folder").unwrap_err(),
            positioner.hint(off).unwrap_err(),
            positioner.hint(PositionHint { floor: 4321, ..hint() }).unwrap_err(),
        ];
        for error in errors {
            let text = error.to_string();
            assert!(text.contains(" (") && text.ends_with(')'), "no remedy: {text}");
            assert!(!["secret", "98765", "4321", "F1"].iter().any(|name| text.contains(name)), "{text}");
        }
    }

    #[test]
    fn fixes_are_those_of_the_core() {
        use fieldwalk::sensor::{Reading, Sample};

        let positioner = positioner();
        positioner.hint(hint()).unwrap();
        let floor = {
            let plan =
                fieldwalk::floor_plan::FloorPlan { width_m: 20.0, height_m: 10.0, ..Default::default() };
            fieldwalk::map::FloorMap { name: "F1".into(), plan, ..Default::default() }
        };
        let index = Arc::new(fieldwalk::map::FloorIndex::new(floor));
        let mut own = core::Positioner::new(index, Recipe::fused(), 1);
        own.hint(hint().into()).unwrap();
        let mut expected = Vec::new();
        let mut writer = fieldwalk_batch::SampleBatchWriter::new();
        for k in 0..2_000_i64 {
            let time = Timestamp::from_millis(10 * k);
            let bounce = if k % 50 < 20 { 4.0 } else { -1.5 };
            for reading in [
                Reading::AngularRate([0.0, 0.0, 0.01]),
                Reading::SpecificForce([0.1, 0.2, 9.81 + bounce]),
                Reading::MagneticField([1.0, 22.0, -42.0]),
            ] {
                let sample = Sample { time, reading };
                expected.extend(own.push(sample).map(Fix::from));
                assert!(writer.push(&sample));
            }
        }
        let fixes = positioner.push_samples(&writer.finish()).unwrap();
        assert!(fixes.len() > 10, "{} fixes", fixes.len());
        assert_eq!(fixes, expected);
        assert_eq!(positioner.fix().unwrap(), own.fix().map(Fix::from));
    }
}
