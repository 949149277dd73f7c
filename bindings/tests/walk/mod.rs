//! A small simulated building, its survey and a walk there, as an app would push them.
#![allow(dead_code, reason = "every test file uses a part")]

use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use fieldwalk::sensor::Sample;
use fieldwalk_batch::SampleBatchWriter;
use fieldwalk_ffi::{BuildingMap, PositionHint, Recorder, RecordingDetails, Surveyor, Waypoint};
use fieldwalk_sim::building::{Aisle, GridBuilding};
use fieldwalk_sim::magnetic_field::SteelParams;
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_sim::scenario::{Recorded, Scenario, Walk};

/// A walk as an app records it.
pub struct AppWalk {
    pub samples: Vec<Sample>,
    pub waypoints: Vec<Waypoint>,
}

/// A ring of corridors: its plan in GeoJSON, the walks that survey it, and one more.
pub struct Office {
    pub plan: Vec<u8>,
    pub surveys: Vec<AppWalk>,
    pub walk: AppWalk,
    scenario: Scenario,
}

pub static OFFICE: LazyLock<Office> = LazyLock::new(|| {
    let aisle = |centre_m| Aisle { centre_m, width_m: 1.6 };
    let building = GridBuilding {
        width_m: 20.0,
        height_m: 16.0,
        columns: vec![aisle(4.0), aisle(16.0)],
        rows: vec![aisle(4.0), aisle(12.0)],
        halls: Vec::new(),
        lifts: Vec::new(),
        ..GridBuilding::office()
    };
    let scenario = Scenario::of_building(building.build(), &SteelParams::default(), 5);
    let recorded = |walk| AppWalk::from(scenario.simulate(walk));
    Office {
        plan: fieldwalk_formats::write_plan(&scenario.building.plan).into_bytes(),
        surveys: scenario.survey_walks().iter().map(recorded).collect(),
        walk: recorded(&scenario.test_walks(1, 30.0)[0]),
        scenario,
    }
});

impl Office {
    /// The longest survey walk again, the phone carried from so many seconds on in each way.
    pub fn carried(&self, carrying: &[(f64, CarryMode)]) -> AppWalk {
        let walks = self.scenario.survey_walks();
        let length_m =
            |walk: &Walk| walk.path.windows(2).map(|pair| pair[0].distance_m(pair[1])).sum::<f64>();
        let longest = walks.iter().max_by(|a, b| length_m(a).total_cmp(&length_m(b))).unwrap();
        AppWalk::from(self.scenario.simulate(&Walk { carrying: carrying.to_vec(), ..longest.clone() }))
    }
}

/// The office, surveyed.
pub static SURVEYED: LazyLock<Arc<BuildingMap>> = LazyLock::new(|| {
    let surveyor = Surveyor::new(&OFFICE.plan, "F1".into(), 0).unwrap();
    for walk in &OFFICE.surveys {
        survey(&surveyor, walk, 100);
    }
    BuildingMap::of_survey("office".into(), vec![surveyor.build().unwrap()]).unwrap()
});

impl From<Recorded> for AppWalk {
    fn from(recorded: Recorded) -> Self {
        let waypoints = recorded
            .waypoints
            .iter()
            .map(|waypoint| Waypoint { time_ns: waypoint.time.as_nanos(), point: waypoint.point.into() });
        Self { waypoints: waypoints.collect(), samples: recorded.samples }
    }
}

impl AppWalk {
    /// Batches of `n` samples, and each waypoint once the samples of its time have been given.
    pub fn replay(&self, n: usize, mut take: impl FnMut(Event<'_>)) {
        let mut waypoints = self.waypoints.iter().peekable();
        for samples in self.samples.chunks(n) {
            take(Event::Batch(&batch_of(samples)));
            let until_ns = samples[samples.len() - 1].time.as_nanos();
            while let Some(waypoint) = waypoints.next_if(|waypoint| waypoint.time_ns <= until_ns) {
                take(Event::Waypoint(*waypoint));
            }
        }
        waypoints.for_each(|waypoint| take(Event::Waypoint(*waypoint)));
    }

    /// The start, known to 2 m.
    pub fn hint(&self) -> PositionHint {
        let Waypoint { time_ns, point } = self.waypoints[0];
        PositionHint { point, radius_m: 2.0, floor: 0, time_ns, direction: None }
    }
}

pub enum Event<'a> {
    Batch(&'a [u8]),
    Waypoint(Waypoint),
}

pub fn batch_of(samples: &[Sample]) -> Vec<u8> {
    let mut writer = SampleBatchWriter::new();
    assert!(samples.iter().all(|sample| writer.push(sample)));
    writer.finish()
}

/// Walks `walk`, in batches of `n`.
pub fn survey(surveyor: &Surveyor, walk: &AppWalk, n: usize) {
    surveyor.begin_walk("a walk".into()).unwrap();
    walk.replay(n, |event| match event {
        Event::Batch(batch) => surveyor.push_samples(batch).unwrap(),
        Event::Waypoint(waypoint) => surveyor.push_waypoint(waypoint).unwrap(),
    });
    assert!(surveyor.end_walk().unwrap().is_used);
}

/// Records `walk` in a new file at `path`, in batches of `n`.
pub fn record(path: &std::path::Path, walk: &AppWalk, n: usize) -> Arc<Recorder> {
    let details =
        RecordingDetails { device: "a phone".into(), floor: "F1".into(), ..RecordingDetails::default() };
    let recorder = Recorder::new(path.to_str().unwrap(), details).unwrap();
    walk.replay(n, |event| match event {
        Event::Batch(batch) => recorder.push_samples(batch).unwrap(),
        Event::Waypoint(waypoint) => recorder.push_waypoint(waypoint).unwrap(),
    });
    recorder
}

/// A folder of its own, removed at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("fieldwalk-ffi-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub fn path(&self, file: &str) -> PathBuf {
        self.0.join(file)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
