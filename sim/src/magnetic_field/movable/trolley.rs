//! Trolleys, prams and tool cases that are pushed along corridors and over squares.

use fieldwalk::geometry::{Point2, Segment};

use crate::building::Building;
use crate::magnetic_field::{MovableParams, Source};
use crate::noise::{Noise, smooth_step};
use crate::vector::Vector3;

/// People step aside for a trolley: it passes so far from the phone's way, in metres, at least.
const ASIDE_M: f64 = 0.6;
/// Over so much of its way, at either end, a trolley comes out of a room and goes into one.
const ROOM_SHARE: f64 = 0.03;

/// A dipole that goes along a line at an even pace.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trolley {
    line: Segment,
    start_s: f64,
    end_s: f64,
    height_m: f64,
    moment_ut_m3: Vector3,
}

/// The trolleys that are on their way in `building` during a walk.
pub(super) fn trolleys(
    building: &Building,
    params: &MovableParams,
    duration_s: f64,
    seed: u64,
) -> Vec<Trolley> {
    let corridors = building.corridors.iter().map(|corridor| (corridor.line, corridor.width_m));
    let squares = building.squares.iter().map(|square| {
        let middle = square.centre();
        let line = Segment {
            a: Point2::new(square.low.x_m, middle.y_m),
            b: Point2::new(square.high.x_m, middle.y_m),
        };
        (line, square.high.y_m - square.low.y_m)
    });
    let mut trolleys = Vec::new();
    for ((line, width_m), index) in corridors.chain(squares).zip(0u64..) {
        let mut noise = Noise::new(seed, "trolleys", index);
        for start_s in noise.arrivals_s(-60.0, duration_s, params.trolleys_per_minute, 0.0) {
            let line = if noise.chance(0.5) { line } else { Segment { a: line.b, b: line.a } };
            let along = line.b - line.a;
            // In what is wide they go anywhere.
            let aside_m = noise.within(ASIDE_M, ASIDE_M.max(0.5 * width_m - 0.5));
            let aside = Point2::new(along.y_m, -along.x_m) * (aside_m / along.norm_m().max(1e-9));
            let line = Segment { a: line.a + aside, b: line.b + aside };
            let end_s = start_s + along.norm_m() / noise.within(0.8, 1.3);
            let height_m = noise.within(0.2, 0.7);
            let moment_ut_m3 = noise.normal3(params.trolley_ut_m3);
            trolleys.push(Trolley { line, start_s, end_s, height_m, moment_ut_m3 });
        }
    }
    trolleys
}

impl Trolley {
    /// The trolley at `time_s`, if it is on its way.
    pub(super) fn at(&self, time_s: f64) -> Option<Source> {
        let share = (time_s - self.start_s) / (self.end_s - self.start_s);
        let p = self.line.a.lerp(self.line.b, share);
        let seen = smooth_step(share / ROOM_SHARE) * smooth_step((1.0 - share) / ROOM_SHARE);
        let moment_ut_m3 = self.moment_ut_m3.map(|c| c * seen);
        let source = Source::Dipole { place_m: [p.x_m, p.y_m, self.height_m], moment_ut_m3 };
        (0.0..=1.0).contains(&share).then_some(source)
    }
}
