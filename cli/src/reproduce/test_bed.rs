//! The test beds of the papers: buildings, users, phones, routes. All that is physical stands here, fixed once for all
//! claims; a claim may choose among it, and tunes nothing.
//!
//! What a paper gives is taken from it; what it leaves open is the simulator's own default, or is chosen below with the
//! reason. Systems run as their recipes say, and know nothing of this.

use fieldwalk::geometry::Point2;
use fieldwalk_sim::building::{Aisle, Building, GridBuilding};
use fieldwalk_sim::magnetic_field::SteelParams;
use fieldwalk_sim::phone::{PhoneModel, SensorModel};
use fieldwalk_sim::scenario::Scenario;
use fieldwalk_sim::walker::WalkerProfile;

/// The office of mass-centred 2019: 60 × 40 m, ceiling 3 m, corridors of 1.6 and 0.7 m, rooms between and around.
///
/// # Source
/// Extent, ceiling and widths are the paper's. The layout is ours, such that the paper's loop of 20 × 40 m exists: its
/// corridors are the wide ones.
pub fn mass_centered_office(seed: u64) -> Scenario {
    let aisles =
        |list: &[(f64, f64)]| list.iter().map(|&(centre_m, width_m)| Aisle { centre_m, width_m }).collect();
    let building: Building = GridBuilding {
        name: "mass-centered-office".into(),
        columns: aisles(&[(10.0, 1.6), (23.0, 0.7), (37.0, 0.7), (50.0, 1.6)]),
        rows: aisles(&[(10.0, 1.6), (20.0, 0.7), (30.0, 1.6)]),
        halls: Vec::new(),
        ceiling_m: 3.0,
        ..GridBuilding::office()
    }
    .build();
    Scenario::of_building(building, &CABINETS, seed)
}

/// The steel of an office along whose corridors big metal cabinets stand, which the paper calls helpful: one to every
/// four metres of corridor, of full height. The rest is the simulator's own.
const CABINETS: SteelParams = SteelParams {
    column_m2: 0.10,
    column_ut_m2: 16.0,
    beam_m2: 0.10,
    beam_ut_m2: 16.0,
    bars_per_m2: 0.25,
    reinforcement_ut_m2: 5.0,
    door_ut_m2: 3.0,
    cabinets_per_m: 0.25,
    cabinet_ut_m2: 12.0,
    lift_ut_m2: 40.0,
};

/// Corners of the loop of 40 × 20 m in [`mass_centered_office`], from its lower left, in the order in which it is walked.
pub const MASS_CENTERED_LOOP: [Point2; 4] =
    [Point2::new(10.0, 10.0), Point2::new(10.0, 30.0), Point2::new(50.0, 30.0), Point2::new(50.0, 10.0)];

/// Factors on a walker's speed for who walks slowly, normally and fast: 0.7, 1.2 and 1.7 m/s on average.
///
/// # Source
/// Ours: the range of comfortable walking is about 0.7 to 1.7 m/s.
pub const SLOW_NORMAL_FAST: [f64; 3] = [0.6, 1.0, 1.4];

/// Heights of the six users of mass-centred 2019, in metres; the fourth surveys.
///
/// # Source
/// Ours: the paper's figure names sexes, and its numbers are lost. Three of each sex, from small to tall.
pub const MASS_CENTERED_HEIGHTS_M: [f64; 6] = [1.57, 1.62, 1.68, 1.73, 1.78, 1.85];

/// The user of `height_m`, one person whatever the building.
pub fn user(height_m: f64) -> WalkerProfile {
    WalkerProfile::of_height(height_m, (1_000.0 * height_m).round() as u64)
}

/// The four phones of mass-centred 2019 by name; the first surveys.
///
/// # Source
/// Their makers do not say which parts are inside. Noise and steps of the output are those of the magnetometers usual in
/// their years (AK8975 and AK8963 at 0.3 µT, AK09911 at 0.6 µT, later ones at 0.15 µT); older gyroscopes are noisier.
/// Rates are the paper's 100 Hz. What moves with a phone, its iron, differs from copy to copy by the simulator's defaults.
pub fn mass_centered_phones() -> [(&'static str, PhoneModel); 4] {
    let phone = |field_noise_ut: f64, field_quantum_ut: f64, rate_noise_rad_s: f64| {
        let usual = PhoneModel::default().at_rates(100.0, 100.0);
        PhoneModel {
            magnetometer: SensorModel {
                noise_sd: field_noise_ut,
                quantum: field_quantum_ut,
                ..usual.magnetometer
            },
            gyroscope: SensorModel { noise_sd: rate_noise_rad_s, ..usual.gyroscope },
            ..usual
        }
    };
    [
        ("Huawei P9", phone(0.4, 0.15, 0.002)),
        ("Huawei P7", phone(0.5, 0.3, 0.003)),
        ("Samsung Note 3", phone(0.7, 0.6, 0.003)),
        ("Xiaomi M2", phone(0.7, 0.3, 0.005)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loop_is_walked_in_wide_corridors() {
        let building = mass_centered_office(1).building;
        for k in 0..4 {
            let (from, to) = (MASS_CENTERED_LOOP[k], MASS_CENTERED_LOOP[(k + 1) % 4]);
            assert!(building.is_clear(from, to) && building.ways.free_m(from, to) > 0.4, "side {k}");
        }
    }

    #[test]
    fn a_user_is_one_person() {
        assert_eq!(user(1.57), user(1.57));
        assert!(MASS_CENTERED_HEIGHTS_M.windows(2).all(|pair| user(pair[0]) != user(pair[1])));
    }
}
