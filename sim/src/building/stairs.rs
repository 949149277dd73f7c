//! Stairs: two flights and a landing between one storey and the next.

use fieldwalk::geometry::Point2;

use crate::building::Rectangle;

/// Depth of a tread, in metres.
///
/// # Source
/// The going of 0.29 m that goes with a rise of 0.17 m by Blondel's rule (twice the rise and the going make 0.63 m).
pub(crate) const GOING_M: f64 = 0.29;
/// Treads of one flight.
const TREADS: f64 = 10.0;
/// Distance between the middles of two flights, in metres.
const ASIDE_M: f64 = 1.3;
/// Width of the landing, in metres.
const LANDING_M: f64 = 1.1;

/// A staircase: a line from the corridor of one storey up to the same corridor a storey higher.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stairs {
    /// The line, as on the plan; its ends are in the corridor.
    pub line: Vec<Point2>,
    /// For each point of the line, the share of the storey's height that is climbed.
    pub climbed: Vec<f64>,
}

impl Stairs {
    /// Stairs in `room`, whose door opens upward on the plan onto a corridor with its middle at `corridor_m`.
    pub(super) fn in_room(room: &Rectangle, corridor_m: f64) -> Self {
        let (x_m, top_m) = (room.centre().x_m, room.high.y_m);
        let (first_m, last_m) = (top_m - 1.0, top_m - 1.0 - TREADS * GOING_M);
        let (up_m, down_m) = (x_m - 0.5 * ASIDE_M, x_m + 0.5 * ASIDE_M);
        let landing_m = last_m - 0.5 * LANDING_M;
        let points = [
            (x_m, corridor_m, 0.0),
            (x_m, top_m - 0.3, 0.0),
            (up_m, first_m, 0.0),
            (up_m, last_m, 0.5),
            (up_m, landing_m, 0.5),
            (down_m, landing_m, 0.5),
            (down_m, last_m, 0.5),
            (down_m, first_m, 1.0),
            (x_m, top_m - 0.3, 1.0),
            (x_m, corridor_m, 1.0),
        ];
        Self {
            line: points.iter().map(|&(x_m, y_m, _)| Point2::new(x_m, y_m)).collect(),
            climbed: points.iter().map(|&(_, _, share)| share).collect(),
        }
    }
}
