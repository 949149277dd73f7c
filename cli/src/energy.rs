//! What an ID card draws from its battery: a model with its unknowns as ranges. Modelled, not measured.
//!
//! Charge is counted in µC a second, which is µA. A [`Design`] is what can be chosen, a [`Figures`] one value for each
//! [`Parameter`]; [`Budget`] says what a design draws under figures. Ranges are all parameters at their frugal end, in the
//! middle, and at their dear end at once: the true value lies inside, if each parameter does.

mod budget;
mod parameter;

pub(crate) use budget::asleep_at_ua;
pub use budget::{Budget, Design, Sampling, TransmitPower, asleep_ua};
pub use parameter::{Figures, PARAMETERS, Parameter};

/// Values at the frugal end, in the middle and at the dear end.
pub type Range = [f64; 3];

/// Capacities of a CR2450, in mAh: what the paper's 324 days ask for at its currents, and what the maker states.
pub const CAPACITIES_MAH: [f64; 2] = [433.0, 620.0];

/// What the paper states, in mA.
///
/// # Source
/// Kwak 2018, §4.1.
pub const PAPER_ACTIVE_MA: f64 = 0.159;
/// See [`PAPER_ACTIVE_MA`].
pub const PAPER_ASLEEP_MA: f64 = 0.004;

/// Days that `capacity_mah` lasts for eight hours a day at `active_ma` and sixteen at `asleep_ma`.
///
/// # Source
/// Kwak 2018, §4.1: eight hours a day.
pub fn days(capacity_mah: f64, active_ma: f64, asleep_ma: f64) -> f64 {
    capacity_mah / (8.0 * active_ma + 16.0 * asleep_ma)
}

/// `of` under the frugal, the middle and the dear figures.
pub fn range(of: impl Fn(&Figures) -> f64) -> Range {
    Figures::ALL.map(|figures| of(&figures))
}

/// The share of time that the sensor must run at full power for [`PAPER_ACTIVE_MA`], everything else being as in the
/// paper's schedule: readings polled at 15 Hz, fields at 3 Hz. From the frugal figures to the dear ones it falls.
pub fn paper_share() -> Range {
    range(|figures| {
        let paper = Design { sampling: Sampling::Polled, ..Design::OURS };
        let rest_ua = Budget::of(&paper, figures).active_ua() - Budget::of(&paper, figures).sensor_ua;
        let full_ua = figures.accelerometer_ua + figures.magnetometer_ua;
        (1e3 * PAPER_ACTIVE_MA - rest_ua - figures.sensor_standby_ua) / (full_ua - figures.sensor_standby_ua)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_days_by_hand() {
        // 8 · 0.159 + 16 · 0.004 = 1.336 mAh a day
        assert_eq!(CAPACITIES_MAH.map(|c| days(c, PAPER_ACTIVE_MA, PAPER_ASLEEP_MA).round()), [324.0, 464.0]);
    }

    #[test]
    fn ours_stays_within_its_bounds() {
        let [low_ua, middle_ua, high_ua] = range(|figures| Budget::of(&Design::OURS, figures).active_ua());
        assert!(low_ua < middle_ua && middle_ua < high_ua);
        assert!(middle_ua <= 60.0 && high_ua <= 100.0, "{low_ua} {middle_ua} {high_ua}");
        let asleep_ua = range(asleep_ua);
        assert!(asleep_ua[1] < 6.0, "{asleep_ua:?}");
        let worst = days(433.0, 1e-3 * high_ua, 1e-3 * asleep_ua[2]);
        assert!(worst >= 500.0, "{worst}");
    }

    #[test]
    fn the_papers_current_is_a_sensor_at_full_power_a_third_of_the_time() {
        let [frugal, middle, dear] = paper_share();
        assert!(frugal > middle && middle > dear);
        assert!((0.24..0.36).contains(&middle), "{middle}");
    }
}
