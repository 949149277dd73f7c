//! Cars of lifts that travel while one walks by.

use fieldwalk::geometry::Point2;

use crate::building::Building;
use crate::magnetic_field::{MovableParams, Source};
use crate::noise::{Noise, smooth_step};

/// Speed of a car, in m/s, and its height, in metres.
const SPEED_M_S: f64 = 1.0;
const CAR_M: f64 = 2.2;

/// A car that travels in its shaft.
#[derive(Clone, Debug)]
pub(super) struct Car {
    place: Point2,
    pole_ut_m2: f64,
    start_m: f64,
    /// When each trip begins, in seconds, and where it leads, in metres over the floor.
    trips: Vec<(f64, f64)>,
}

/// The cars of `building`: each serves the floor, one below and one above.
pub(super) fn cars(
    building: &Building,
    params: &MovableParams,
    duration_s: f64,
    [building_seed, seed]: [u64; 2],
) -> Vec<Car> {
    let storey_m = building.ceiling_m + 0.5;
    let car = |(shaft, index)| {
        let shaft: &crate::building::Rectangle = shaft;
        let pole_ut_m2 = Noise::new(building_seed, "lift car", index).normal(params.car_ut_m2);
        let mut today = Noise::new(seed, "lift trips", index);
        let stop = |noise: &mut Noise| storey_m * (noise.index(3) as f64 - 1.0);
        let start_m = stop(&mut today);
        let long_s = 2.0 * storey_m / SPEED_M_S;
        let starts_s = today.arrivals_s(0.0, duration_s, params.lift_trips_per_minute, long_s);
        let trips = starts_s.into_iter().map(|start_s| (start_s, stop(&mut today))).collect();
        Car { place: shaft.centre(), pole_ut_m2, start_m, trips }
    };
    building.lifts.iter().zip(0u64..).map(car).collect()
}

impl Car {
    /// The car at `time_s`.
    pub(super) fn at(&self, time_s: f64) -> Source {
        let mut floor_m = self.start_m;
        for &(start_s, to_m) in &self.trips {
            let long_s = ((to_m - floor_m).abs() / SPEED_M_S).max(1e-3);
            floor_m += (to_m - floor_m) * smooth_step((time_s - start_s) / long_s);
        }
        let at = |height_m: f64| [self.place.x_m, self.place.y_m, height_m];
        Source::Bar {
            north_pole_m: at(floor_m + 0.2 + CAR_M),
            south_pole_m: at(floor_m + 0.2),
            pole_ut_m2: self.pole_ut_m2,
        }
    }
}
