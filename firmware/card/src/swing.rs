//! The swing by which a wearer calibrates the card.

use crate::calibration::Calibration;
use crate::ellipsoid::{SwingRejection, fit};

/// Most readings that a swing keeps: all of them, three a second.
const MAX_READINGS: usize = 90;
/// A reading nearer than this to one that is kept tells nothing new, in µT; where all places are taken, it grows.
const SPACING_UT: f32 = 4.0;
/// Reaction of gravity along the device's y below which a card hangs head down, and above which it is upright, in m/s².
const HEAD_DOWN_M_S2: f32 = -7.0;
const UPRIGHT_M_S2: f32 = 5.0;

/// Collects raw fields, well apart from each other, in a fixed place.
#[derive(Clone, Copy, Debug)]
pub struct SwingCollector {
    readings_ut: [[f32; 3]; MAX_READINGS],
    n: usize,
    spacing_ut: f32,
}

impl Default for SwingCollector {
    fn default() -> Self {
        Self { readings_ut: [[0.0; 3]; MAX_READINGS], n: 0, spacing_ut: SPACING_UT }
    }
}

impl SwingCollector {
    /// Takes a raw field, in µT.
    pub fn push(&mut self, field_ut: [f32; 3]) {
        if field_ut.iter().any(|c| !c.is_finite()) || !is_apart(self.kept(), field_ut, self.spacing_ut) {
            return;
        }
        while self.n == MAX_READINGS {
            self.thin_out();
            if !is_apart(self.kept(), field_ut, self.spacing_ut) {
                return;
            }
        }
        self.readings_ut[self.n] = field_ut;
        self.n += 1;
    }

    /// The readings kept, in µT.
    pub fn kept(&self) -> &[[f32; 3]] {
        &self.readings_ut[..self.n]
    }

    fn thin_out(&mut self) {
        self.spacing_ut *= 1.25;
        let mut n = 0;
        for k in 0..self.n {
            let reading = self.readings_ut[k];
            if is_apart(&self.readings_ut[..n], reading, self.spacing_ut) {
                self.readings_ut[n] = reading;
                n += 1;
            }
        }
        self.n = n;
    }
}

fn is_apart(kept_ut: &[[f32; 3]], field_ut: [f32; 3], spacing_ut: f32) -> bool {
    kept_ut.iter().all(|kept| {
        let [x, y, z] = [0, 1, 2].map(|c| kept[c] - field_ut[c]);
        x * x + y * y + z * z >= spacing_ut * spacing_ut
    })
}

/// Sees a swing begin and end: the wearer turns the card head down, which it is not while worn, and about every axis for
/// half a minute.
#[derive(Clone, Copy, Debug, Default)]
pub struct SwingWatch {
    open: Option<(SwingCollector, u8)>,
    /// It must have been upright since the last swing.
    is_ready: bool,
}

/// Rounds that a swing takes.
pub(crate) const SWING_ROUNDS: u8 = 30;

impl SwingWatch {
    /// Takes a raw field, in µT, while gravity's reaction is `gravity_m_s2`.
    pub fn push(&mut self, field_ut: [f32; 3], gravity_m_s2: [f32; 3]) {
        if gravity_m_s2[1] > UPRIGHT_M_S2 {
            self.is_ready = true;
        }
        if self.open.is_none() && self.is_ready && gravity_m_s2[1] < HEAD_DOWN_M_S2 {
            self.open = Some((SwingCollector::default(), SWING_ROUNDS));
            self.is_ready = false;
        }
        if let Some((collector, _)) = &mut self.open {
            collector.push(field_ut);
        }
    }

    /// Whether a swing is going on.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// A round has passed; what a swing gave that ends with it.
    pub fn end_round(&mut self) -> Option<Result<Calibration, SwingRejection>> {
        let (collector, n_left) = self.open.as_mut()?;
        *n_left -= 1;
        if *n_left > 0 {
            return None;
        }
        let result = fit(collector.kept());
        self.open = None;
        Some(result)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_apart_and_bounded() {
        let mut collector = SwingCollector::default();
        for k in 0..4_000 {
            let (sin, cos) = libm::sincosf(0.37 * k as f32);
            let (sin_z, cos_z) = libm::sincosf(0.011 * k as f32);
            collector.push([60.0 * sin * cos_z, 60.0 * cos * cos_z, 60.0 * sin_z]);
        }
        collector.push([f32::NAN, 1.0, 2.0]);
        let kept = collector.kept();
        assert!((40..=MAX_READINGS).contains(&kept.len()), "{}", kept.len());
        for (k, reading) in kept.iter().enumerate() {
            assert!(is_apart(&kept[..k], *reading, collector.spacing_ut));
        }
    }

    #[test]
    fn a_swing_begins_head_down_and_lasts_thirty_rounds() {
        let mut watch = SwingWatch::default();
        // Lying head down from the start is no gesture.
        watch.push([1.0; 3], [0.0, -9.8, 0.0]);
        assert!(!watch.is_open());
        watch.push([1.0; 3], [0.0, 9.8, 0.0]);
        watch.push([1.0; 3], [0.0, -9.8, 0.0]);
        for _ in 0..29 {
            assert_eq!(watch.end_round(), None);
        }
        assert_eq!(watch.end_round(), Some(Err(SwingRejection::TooShort)));
        watch.push([1.0; 3], [0.0, -9.8, 0.0]);
        assert!(!watch.is_open() && watch.end_round().is_none());
    }
}
