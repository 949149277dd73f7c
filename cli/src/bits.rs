//! A digest of fixes, to the bit: two machines that print the same one computed the same.

use fieldwalk::attitude::{Attitude, CarryMode};
use fieldwalk::positioner::{Fix, Mode};
use sha2::{Digest, Sha256};

/// SHA-256 over the exact bits of a sequence of fixes.
///
/// Each fix enters as: time (ns, i64), floor (i32), then as f64 x, y, heading, speed, the covariance's four numbers,
/// the 68 % and 95 % radius, latitude and longitude (NaN without a georeference), then the numbers (u8) of the mode, the
/// attitude and the carry mode. All are little-endian.
#[derive(Debug, Default)]
pub struct FixBits {
    hasher: Sha256,
}

impl FixBits {
    /// Takes `fix` in.
    pub fn push(&mut self, fix: &Fix) {
        let [[xx, xy], [yx, yy]] = fix.covariance_m2;
        let (latitude, longitude) = fix.latitude_longitude_deg.unwrap_or((f64::NAN, f64::NAN));
        let numbers = [
            fix.position.x_m,
            fix.position.y_m,
            fix.heading_rad,
            fix.speed_m_s,
            xx,
            xy,
            yx,
            yy,
            fix.radius_68_m,
            fix.radius_95_m,
            latitude,
            longitude,
        ];
        self.hasher.update(fix.time.as_nanos().to_le_bytes());
        self.hasher.update(fix.floor.to_le_bytes());
        for number in numbers {
            // One NaN for all: the sign and payload of a NaN differ between processors.
            let number = if number.is_nan() { f64::NAN } else { number };
            self.hasher.update(number.to_bits().to_le_bytes());
        }
        let numbers =
            [mode_number(fix.mode), attitude_number(fix.attitude), carry_mode_number(fix.carry_mode)];
        self.hasher.update(numbers);
    }

    /// The digest so far, in 64 hexadecimal digits.
    pub fn hex(&self) -> String {
        self.hasher.clone().finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

fn mode_number(mode: Mode) -> u8 {
    match mode {
        Mode::Started => 0,
        Mode::ParticleFilter => 1,
        Mode::Stale => 2,
        Mode::Beacon => 3,
        Mode::Paused => 4,
        _ => u8::MAX,
    }
}

fn attitude_number(attitude: Attitude) -> u8 {
    match attitude {
        Attitude::UpwardForwardHorizontal => 1,
        Attitude::UpwardForwardInclined => 2,
        Attitude::UpwardNotForward => 3,
        Attitude::NotUpward => 4,
        // What the bindings have no name for is unknown to them.
        _ => 0,
    }
}

fn carry_mode_number(mode: CarryMode) -> u8 {
    match mode {
        CarryMode::HeldUp => 1,
        CarryMode::HeldUpright => 2,
        CarryMode::Calling => 3,
        CarryMode::Swinging => 4,
        CarryMode::FrontPocket => 5,
        CarryMode::BackPocket => 6,
        CarryMode::OnTable => 7,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::geometry::Point2;
    use fieldwalk::time::Timestamp;

    fn fix() -> Fix {
        Fix {
            time: Timestamp::from_millis(1),
            floor: 0,
            position: Point2::new(1.0, 2.0),
            latitude_longitude_deg: None,
            heading_rad: 0.5,
            speed_m_s: 1.0,
            covariance_m2: [[1.0, 0.0], [0.0, 1.0]],
            radius_68_m: 1.5,
            radius_95_m: 2.5,
            mode: Mode::ParticleFilter,
            attitude: Attitude::UpwardForwardHorizontal,
            carry_mode: CarryMode::HeldUp,
        }
    }

    fn hex(fix: &Fix) -> String {
        let mut bits = FixBits::default();
        bits.push(fix);
        bits.hex()
    }

    /// The same fix and digest stand in the tests of the bindings, which compute it in their own language.
    #[test]
    fn the_digest_of_a_fix_is_known() {
        assert_eq!(hex(&fix()), "716ca978f0fc2292c308af89090d3f0fe1177a1f151aed465a23722dd4058f29");
    }

    #[test]
    fn the_last_bit_of_any_field_shows() {
        let one_bit_more = |number: f64| f64::from_bits(number.to_bits() + 1);
        let same = hex(&fix());
        assert_eq!(same, hex(&fix()));
        let others = [
            Fix { position: Point2::new(one_bit_more(1.0), 2.0), ..fix() },
            Fix { covariance_m2: [[1.0, 0.0], [0.0, one_bit_more(1.0)]], ..fix() },
            Fix { radius_95_m: one_bit_more(2.5), ..fix() },
            Fix { latitude_longitude_deg: Some((0.0, 0.0)), ..fix() },
            Fix { mode: Mode::Stale, ..fix() },
            Fix { attitude: Attitude::NotUpward, ..fix() },
            Fix { carry_mode: CarryMode::Calling, ..fix() },
            Fix { time: Timestamp::from_nanos(1_000_001), ..fix() },
        ];
        for other in others {
            assert_ne!(hex(&other), same, "{other:?}");
        }
    }
}
