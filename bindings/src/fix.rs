//! Places and fixes, mirrored.

use fieldwalk::attitude;
use fieldwalk::geometry;
use fieldwalk::positioner;
use fieldwalk::time::Timestamp;

/// A point in the floor's frame: x to the right and y up on the plan, in metres.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Point2 {
    /// Metres to the right on the plan.
    pub x_m: f64,
    /// Metres up on the plan.
    pub y_m: f64,
}

/// A place on the Earth.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct LatitudeLongitude {
    /// Latitude in degrees, north positive.
    pub latitude_deg: f64,
    /// Longitude in degrees, east positive.
    pub longitude_deg: f64,
}

/// Where someone is said to be: a tap on the plan, a QR code, GNSS at the door.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct PositionHint {
    /// The place, in the floor's frame.
    pub point: Point2,
    /// How far off it may be along each axis, in metres; 0.1 to 1000.
    pub radius_m: f64,
    /// The floor's ordinal.
    pub floor: i32,
    /// When, on the clock of the samples, in nanoseconds.
    pub time_ns: i64,
    /// Which way they walk from there, if somebody knows.
    #[uniffi(default = None)]
    pub direction: Option<HintedDirection>,
}

/// Which way someone is said to walk: an arrow on the plan, the way that leads from a door.
///
/// Systems that carry a direction on by the gyroscope, the default among them, begin with this one instead of the
/// compass's.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct HintedDirection {
    /// The heading at the hint's time, in radians, clockwise from the plan's y axis.
    pub heading_rad: f64,
    /// Its standard deviation, in radians; 0.01 to π.
    pub sd_rad: f64,
}

/// What a fix rests on; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum FixMode {
    /// A start is known, no step has been seen since.
    Started,
    /// The particle filter follows the steps.
    ParticleFilter,
    /// Ranges to a cluster of beacons tell the place.
    Beacon,
    /// The phone is in a pocket or shaken, and the system pauses then: the position is the last one known, its radius
    /// grows.
    Paused,
    /// No sample for more than five seconds: the position is the last one known, its radius grows.
    Stale,
    /// Something that this boundary has no name for yet.
    Other,
}

/// How a phone is held while its owner walks; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum Attitude {
    /// Too little was heard, or something that this boundary has no name for yet.
    Unknown,
    /// Screen up, top edge ahead, about level.
    UpwardForwardHorizontal,
    /// Screen up, top edge ahead, inclined.
    UpwardForwardInclined,
    /// Screen up, top edge to a side or back.
    UpwardNotForward,
    /// The screen does not face up.
    NotUpward,
}

/// Where a phone is carried; new cases may come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
#[non_exhaustive]
pub enum CarryMode {
    /// Nothing fits, too little was heard, or something that this boundary has no name for yet.
    Unknown,
    /// In a steady hand, the screen up.
    HeldUp,
    /// In a steady hand, the screen upright with an edge up, as a camera.
    HeldUpright,
    /// At the ear.
    Calling,
    /// In a hand that swings.
    Swinging,
    /// In a front trouser pocket.
    FrontPocket,
    /// In a back trouser pocket.
    BackPocket,
    /// On something that nobody carries.
    OnTable,
}

/// A position with its accuracy.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Fix {
    /// The instant that the fix speaks of, on the clock of the samples, in nanoseconds.
    pub time_ns: i64,
    /// The floor's ordinal.
    pub floor: i32,
    /// The position, in the floor's frame.
    pub position: Point2,
    /// Latitude and longitude, where the map is georeferenced.
    pub latitude_longitude: Option<LatitudeLongitude>,
    /// Walking direction, clockwise from the plan's y, in radians from -π to π.
    pub heading_rad: f64,
    /// Walking speed, in m/s; 0 when standing.
    pub speed_m_s: f64,
    /// Variance of x, in m².
    pub covariance_xx_m2: f64,
    /// Covariance of x and y, in m².
    pub covariance_xy_m2: f64,
    /// Variance of y, in m².
    pub covariance_yy_m2: f64,
    /// The truth is within this distance 68 times of 100, in metres.
    pub radius_68_m: f64,
    /// The truth is within this distance 95 times of 100, in metres.
    pub radius_95_m: f64,
    /// What the fix rests on.
    pub mode: FixMode,
    /// How the phone is held; unknown when stale.
    pub attitude: Attitude,
    /// Where the phone is carried; unknown when stale.
    pub carry_mode: CarryMode,
}

impl From<geometry::Point2> for Point2 {
    fn from(point: geometry::Point2) -> Self {
        let geometry::Point2 { x_m, y_m } = point;
        Self { x_m, y_m }
    }
}

impl From<Point2> for geometry::Point2 {
    fn from(point: Point2) -> Self {
        let Point2 { x_m, y_m } = point;
        Self { x_m, y_m }
    }
}

impl From<PositionHint> for positioner::PositionHint {
    fn from(hint: PositionHint) -> Self {
        let PositionHint { point, radius_m, floor, time_ns, direction } = hint;
        let time = Timestamp::from_nanos(time_ns);
        Self { point: point.into(), radius_m, floor, time, direction: direction.map(Into::into) }
    }
}

impl From<HintedDirection> for positioner::HintedDirection {
    fn from(direction: HintedDirection) -> Self {
        let HintedDirection { heading_rad, sd_rad } = direction;
        Self { heading_rad, sd_rad }
    }
}

impl From<positioner::Mode> for FixMode {
    fn from(mode: positioner::Mode) -> Self {
        match mode {
            positioner::Mode::Started => Self::Started,
            positioner::Mode::ParticleFilter => Self::ParticleFilter,
            positioner::Mode::Beacon => Self::Beacon,
            positioner::Mode::Paused => Self::Paused,
            positioner::Mode::Stale => Self::Stale,
            _ => Self::Other,
        }
    }
}

impl From<attitude::Attitude> for Attitude {
    fn from(attitude: attitude::Attitude) -> Self {
        match attitude {
            attitude::Attitude::UpwardForwardHorizontal => Self::UpwardForwardHorizontal,
            attitude::Attitude::UpwardForwardInclined => Self::UpwardForwardInclined,
            attitude::Attitude::UpwardNotForward => Self::UpwardNotForward,
            attitude::Attitude::NotUpward => Self::NotUpward,
            _ => Self::Unknown,
        }
    }
}

impl From<attitude::CarryMode> for CarryMode {
    fn from(mode: attitude::CarryMode) -> Self {
        match mode {
            attitude::CarryMode::HeldUp => Self::HeldUp,
            attitude::CarryMode::HeldUpright => Self::HeldUpright,
            attitude::CarryMode::Calling => Self::Calling,
            attitude::CarryMode::Swinging => Self::Swinging,
            attitude::CarryMode::FrontPocket => Self::FrontPocket,
            attitude::CarryMode::BackPocket => Self::BackPocket,
            attitude::CarryMode::OnTable => Self::OnTable,
            _ => Self::Unknown,
        }
    }
}

impl From<positioner::Fix> for Fix {
    fn from(fix: positioner::Fix) -> Self {
        // No `..`: a new field of the core is to fail here.
        let positioner::Fix {
            time,
            floor,
            position,
            latitude_longitude_deg,
            heading_rad,
            speed_m_s,
            covariance_m2: [[covariance_xx_m2, covariance_xy_m2], [_, covariance_yy_m2]],
            radius_68_m,
            radius_95_m,
            mode,
            attitude,
            carry_mode,
        } = fix;
        Self {
            time_ns: time.as_nanos(),
            floor,
            position: position.into(),
            latitude_longitude: latitude_longitude_deg
                .map(|(latitude_deg, longitude_deg)| LatitudeLongitude { latitude_deg, longitude_deg }),
            heading_rad,
            speed_m_s,
            covariance_xx_m2,
            covariance_xy_m2,
            covariance_yy_m2,
            radius_68_m,
            radius_95_m,
            mode: mode.into(),
            attitude: attitude.into(),
            carry_mode: carry_mode.into(),
        }
    }
}
