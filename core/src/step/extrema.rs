//! Alternating peaks and troughs of a signal, told apart from its ripple by a hysteresis.

use serde::{Deserialize, Serialize};

use crate::time::Timestamp;

/// Follows a signal from peak to trough and back.
///
/// A peak counts once the signal has fallen from it by the hysteresis, a trough once it has risen by as much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Extrema {
    is_rising: bool,
    time: Timestamp,
    value: f32,
    trough: f32,
}

/// What [`Extrema`] came upon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turn {
    /// A peak, this high over the trough before it.
    Peak { time: Timestamp, amplitude: f32 },
    /// A trough, this deep under the peak before it.
    Trough { time: Timestamp, depth: f32 },
}

impl Extrema {
    /// How far the signal has been below its last peak; 0 while it rises.
    pub(super) fn fallen(&self) -> f32 {
        if self.is_rising { 0.0 } else { self.trough - self.value }
    }

    /// A signal that starts at `value`, as if from a trough.
    pub(super) fn new(time: Timestamp, value: f32) -> Self {
        Self { is_rising: true, time, value, trough: value }
    }

    /// Feeds the next value; returns the turn that it shows to have been one.
    pub(super) fn push(&mut self, time: Timestamp, value: f32, hysteresis: f32) -> Option<Turn> {
        let is_further = if self.is_rising { value > self.value } else { value < self.value };
        if is_further {
            (self.time, self.value) = (time, value);
            return None;
        }
        if (value - self.value).abs() <= hysteresis {
            return None;
        }
        let turned = *self;
        (self.time, self.value) = (time, value);
        self.is_rising = !turned.is_rising;
        if turned.is_rising {
            let amplitude = turned.value - turned.trough;
            // Until the trough is found, the peak stands here for what the trough lies under.
            self.trough = turned.value;
            Some(Turn::Peak { time: turned.time, amplitude })
        } else {
            self.trough = turned.value;
            Some(Turn::Trough { time: turned.time, depth: turned.trough - turned.value })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ripple_below_the_hysteresis_turns_nothing() {
        let mut extrema = Extrema::new(Timestamp::from_millis(0), 0.0);
        let turns: Vec<Turn> = [2.0, 1.5, 3.0, 2.2, 1.0, 1.6, -1.0, 0.5]
            .into_iter()
            .zip(1..)
            .filter_map(|(value, k)| extrema.push(Timestamp::from_millis(k), value, 1.0))
            .collect();
        // Up to 3 (the dip to 1.5 is ripple), down to -1 (so is the bump to 1.6), and up again.
        let expected = [
            Turn::Peak { time: Timestamp::from_millis(3), amplitude: 3.0 },
            Turn::Trough { time: Timestamp::from_millis(7), depth: 4.0 },
        ];
        assert_eq!(turns, expected);
    }
}
