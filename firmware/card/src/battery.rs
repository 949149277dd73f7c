//! What the battery's voltage says.

/// How full the battery is, as far as it matters to the card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Charge {
    /// Enough.
    Good,
    /// To be changed: frames say so.
    Low,
    /// A frame might pull the voltage below what the parts run at: the card stays silent.
    Exhausted,
}

/// Follows the voltage, with hysteresis, since it recovers between pulses.
///
/// # Source
/// Levels are ours: a lithium coin cell holds 2.9 V nearly to its end and then falls quickly; at 2.4 V a tenth is left at
/// most, and below 2.0 V a pulse of the radio through the old cell's resistance reaches the 1.7 V of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatteryMonitor {
    charge: Charge,
    voltage_mv: Option<u16>,
}

/// Below, in mV, it is low; above, it is good again.
const LOW_MV: [u16; 2] = [2_400, 2_500];
/// Below, in mV, it is exhausted; above, it is not.
const EXHAUSTED_MV: [u16; 2] = [2_000, 2_200];

impl Default for BatteryMonitor {
    fn default() -> Self {
        Self { charge: Charge::Good, voltage_mv: None }
    }
}

impl BatteryMonitor {
    /// Takes a measurement in mV.
    pub fn push(&mut self, voltage_mv: u16) -> Charge {
        self.voltage_mv = Some(voltage_mv);
        let is_below = |levels_mv: [u16; 2], was: bool| voltage_mv < levels_mv[usize::from(was)];
        self.charge = if is_below(EXHAUSTED_MV, self.charge == Charge::Exhausted) {
            Charge::Exhausted
        } else if is_below(LOW_MV, self.charge != Charge::Good) {
            Charge::Low
        } else {
            Charge::Good
        };
        self.charge
    }

    /// The last measurement, in mV.
    pub fn voltage_mv(&self) -> Option<u16> {
        self.voltage_mv
    }

    /// What it said.
    pub fn charge(&self) -> Charge {
        self.charge
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_have_hysteresis() {
        let mut monitor = BatteryMonitor::default();
        let told = [2_950, 2_399, 2_450, 2_500, 2_400, 1_999, 2_100, 2_200, 2_600].map(|mv| monitor.push(mv));
        use Charge::{Exhausted, Good, Low};
        assert_eq!(told, [Good, Low, Low, Good, Good, Exhausted, Exhausted, Low, Good]);
        assert_eq!(monitor.voltage_mv(), Some(2_600));
    }
}
