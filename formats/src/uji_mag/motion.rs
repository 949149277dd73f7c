//! Samples from the rows of a walk: gravity and turning from Android's orientation.

use fieldwalk::gravity::STANDARD_GRAVITY_M_S2;
use fieldwalk::rotation::Quaternion;
use fieldwalk::sensor::{Reading, Sample};

use super::rows::Row;

/// The samples of `rows`, in order of time: the field where it is fresh; where the walk's motion is known, the angular
/// rate and the specific force of every row.
pub(super) fn samples(rows: &[Row]) -> Vec<Sample> {
    let mut samples = Vec::with_capacity(3 * rows.len());
    let motion = Motion::of(rows);
    for (k, row) in rows.iter().enumerate() {
        let mut push = |reading| samples.push(Sample { time: row.time, reading });
        if let Some(motion) = &motion {
            if k > 0 {
                push(Reading::AngularRate(motion.rate_rad_s(rows, k)));
            }
            if k >= motion.first_force {
                push(Reading::SpecificForce(motion.force_m_s2(row, k)));
            }
        }
        // The first field is left over from before; one that is repeated is the last one, read again.
        if k > 0 && row.field_ut != rows[k - 1].field_ut {
            push(Reading::MagneticField(row.field_ut));
        }
    }
    samples
}

/// Whether linear acceleration or orientation is the same in all `rows`.
pub(super) fn is_stuck(rows: &[Row]) -> bool {
    Motion::of(rows).is_none()
}

/// How the device was turned and when its acceleration is known.
struct Motion {
    /// Per row.
    earth_from_device: Vec<Quaternion>,
    /// The first row whose linear acceleration is this walk's.
    first_force: usize,
}

impl Motion {
    /// Nothing where the linear acceleration or the orientation never changes.
    fn of(rows: &[Row]) -> Option<Self> {
        let first_force = changes(rows, |row| row.linear_m_s2).next()?;
        let updates: Vec<usize> = changes(rows, |row| row.orientation_deg).collect();
        let (&first, &last) = (updates.first()?, updates.last()?);
        let turned = |k: usize| earth_from_device(rows[k].orientation_deg);
        let mut earth_from_device = vec![turned(first); rows.len()];
        for pair in updates.windows(2) {
            let (from, to) = (turned(pair[0]), turned(pair[1]));
            let turn = rotation_vector(from.inverse().after(to));
            let span_s = rows[pair[1]].time.secs_since(rows[pair[0]].time);
            let between = pair[0]..pair[1];
            for (q, row) in earth_from_device[between.clone()].iter_mut().zip(&rows[between]) {
                let share = row.time.secs_since(rows[pair[0]].time) / span_s;
                *q = from.after(of_rotation_vector(turn.map(|c| share * c)));
            }
        }
        for q in &mut earth_from_device[last..] {
            *q = turned(last);
        }
        Some(Self { earth_from_device, first_force })
    }

    /// The mean angular rate from the row before `k` to it.
    fn rate_rad_s(&self, rows: &[Row], k: usize) -> [f32; 3] {
        let (before, now) = (self.earth_from_device[k - 1], self.earth_from_device[k]);
        let dt_s = rows[k].time.secs_since(rows[k - 1].time);
        rotation_vector(before.inverse().after(now)).map(|c| (c / dt_s) as f32)
    }

    fn force_m_s2(&self, row: &Row, k: usize) -> [f32; 3] {
        let up = self.earth_from_device[k].rotate_back([0.0, 0.0, f64::from(STANDARD_GRAVITY_M_S2)]);
        [0, 1, 2].map(|c| row.linear_m_s2[c] + up[c] as f32)
    }
}

/// The rows whose value differs from that of the row before.
fn changes<'a>(rows: &'a [Row], value: impl Fn(&Row) -> [f32; 3] + 'a) -> impl Iterator<Item = usize> + 'a {
    rows.windows(2)
        .enumerate()
        .filter(move |(_, pair)| value(&pair[0]) != value(&pair[1]))
        .map(|(k, _)| k + 1)
}

/// The rotation that Android's `getOrientation` describes: azimuth clockwise about up, pitch about x, negative where
/// the top edge points up, roll about y, positive where the right edge points down.
fn earth_from_device([azimuth_deg, pitch_deg, roll_deg]: [f32; 3]) -> Quaternion {
    let half = |degrees: f32| libm::sincos(0.5 * f64::from(degrees).to_radians());
    let (azimuth, pitch, roll) = (half(azimuth_deg), half(pitch_deg), half(roll_deg));
    let about_up = Quaternion([azimuth.1, 0.0, 0.0, -azimuth.0]);
    let about_right = Quaternion([pitch.1, -pitch.0, 0.0, 0.0]);
    let about_top = Quaternion([roll.1, 0.0, roll.0, 0.0]);
    about_up.after(about_right).after(about_top)
}

/// Axis times angle, in radians, the shorter way round.
fn rotation_vector(Quaternion(q): Quaternion) -> [f64; 3] {
    let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
    let sin = (q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    let angle_per_sin = if sin < 1e-9 { 2.0 } else { 2.0 * libm::atan2(sin, sign * q[0]) / sin };
    [q[1], q[2], q[3]].map(|c| sign * angle_per_sin * c)
}

fn of_rotation_vector(v: [f64; 3]) -> Quaternion {
    let angle_rad = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let (sin, cos) = libm::sincos(0.5 * angle_rad);
    let share = if angle_rad < 1e-9 { 0.5 } else { sin / angle_rad };
    Quaternion([cos, share * v[0], share * v[1], share * v[2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::time::Timestamp;

    fn assert_close(a: [f64; 3], b: [f64; 3]) {
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-6), "{a:?} {b:?}");
    }

    fn rows(orientations_deg: &[[f32; 3]]) -> Vec<Row> {
        let row = |(index, &orientation_deg): (usize, &[f32; 3])| Row {
            index,
            time: Timestamp::from_millis(100 * index as i64),
            field_ut: [0.0; 3],
            linear_m_s2: [0.1 * index as f32, 0.0, 0.0],
            orientation_deg,
        };
        orientations_deg.iter().enumerate().map(row).collect()
    }

    #[test]
    fn orientations_point_as_android_says() {
        // Facing east, flat: the top edge points east, the right edge south.
        let east = earth_from_device([90.0, 0.0, 0.0]);
        assert_close(east.rotate([0.0, 1.0, 0.0]), [1.0, 0.0, 0.0]);
        assert_close(east.rotate([1.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
        // Upright: the top edge points up. On its right edge: that points down.
        assert_close(earth_from_device([0.0, -90.0, 0.0]).rotate([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_close(earth_from_device([0.0, 0.0, 90.0]).rotate([1.0, 0.0, 0.0]), [0.0, 0.0, -1.0]);
        // Both: R[7] = −sin pitch, R[6] = −cos pitch·sin roll, R[8] = cos pitch·cos roll.
        let up = earth_from_device([123.0, -30.0, 20.0]).rotate_back([0.0, 0.0, 1.0]);
        let (pitch, roll) = ((-30.0f64).to_radians(), 20.0f64.to_radians());
        assert_close(up, [-pitch.cos() * roll.sin(), -pitch.sin(), pitch.cos() * roll.cos()]);
    }

    #[test]
    fn rotation_vectors_come_back_the_shorter_way() {
        for v in [[0.0; 3], [0.3, -0.2, 0.1], [0.0, 0.0, -3.0], [1e-12, 0.0, 0.0]] {
            assert_close(rotation_vector(of_rotation_vector(v)), v);
        }
        let Quaternion(q) = of_rotation_vector([0.0, 0.5, 0.0]);
        assert_close(rotation_vector(Quaternion(q.map(|c| -c))), [0.0, 0.5, 0.0]);
    }

    #[test]
    fn turning_is_even_between_orientations_and_starts_with_the_first_fresh_one() {
        // What was left over, then a turn by 6 degrees clockwise over two rows, then none.
        let rows =
            rows(&[[170.0, 0.0, 0.0], [10.0; 3].map(|_| 0.0), [0.0; 3], [6.0, 0.0, 0.0], [6.0, 0.0, 0.0]]);
        let samples = samples(&rows);
        let rates: Vec<f32> = samples
            .iter()
            .filter_map(|sample| match sample.reading {
                Reading::AngularRate(rate) => Some(rate[2].to_degrees()),
                _ => None,
            })
            .collect();
        // Clockwise is negative about z: 6 degrees in 0.2 s.
        let expected = [0.0, -30.0, -30.0, 0.0];
        assert!(
            rates.iter().zip(expected).all(|(rate, expected)| (rate - expected).abs() < 1e-3),
            "{rates:?}"
        );
    }
}
