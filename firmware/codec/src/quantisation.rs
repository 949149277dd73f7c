//! Physical quantities to the frame's integers and back.
//!
//! Values are rounded to the nearest step, halves away from zero, and saturate at the ends of a field's range.
//! Scaling is by the exact integer number of steps a unit, so the same input gives the same bits everywhere.

/// One step of a magnetic sample, in µT.
pub const MAGNETIC_LSB_UT: f32 = 0.04;
/// The largest magnitude of a magnetic sample, in µT: the magnetometer's range. Larger ones saturate.
pub const MAGNETIC_RANGE_UT: f32 = 1200.0;
/// The `B_v` that says "no sample".
pub const B_V_MISSING: i16 = i16::MIN;
/// The `B_h` that says "no sample".
pub const B_H_MISSING: u16 = u16::MAX;
/// One step of the last round's `|B|`, in µT.
pub const PREVIOUS_B_LSB_UT: f32 = 1.0;
/// The last round's `|B|` that says "no sample".
pub const PREVIOUS_B_MISSING: u8 = 0;
/// One step of an acceleration nibble, in m/s².
pub const ACCELERATION_LSB_M_S2: f32 = 1.0;
/// The largest acceleration that a nibble holds, in m/s². Larger ones saturate.
pub const ACCELERATION_MAX_M_S2: f32 = 15.0;
/// Orientation steps a turn.
pub const ORIENTATION_STEPS: u16 = 256;
/// One step of the battery voltage, in mV.
pub const BATTERY_LSB_MV: u16 = 20;

/// Steps a µT: the inverse of [`MAGNETIC_LSB_UT`], exact where that is not.
const MAGNETIC_STEPS_PER_UT: f32 = 25.0;

/// The battery byte of a voltage in mV: the nearest step, from 20 mV (1) to 5.1 V (255), saturating at both ends.
///
/// A card that has not measured its battery sends 0.
pub const fn battery_from_mv(battery_mv: u16) -> u8 {
    let steps = battery_mv.saturating_add(BATTERY_LSB_MV / 2) / BATTERY_LSB_MV;
    match steps {
        0 => 1,
        1..=255 => steps as u8,
        _ => u8::MAX,
    }
}

/// The voltage of a battery byte, in mV; `None` where it was not measured.
pub const fn battery_mv(battery: u8) -> Option<u16> {
    match battery {
        0 => None,
        steps => Some(steps as u16 * BATTERY_LSB_MV),
    }
}

pub(crate) fn b_v_from_ut(b_v_ut: f32) -> i16 {
    if b_v_ut.is_nan() {
        return B_V_MISSING;
    }
    round(b_v_ut.clamp(-MAGNETIC_RANGE_UT, MAGNETIC_RANGE_UT) * MAGNETIC_STEPS_PER_UT) as i16
}

pub(crate) fn b_v_ut(b_v: i16) -> f32 {
    if b_v == B_V_MISSING { f32::NAN } else { f32::from(b_v) / MAGNETIC_STEPS_PER_UT }
}

pub(crate) fn b_h_from_ut(b_h_ut: f32) -> u16 {
    if b_h_ut.is_nan() {
        return B_H_MISSING;
    }
    round(b_h_ut.clamp(0.0, MAGNETIC_RANGE_UT) * MAGNETIC_STEPS_PER_UT) as u16
}

pub(crate) fn b_h_ut(b_h: u16) -> f32 {
    if b_h == B_H_MISSING { f32::NAN } else { f32::from(b_h) / MAGNETIC_STEPS_PER_UT }
}

pub(crate) fn previous_b_from_ut(previous_b_ut: f32) -> u8 {
    if previous_b_ut.is_nan() {
        return PREVIOUS_B_MISSING;
    }
    round(previous_b_ut.clamp(1.0, 255.0)) as u8
}

pub(crate) fn previous_b_ut(previous_b: u8) -> f32 {
    if previous_b == PREVIOUS_B_MISSING { f32::NAN } else { f32::from(previous_b) * PREVIOUS_B_LSB_UT }
}

/// The nibble of an acceleration; `None` for NaN.
pub(crate) fn acceleration_from_m_s2(acceleration_m_s2: f32) -> Option<u8> {
    if acceleration_m_s2.is_nan() {
        return None;
    }
    Some(round(acceleration_m_s2.clamp(0.0, ACCELERATION_MAX_M_S2)) as u8)
}

/// The step of an angle, whatever its number of turns; `None` where it is not finite.
pub(crate) fn orientation_from_rad(orientation_rad: f32) -> Option<u8> {
    if !orientation_rad.is_finite() {
        return None;
    }
    let turns = (orientation_rad / core::f32::consts::TAU) % 1.0;
    let steps = round(turns * f32::from(ORIENTATION_STEPS));
    Some(steps.rem_euclid(i32::from(ORIENTATION_STEPS)) as u8)
}

/// The angle of a step, in rad, in [0, 2π).
pub(crate) fn orientation_rad(orientation: u8) -> f32 {
    f32::from(orientation) / f32::from(ORIENTATION_STEPS) * core::f32::consts::TAU
}

/// The nearest integer, halves away from zero, without `libm`.
///
/// Adding 0.5 and truncating would round 0.499 999 97 up; the fraction taken here is exact.
fn round(value: f32) -> i32 {
    let truncated = value as i32;
    let fraction = value - truncated as f32;
    if fraction >= 0.5 {
        truncated + 1
    } else if fraction <= -0.5 {
        truncated - 1
    } else {
        truncated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_round_away_from_zero_and_just_below_half_rounds_down() {
        for (value, expected) in [
            (0.0, 0),
            (0.499_999_97, 0),
            (0.5, 1),
            (1.5, 2),
            (2.5, 3),
            (-0.499_999_97, 0),
            (-0.5, -1),
            (-2.5, -3),
        ] {
            assert_eq!(round(value), expected, "{value}");
        }
    }

    #[test]
    fn every_step_comes_back() {
        for step in i16::MIN + 1..=i16::MAX {
            let expected = step.clamp(-30_000, 30_000);
            assert_eq!(b_v_from_ut(b_v_ut(step)), expected);
        }
        for step in 0..u16::MAX {
            assert_eq!(b_h_from_ut(b_h_ut(step)), step.min(30_000));
        }
        for step in 0..=u8::MAX {
            assert_eq!(previous_b_from_ut(previous_b_ut(step)), step);
            assert_eq!(orientation_from_rad(orientation_rad(step)), Some(step));
            assert_eq!(battery_mv(step).map_or(0, battery_from_mv), step);
        }
    }

    #[test]
    fn nan_is_a_missing_sample() {
        assert_eq!(b_v_from_ut(f32::NAN), B_V_MISSING);
        assert_eq!(b_h_from_ut(f32::NAN), B_H_MISSING);
        assert_eq!(previous_b_from_ut(f32::NAN), PREVIOUS_B_MISSING);
        assert_eq!(acceleration_from_m_s2(f32::NAN), None);
        assert_eq!(orientation_from_rad(f32::NAN), None);
        assert!(b_v_ut(B_V_MISSING).is_nan() && b_h_ut(B_H_MISSING).is_nan());
        assert!(previous_b_ut(PREVIOUS_B_MISSING).is_nan());
    }

    #[test]
    fn the_ends_saturate() {
        assert_eq!(b_v_from_ut(f32::INFINITY), 30_000);
        assert_eq!(b_v_from_ut(-5000.0), -30_000);
        assert_eq!(b_h_from_ut(f32::INFINITY), 30_000);
        assert_eq!(b_h_from_ut(-3.0), 0);
        assert_eq!(previous_b_from_ut(255.4), 255);
        assert_eq!(previous_b_from_ut(1e9), 255);
        assert_eq!(previous_b_from_ut(0.0), 1);
        assert_eq!(acceleration_from_m_s2(40.0), Some(15));
        assert_eq!(acceleration_from_m_s2(-1.0), Some(0));
        assert_eq!(battery_from_mv(0), 1);
        assert_eq!(battery_from_mv(u16::MAX), 255);
    }

    #[test]
    fn orientation_wraps() {
        use core::f32::consts::{FRAC_PI_2, TAU};
        assert_eq!(orientation_from_rad(FRAC_PI_2), Some(64));
        assert_eq!(orientation_from_rad(-FRAC_PI_2), Some(192));
        assert_eq!(orientation_from_rad(TAU), Some(0));
        assert_eq!(orientation_from_rad(TAU * 0.999), Some(0));
        assert_eq!(orientation_from_rad(3.0 * TAU + FRAC_PI_2), Some(64));
        assert_eq!(orientation_from_rad(f32::INFINITY), None);
    }
}
