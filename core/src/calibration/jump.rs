//! A stream that the operating system recalibrates jumps; so does one whose device was magnetised.

use serde::{Deserialize, Serialize};

use crate::time::Timestamp;

/// Parameters of [`FieldJumpDetector`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldJumpParams {
    /// Least jump, in µT; default 12: walking past steel changes a reading by 2 µT in a fiftieth of a second.
    pub min_jump_ut: f32,
    /// Two readings farther apart than this may differ by any amount, in seconds; default 0.1.
    pub max_gap_s: f64,
}

impl Default for FieldJumpParams {
    fn default() -> Self {
        Self { min_jump_ut: 12.0, max_gap_s: 0.1 }
    }
}

/// Tells a lasting jump of the field from one reading to the next.
///
/// The field comes in a frame that does not turn with the device, so that turning is no jump. A single reading that
/// is far off (a spike) is none either: the reading after it must stay.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldJumpDetector {
    params: FieldJumpParams,
    /// The latest reading, and the one before a jump that waits to be confirmed.
    last: Option<(Timestamp, [f32; 3])>,
    before_ut: Option<[f32; 3]>,
}

impl FieldJumpDetector {
    /// A detector that has seen nothing.
    pub fn new(params: FieldJumpParams) -> Self {
        Self { params, last: None, before_ut: None }
    }

    /// Consumes a reading in a frame that does not turn with the device; whether it confirms a jump just before it.
    pub fn push(&mut self, time: Timestamp, level_field_ut: [f32; 3]) -> bool {
        let last = self.last.replace((time, level_field_ut));
        let before_ut = self.before_ut.take();
        let Some((last_time, last_ut)) = last else { return false };
        if !(0.0..=self.params.max_gap_s).contains(&time.secs_since(last_time)) {
            return false;
        }
        let is_far = |a: [f32; 3]| {
            let d = [0, 1, 2].map(|c| level_field_ut[c] - a[c]);
            let threshold_ut = self.params.min_jump_ut;
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2] > threshold_ut * threshold_ut
        };
        if is_far(last_ut) {
            // The first reading after a jump, or a spike, or the end of one.
            self.before_ut = before_ut.or(Some(last_ut));
            return false;
        }
        before_ut.is_some_and(is_far)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn jumps(fields: &[[f32; 3]]) -> Vec<usize> {
        let mut detector = FieldJumpDetector::new(FieldJumpParams::default());
        let told = |(k, &field): (usize, &[f32; 3])| {
            detector.push(Timestamp::from_millis(20 * k as i64), field).then_some(k)
        };
        fields.iter().enumerate().filter_map(told).collect()
    }

    #[test]
    fn a_jump_is_told_once_at_its_second_reading() {
        let (a, b) = ([0.0, 20.0, -40.0], [15.0, 20.0, -40.0]);
        assert_eq!(jumps(&[a, a, a, b, b, b, b]), [4]);
        assert_eq!(jumps(&[a, a, b, b, a, a]), [3, 5]);
    }

    #[test]
    fn a_spike_a_walk_and_a_pause_are_no_jumps() {
        let (a, b) = ([0.0, 20.0, -40.0], [55.0, 20.0, -40.0]);
        assert_eq!(jumps(&[a, a, b, a, a, a]), []);
        let walk: Vec<_> = (0..100).map(|k| [5.0 * k as f32, 0.0, 0.0]).collect();
        assert_eq!(jumps(&walk), []);
        let mut detector = FieldJumpDetector::new(FieldJumpParams::default());
        for (ms, field) in [(0, a), (20, a), (900, b), (920, b), (910, a), (911, a)] {
            // The last two: time that goes backwards says nothing, what follows it is a jump once confirmed.
            assert!(!detector.push(Timestamp::from_millis(ms), field), "{ms}");
        }
    }
}
