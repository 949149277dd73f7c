//! The trials of a folder: who carried which phone, how, and among which iron.

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::sensor::{Reading, Sample};

use super::log::{LogKind, Platform, SensorLogReader};
use super::truth::Truth;
use crate::error::FormatError;
use crate::ilc::LineRejections;

/// How the phone was carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Motion {
    /// Held up in front of the eyes, upright, as a camera.
    AugmentedReality,
    /// Held in front of the chest, the screen to the eyes.
    Texting,
    /// At the ear.
    Phoning,
    /// In a hand that swings.
    Swinging,
    /// In a front pocket of the trousers.
    FrontPocket,
    /// In a back pocket of the trousers.
    BackPocket,
    /// Running, in the hand.
    RunningInHand,
    /// Running, in a pocket.
    RunningInPocket,
}

/// One person's walk of about two minutes with one phone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trial {
    /// `PERSON_PHONE_(Dist|NoDist)_MOTION`, as its folder is called.
    pub name: String,
    /// Who walked.
    pub person: String,
    /// The phone's model.
    pub phone: String,
    /// The phone's system.
    pub platform: Platform,
    /// How it was carried.
    pub motion: Motion,
    /// Whether magnets and iron were brought near on purpose.
    pub is_disturbed: bool,
    /// The folder of the phone's logs.
    pub folder: PathBuf,
    /// The capture.
    pub capture: PathBuf,
}

/// What a folder holds.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trials {
    /// The trials, by name.
    pub trials: Vec<Trial>,
    /// Folders whose name is not understood; calibrations are not among them.
    pub foreign: Vec<PathBuf>,
}

/// What the phone said during a trial.
#[derive(Clone, Debug)]
pub struct TrialSamples {
    /// Angular rates, specific forces and fields in order of time, on the clock of the capture: the first seconds may
    /// be negative. From iOS come both the corrected field and the raw one, whose bias is by how much it differs from
    /// the corrected field before it.
    pub samples: Vec<Sample>,
    /// The lines left out, of all logs.
    pub n_rejected: u64,
}

/// Lists the trials of the benchmark's folder `root`, or of the folders in it that hold `qualisys/`.
///
/// # Errors
/// When a folder cannot be read, or when there is no trial.
pub fn find_trials(root: &Path) -> Result<Trials, FormatError> {
    let mut found = Trials::default();
    let mut roots = vec![root.to_owned()];
    if !root.join("qualisys").is_dir() {
        roots = folders(root)?.into_iter().filter(|folder| folder.join("qualisys").is_dir()).collect();
    }
    for root in &roots {
        for (platform, name) in [(Platform::Android, "android"), (Platform::Ios, "ios")] {
            let logs = root.join(name);
            if !logs.is_dir() {
                continue;
            }
            for folder in folders(&logs)? {
                match Trial::of_folder(&folder, platform, &root.join("qualisys")) {
                    Some(trial) => found.trials.push(trial),
                    None if is_calibration(&folder) => {}
                    None => found.foreign.push(folder),
                }
            }
        }
    }
    found.trials.sort_by(|a, b| a.name.cmp(&b.name));
    if found.trials.is_empty() {
        return Err(FormatError::malformed(
            "no trial of the attitude benchmark",
            "give the folder that holds android/, ios/ and qualisys/, with logs such as \
             android/PERSON_PHONE_NoDist_Texting/accelerometer.txt",
        )
        .at_path(root));
    }
    Ok(found)
}

/// iOS does not say its bias: it is the raw field less the latest corrected one. Raw fields before any corrected one
/// are left out.
fn tell_bias(samples: &mut Vec<Sample>) {
    let mut corrected_ut = None;
    samples.retain_mut(|sample| match &mut sample.reading {
        Reading::MagneticField(field_ut) => {
            corrected_ut = Some(*field_ut);
            true
        }
        Reading::UncalibratedMagneticField { field_ut, bias_ut } => {
            let Some(corrected_ut) = corrected_ut else { return false };
            *bias_ut = [0, 1, 2].map(|c| field_ut[c] - corrected_ut[c]);
            true
        }
        _ => true,
    });
}

impl Motion {
    /// Every motion.
    pub const ALL: [Self; 8] = [
        Self::AugmentedReality,
        Self::Texting,
        Self::Phoning,
        Self::Swinging,
        Self::FrontPocket,
        Self::BackPocket,
        Self::RunningInHand,
        Self::RunningInPocket,
    ];

    /// Its name in the folders' names.
    pub fn name(self) -> &'static str {
        match self {
            Self::AugmentedReality => "AR",
            Self::Texting => "Texting",
            Self::Phoning => "Phoning",
            Self::Swinging => "Swinging",
            Self::FrontPocket => "FrontPocket",
            Self::BackPocket => "BackPocket",
            Self::RunningInHand => "RunningHand",
            Self::RunningInPocket => "RunningPocket",
        }
    }
}

impl Trial {
    /// Reads the phone's logs.
    ///
    /// # Errors
    /// When a log or the alignment of the clocks is missing or foreign.
    pub fn samples(&self) -> Result<TrialSamples, FormatError> {
        let capture_from_phone_s = self.capture_from_phone_s()?;
        let mut samples = Vec::new();
        let mut n_rejected = 0;
        let mut kinds = LogKind::ALL.to_vec();
        if self.platform == Platform::Ios && self.log_path(LogKind::RawMagneticField).is_file() {
            kinds.push(LogKind::RawMagneticField);
        }
        for kind in kinds {
            let mut log =
                SensorLogReader::open(&self.log_path(kind), self.platform, kind, capture_from_phone_s)?;
            for sample in log.by_ref() {
                samples.push(sample?);
            }
            n_rejected += LineRejections::total(log.rejections());
        }
        // Stable: of equal times, rates stay before forces and forces before fields.
        samples.sort_by_key(|sample| sample.time);
        if self.platform == Platform::Ios {
            tell_bias(&mut samples);
        }
        Ok(TrialSamples { samples, n_rejected })
    }

    /// Reads the capture.
    ///
    /// # Errors
    /// When it is missing or foreign.
    pub fn truth(&self) -> Result<Truth, FormatError> {
        Truth::open(&self.capture)
    }

    /// What is added to the phone's times: the alignment, less the start of the log on iOS, where times count from the
    /// phone's own.
    fn capture_from_phone_s(&self) -> Result<f64, FormatError> {
        let path = self.folder.join("timeAlignment.txt");
        let alignment_s = number_in(&path, &read_text(&path)?)?;
        match self.platform {
            Platform::Android => Ok(alignment_s),
            Platform::Ios => {
                let path = self.folder.join("description.txt");
                let text = read_text(&path)?;
                let start_s =
                    text.split_once("BootTime").map_or("", |(_, rest)| rest.trim_start_matches([' ', '=']));
                let start_s = start_s.lines().next().unwrap_or_default();
                Ok(alignment_s - number_in(&path, start_s)?)
            }
        }
    }

    fn log_path(&self, kind: LogKind) -> PathBuf {
        self.folder.join(kind.file_name(self.platform))
    }

    fn of_folder(folder: &Path, platform: Platform, captures: &Path) -> Option<Self> {
        let name = folder.file_name()?.to_str()?;
        let mut parts = name.splitn(4, '_');
        let (person, phone) = (parts.next()?, parts.next()?);
        let is_disturbed = match parts.next()? {
            "Dist" => true,
            "NoDist" => false,
            _ => return None,
        };
        let motion = parts.next()?;
        Some(Self {
            name: name.to_owned(),
            person: person.to_owned(),
            phone: phone.to_owned(),
            platform,
            motion: Motion::ALL.into_iter().find(|known| known.name() == motion)?,
            is_disturbed,
            folder: folder.to_owned(),
            capture: captures.join(format!("{name}.mat")),
        })
    }
}

/// The folders in `parent`, by name.
fn folders(parent: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let refused = |error| FormatError::io("list the folder", parent, error);
    let entries = fs::read_dir(parent).map_err(refused)?.collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let mut folders: Vec<_> =
        entries.into_iter().map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    folders.sort();
    Ok(folders)
}

fn is_calibration(folder: &Path) -> bool {
    folder.file_name().and_then(OsStr::to_str).is_some_and(|name| name.starts_with("calib"))
}

/// The text of a file of one line or a few.
fn read_text(path: &Path) -> Result<String, FormatError> {
    use std::io::Read as _;
    let refused = |error| FormatError::io("read", path, error);
    let mut text = String::new();
    fs::File::open(path).map_err(refused)?.take(4096).read_to_string(&mut text).map_err(refused)?;
    Ok(text)
}

/// The number that `text` is, within a year of zero.
fn number_in(path: &Path, text: &str) -> Result<f64, FormatError> {
    text.trim().parse().ok().filter(|seconds: &f64| seconds.abs() < 3.2e7).ok_or_else(|| {
        FormatError::malformed("no time in seconds", "give a folder of the benchmark as it was published")
            .at_path(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::time::Timestamp;

    #[test]
    fn names_say_who_and_how() {
        let parse = |name: &str| Trial::of_folder(Path::new(name), Platform::Ios, Path::new("q"));
        let trial = parse("ios/Ada_iPhone5_NoDist_RunningHand").unwrap();
        assert_eq!((trial.person.as_str(), trial.phone.as_str()), ("Ada", "iPhone5"));
        assert_eq!((trial.motion, trial.is_disturbed), (Motion::RunningInHand, false));
        assert_eq!(trial.capture, Path::new("q/Ada_iPhone5_NoDist_RunningHand.mat"));
        assert!(parse("Ada_iPhone5_Maybe_AR").is_none() && parse("calib_acc_Nexus5_d1").is_none());
        for motion in Motion::ALL {
            assert_eq!(parse(&format!("A_B_Dist_{}", motion.name())).unwrap().motion, motion);
        }
    }

    /// A folder of its own, removed when the test ends.
    struct Scratch(PathBuf);

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    fn scratch(test: &str) -> Scratch {
        let folder = std::env::temp_dir().join(format!("fieldwalk-tyrex-{}-{test}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Scratch(folder)
    }

    #[test]
    fn a_folder_of_another_kind_is_refused() {
        let scratch = scratch("foreign");
        let error = find_trials(&scratch.0).unwrap_err();
        assert!(error.to_string().contains("qualisys"), "{error}");
        assert!(find_trials(&scratch.0.join("absent")).unwrap_err().is_not_found());
    }

    #[test]
    fn an_iphone_counts_from_its_own_start() {
        let scratch = scratch("clock");
        let folder = scratch.0.join("ios/A_iPhone5_Dist_Texting");
        fs::create_dir_all(&folder).unwrap();
        fs::create_dir_all(scratch.0.join("qualisys")).unwrap();
        for (name, text) in [
            ("timeAlignment.txt", "  -2.0e+00\n"),
            ("description.txt", "[Time]\nBootTime = 100.5"),
            ("accelerometer.txt", "103.5 0 0 -1\n"),
            ("gyroscope.txt", "102.5 0 0 1\n"),
            ("magnetometer-calibrated.txt", "102.75 1 2 3 2\ntorn\n"),
        ] {
            fs::write(folder.join(name), text).unwrap();
        }
        let found = find_trials(&scratch.0).unwrap();
        let read = found.trials[0].samples().unwrap();
        let times_ms: Vec<_> = read.samples.iter().map(|s| s.time.as_nanos() / 1_000_000).collect();
        assert_eq!((times_ms, read.n_rejected), (vec![0, 250, 1000], 1));
        // Raw fields: one before any corrected one, and two whose bias is told by the latest.
        fs::write(folder.join("magnetometer.txt"), "102.625 9 9 9\n102.875 101 52 3\n103 102 50 3\n")
            .unwrap();
        let read = found.trials[0].samples().unwrap();
        let raw = |time_ms: i64, field_ut: [f32; 3], bias_ut: [f32; 3]| Sample {
            time: Timestamp::from_millis(time_ms),
            reading: Reading::UncalibratedMagneticField { field_ut, bias_ut },
        };
        let is_raw = |sample: &Sample| matches!(sample.reading, Reading::UncalibratedMagneticField { .. });
        let paired: Vec<_> = read.samples.iter().copied().filter(is_raw).collect();
        assert_eq!(
            paired,
            [
                raw(375, [101.0, 52.0, 3.0], [100.0, 50.0, 0.0]),
                raw(500, [102.0, 50.0, 3.0], [101.0, 48.0, 0.0])
            ]
        );
        fs::write(folder.join("description.txt"), "[Time]\n").unwrap();
        let error = found.trials[0].samples().unwrap_err();
        assert!(error.to_string().contains("description.txt"), "{error}");
    }
}
