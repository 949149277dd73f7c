//! Monotonic time: instants and signed spans in nanoseconds.

use core::ops::{Add, Neg, Sub};

use serde::{Deserialize, Serialize};

/// An instant on the device's monotonic clock, in nanoseconds since an arbitrary origin.
///
/// The origin is whatever the sensor source uses (boot, Unix epoch): only differences carry meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Timestamp {
    ns: i64,
}

/// A signed span between two [`Timestamp`]s, in nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Duration {
    ns: i64,
}

impl Timestamp {
    /// The earliest instant that can be represented.
    pub const MIN: Self = Self { ns: i64::MIN };
    /// The latest instant that can be represented.
    pub const MAX: Self = Self { ns: i64::MAX };

    /// The instant `ns` nanoseconds after the origin.
    pub const fn from_nanos(ns: i64) -> Self {
        Self { ns }
    }

    /// The instant `ms` milliseconds after the origin; saturates at the ends of the range.
    pub const fn from_millis(ms: i64) -> Self {
        Self { ns: ms.saturating_mul(1_000_000) }
    }

    /// Nanoseconds after the origin.
    pub const fn as_nanos(self) -> i64 {
        self.ns
    }

    /// Seconds from `earlier` to `self`; negative when `earlier` is later.
    pub fn secs_since(self, earlier: Self) -> f64 {
        (self - earlier).as_secs_f64()
    }

    /// The instant halfway between `self` and `other`.
    pub const fn midpoint(self, other: Self) -> Self {
        Self { ns: self.ns.midpoint(other.ns) }
    }
}

impl Duration {
    /// No time at all.
    pub const ZERO: Self = Self { ns: 0 };

    /// A span of `ns` nanoseconds.
    pub const fn from_nanos(ns: i64) -> Self {
        Self { ns }
    }

    /// A span of `ms` milliseconds; saturates at the ends of the range.
    pub const fn from_millis(ms: i64) -> Self {
        Self { ns: ms.saturating_mul(1_000_000) }
    }

    /// A span of `s` seconds, rounded to the nanosecond; NaN gives zero and infinities saturate.
    pub fn from_secs_f64(s: f64) -> Self {
        Self { ns: (s * 1e9) as i64 }
    }

    /// The span in nanoseconds.
    pub const fn as_nanos(self) -> i64 {
        self.ns
    }

    /// The span in seconds.
    pub fn as_secs_f64(self) -> f64 {
        self.ns as f64 * 1e-9
    }
}

impl Sub for Timestamp {
    type Output = Duration;
    fn sub(self, earlier: Self) -> Duration {
        Duration { ns: self.ns.saturating_sub(earlier.ns) }
    }
}

impl Add<Duration> for Timestamp {
    type Output = Self;
    fn add(self, span: Duration) -> Self {
        Self { ns: self.ns.saturating_add(span.ns) }
    }
}

impl Sub<Duration> for Timestamp {
    type Output = Self;
    fn sub(self, span: Duration) -> Self {
        Self { ns: self.ns.saturating_sub(span.ns) }
    }
}

impl Add for Duration {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { ns: self.ns.saturating_add(other.ns) }
    }
}

impl Neg for Duration {
    type Output = Self;
    fn neg(self) -> Self {
        Self { ns: self.ns.saturating_neg() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_signed_and_saturate() {
        let a = Timestamp::from_millis(1_000);
        let b = Timestamp::from_millis(1_250);
        assert_eq!((b - a).as_nanos(), 250_000_000);
        assert_eq!(a.secs_since(b), -0.25);
        assert_eq!(Timestamp::MAX - Timestamp::MIN, Duration::from_nanos(i64::MAX));
        assert_eq!(a.midpoint(b), Timestamp::from_millis(1_125));
        assert_eq!(Duration::from_secs_f64(f64::NAN), Duration::ZERO);
    }
}
