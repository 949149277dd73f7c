//! Where the phone was and how it was turned: a Qualisys capture of one rigid body.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use fieldwalk::time::{Duration, Timestamp};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use super::mat5::{self, Mat5Fault, Matrix};
use crate::error::FormatError;

/// Position and attitude of the phone at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// When, on the clock of the capture, whose origin is its first frame.
    pub time: Timestamp,
    /// Unit quaternion (w, x, y, z) that turns vectors of the device frame into the earth frame (z up).
    pub earth_from_device: [f64; 4],
    /// The phone's place in the earth frame, in metres.
    pub position_m: [f64; 3],
}

/// The captured poses of a trial, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// One pose a captured frame; frames in which the cameras lost the phone are left out.
    pub poses: Vec<Pose>,
    /// The number of frames in which the cameras lost the phone.
    pub n_lost: usize,
}

/// The largest file read, in bytes: thirty times that of a trial of two minutes.
const MAX_BYTES: u64 = 64 << 20;

/// The longest gap between two frames over which a pose is interpolated, in seconds.
const MAX_GAP_S: f64 = 0.1;

impl Pose {
    /// `vector` of the device frame, in the earth frame.
    pub fn to_earth(&self, vector: [f64; 3]) -> [f64; 3] {
        let [w, x, y, z] = self.earth_from_device;
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let t = cross([x, y, z], vector).map(|c| 2.0 * c);
        let s = cross([x, y, z], t);
        [0, 1, 2].map(|c| vector[c] + w * t[c] + s[c])
    }
}

impl Truth {
    /// Reads the capture at `path`.
    ///
    /// # Errors
    /// When the file cannot be read, is larger than 64 MiB, or is none of a capture.
    pub fn open(path: &Path) -> Result<Self, FormatError> {
        let file = File::open(path).map_err(|error| FormatError::io("open the capture", path, error))?;
        let mut bytes = Vec::new();
        let n_bytes = file.take(MAX_BYTES + 1).read_to_end(&mut bytes);
        let n_bytes = n_bytes.map_err(|error| FormatError::io("read the capture", path, error))?;
        if n_bytes as u64 > MAX_BYTES {
            return Err(FormatError::malformed("larger than any capture of a trial", REMEDY).at_path(path));
        }
        Self::parse(&bytes).map_err(|error| error.at_path(path))
    }

    /// Reads a capture's bytes.
    ///
    /// # Errors
    /// When they are none of a capture of one rigid body, with its remedy.
    pub fn parse(bytes: &[u8]) -> Result<Self, FormatError> {
        let capture = mat5::first_structure(bytes).map_err(|fault| match fault {
            Mat5Fault::NotMat5 => FormatError::malformed("not a MAT-file of level 5", REMEDY),
            Mat5Fault::Torn => FormatError::malformed("the MAT-file ends too soon", "fetch it again"),
            Mat5Fault::NoStructure => FormatError::malformed("the MAT-file holds no structure", REMEDY),
            Mat5Fault::Compressed => FormatError::malformed(
                "the MAT-file is compressed",
                "save it in MATLAB with `save(…, '-v6')`",
            ),
        })?;
        Self::of_capture(&capture).ok_or_else(|| {
            FormatError::malformed(
                "no FrameRate, RigidBodies.Positions and RigidBodies.Rotations of one body",
                REMEDY,
            )
        })
    }

    /// The pose at `time`: between two frames at most 0.1 s apart, or nothing.
    pub fn pose_at(&self, time: Timestamp) -> Option<Pose> {
        let after = self.poses.partition_point(|pose| pose.time < time);
        let next = self.poses.get(after)?;
        if next.time == time {
            return Some(*next);
        }
        let last = self.poses.get(after.checked_sub(1)?)?;
        let gap_s = next.time.secs_since(last.time);
        if gap_s > MAX_GAP_S {
            return None;
        }
        let share = time.secs_since(last.time) / gap_s;
        let mix = |a: f64, b: f64| a + share * (b - a);
        let (a, mut b) = (last.earth_from_device, next.earth_from_device);
        if (0..4).map(|c| a[c] * b[c]).sum::<f64>() < 0.0 {
            b = b.map(|c| -c);
        }
        let q = [0, 1, 2, 3].map(|c| mix(a[c], b[c]));
        let norm = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        Some(Pose {
            time,
            earth_from_device: q.map(|c| c / norm),
            position_m: [0, 1, 2].map(|c| mix(last.position_m[c], next.position_m[c])),
        })
    }

    fn of_capture(capture: &Matrix<'_>) -> Option<Self> {
        let rate_hz = capture.field("FrameRate")?.number().filter(|rate| (1.0..=1e4).contains(rate))?;
        let body = capture.field("RigidBodies")?;
        let (positions, rotations) = (body.field("Positions")?, body.field("Rotations")?);
        let n = positions.dimensions[2];
        if positions.dimensions != [1, 3, n] || rotations.dimensions != [1, 9, n] {
            return None;
        }
        let (mut positions, mut rotations) = (positions.doubles()?, rotations.doubles()?);
        let mut truth = Self::default();
        for frame in 0..n {
            let next = |doubles: &mut dyn Iterator<Item = f64>| doubles.next().unwrap_or(f64::NAN);
            let position_mm: [f64; 3] = std::array::from_fn(|_| next(&mut positions));
            let columns: [f64; 9] = std::array::from_fn(|_| next(&mut rotations));
            match rotation(&columns).filter(|_| position_mm.iter().all(|c| c.is_finite())) {
                Some(earth_from_device) => truth.poses.push(Pose {
                    time: Timestamp::default() + Duration::from_secs_f64(frame as f64 / rate_hz),
                    earth_from_device,
                    position_m: position_mm.map(|c| c * 1e-3),
                }),
                None => truth.n_lost += 1,
            }
        }
        Some(truth)
    }
}

const REMEDY: &str = "give a capture as Qualisys Track Manager exports it, with one rigid body";

/// The quaternion of a rotation matrix, columns first; nothing where the nine numbers are not one.
fn rotation(columns: &[f64; 9]) -> Option<[f64; 4]> {
    let matrix = Matrix3::from_column_slice(columns);
    let error = (matrix.transpose() * matrix - Matrix3::identity()).abs().max();
    // The greatest of a matrix passes over what is not a number.
    let is_finite = columns.iter().all(|c| c.is_finite());
    if !is_finite || error >= 1e-3 || matrix.determinant() <= 0.0 {
        return None;
    }
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    // As far from one as the matrix is from a rotation, until it is made one.
    let q = UnitQuaternion::new_normalize(q.into_inner());
    Some([q.w, q.i, q.j, q.k])
}

#[cfg(test)]
mod tests {
    use super::super::mat5::tests::write;
    use super::*;

    fn capture(positions: &[f64], rotations: &[f64], n: i32) -> Vec<u8> {
        let body = write::structure(
            "",
            &[
                ("Positions", write::doubles(&[1, 3, n], positions)),
                ("Rotations", write::doubles(&[1, 9, n], rotations)),
            ],
        );
        let rate = write::doubles(&[1, 1], &[60.0]);
        write::file(&[write::structure("trial", &[("FrameRate", rate), ("RigidBodies", body)])])
    }

    #[test]
    fn a_capture_by_hand() {
        // At first level; then turned by 90° to the left about z: device x (first column) points to earth y.
        let level = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let turned = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        let lost = [f64::NAN; 9];
        let bytes = capture(
            &[1000.0, 2000.0, 3000.0, 1010.0, 2000.0, 3000.0, 0.0, 0.0, 0.0],
            &[level, turned, lost].concat(),
            3,
        );
        let truth = Truth::parse(&bytes).unwrap();
        assert_eq!((truth.poses.len(), truth.n_lost), (2, 1));
        let last = truth.poses[1];
        assert_eq!(last.time, Timestamp::from_nanos(16_666_666));
        assert!((last.position_m[0] - 1.01).abs() < 1e-12);
        let x = last.to_earth([1.0, 0.0, 0.0]);
        assert!(x[0].abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12, "{x:?}");
        // Halfway: 45°.
        let halfway = truth.pose_at(Timestamp::from_nanos(8_333_333)).unwrap();
        let x = halfway.to_earth([1.0, 0.0, 0.0]);
        assert!((x[0] - x[1]).abs() < 1e-6 && (halfway.position_m[0] - 1.005).abs() < 1e-6, "{x:?}");
        assert_eq!(truth.pose_at(Timestamp::from_millis(20)), None);
    }

    #[test]
    fn a_rotation_that_is_a_little_off_is_a_unit_quaternion_all_the_same() {
        let stretched = [1.0004, 0.0, 0.0, 0.0, 1.0004, 0.0, 0.0, 0.0, 1.0004];
        let truth = Truth::parse(&capture(&[0.0; 3], &stretched, 1)).unwrap();
        let norm = truth.poses[0].earth_from_device.iter().map(|c| c * c).sum::<f64>();
        assert!((norm - 1.0).abs() < 1e-12, "{norm}");
    }

    #[test]
    fn one_number_that_is_none_loses_its_frame() {
        for (at, none) in [(3, f64::NEG_INFINITY), (0, f64::NAN), (8, f64::INFINITY), (3, f64::NAN)] {
            let mut matrix = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
            matrix[at] = none;
            let truth = Truth::parse(&capture(&[0.0; 3], &matrix, 1)).unwrap();
            assert_eq!((truth.poses.len(), truth.n_lost), (0, 1), "{at} {none}");
        }
    }

    #[test]
    fn another_file_is_refused_with_a_remedy() {
        let error = Truth::parse(b"time,x,y\n").unwrap_err();
        assert!(error.to_string().contains("level 5") && !error.remedy().is_empty());
        let two_bodies = capture(&[0.0; 6], &[0.0; 9], 1);
        assert!(Truth::parse(&two_bodies).unwrap_err().to_string().contains("one body"));
    }
}
