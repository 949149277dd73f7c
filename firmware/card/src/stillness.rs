//! When nobody wears the card.

/// Tells that a card has lain still for so many rounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StillnessDetector {
    max_swing_m_s2: f32,
    n_rounds: u16,
    n_still: u16,
}

impl StillnessDetector {
    /// Still is a card whose `|acc|` varies by `max_swing_m_s2` at most in each of `n_rounds` rounds in a row.
    pub fn new(max_swing_m_s2: f32, n_rounds: u16) -> Self {
        Self { max_swing_m_s2, n_rounds, n_still: 0 }
    }

    /// Takes a round's largest less smallest `|acc|`; whether it is time to sleep. A round that was not measured is no
    /// sign of stillness.
    pub fn push(&mut self, swing_m_s2: Option<f32>) -> bool {
        let is_still = swing_m_s2.is_some_and(|swing_m_s2| swing_m_s2 <= self.max_swing_m_s2);
        self.n_still = if is_still { self.n_still.saturating_add(1) } else { 0 };
        self.n_still >= self.n_rounds
    }

    /// Counts anew.
    pub fn restart(&mut self) {
        self.n_still = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_motion_begins_the_count_anew() {
        let mut detector = StillnessDetector::new(0.5, 3);
        let swings =
            [Some(0.1), Some(0.5), Some(0.6), Some(0.0), Some(0.2), None, Some(0.1), Some(0.1), Some(0.1)];
        let told = swings.map(|swing_m_s2| detector.push(swing_m_s2));
        assert_eq!(told, [false, false, false, false, false, false, false, false, true]);
        detector.restart();
        assert!(!detector.push(Some(0.0)) && !detector.push(Some(f32::NAN)));
    }
}
