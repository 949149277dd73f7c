//! The test beds of the papers: buildings, users, phones, routes. All that is physical stands here, fixed once for all
//! claims; a claim may choose among it, and tunes nothing.
//!
//! What a paper gives is taken from it; what it leaves open is the simulator's own default, or is chosen below with the
//! reason. Systems run as their recipes say, and know nothing of this.

use fieldwalk::geometry::Point2;
use fieldwalk::observation::history::HistoryFeature;
use fieldwalk::random::CounterRng;
use fieldwalk::system::{MagneticRule, Recipe};
use fieldwalk_sim::building::{Aisle, Building, GridBuilding};
use fieldwalk_sim::magnetic_field::SteelParams;
use fieldwalk_sim::phone::{PhoneModel, SensorModel};
use fieldwalk_sim::radio::RadioScene;
use fieldwalk_sim::scenario::Scenario;
use fieldwalk_sim::walker::WalkerProfile;
use rand::RngExt as _;

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
    Scenario::of_building(building, &steel_frame(), seed)
}

/// The steel of an office with a steel frame: its columns and beams keep a strong magnetisation of their own, so that
/// the compass errs by 9° along half of the corridors and by more than 25° along a tenth. The rest, cabinets too, is the
/// simulator's own.
///
/// # Source
/// Mass-centred 2019, Figs. 12 and 13: the compass is off by tens of degrees along parts of a corridor. With the
/// simulator's usual frame it would be 5° and 14°.
fn steel_frame() -> SteelParams {
    SteelParams { column_ut_m2: 40.0, beam_ut_m2: 40.0, ..SteelParams::default() }
}

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

/// Magicol as a paper that was measured against it describes it: our `dtw` over the strengths of the last `n_values` reads,
/// `reads_a_move` of each step. σ is that of `dtw` for so many values.
///
/// # Source
/// iBILL 2017, §V-B: "observing vectors and particle vectors all consist of the last 5 magnetic strength values".
/// Mass-centred 2019, the text about Fig. 28: a step costs N·M² at M Hz, so that what is warped is one step's reads; of
/// these our steps keep three.
pub fn magicol(n_values: usize, reads_a_move: u8) -> Recipe {
    let mut recipe = Recipe::dtw();
    if let MagneticRule::History(params) = &mut recipe.magnetic {
        // Of a full history of `dtw`, two values a read.
        let n_usual = 2.0 * params.window as f32;
        params.feature = HistoryFeature::Strength;
        params.window = n_values;
        params.reads_a_move = reads_a_move;
        params.sigma_ut *= (n_values as f32 / n_usual).sqrt();
    }
    Recipe { name: "magicol".into(), ..recipe }
}

/// The hall of iBILL 2017 with a cluster of three beacons 4 m apart at either end, at the height of a phone held level.
///
/// # Source
/// The distances are the paper's. It gives no height, and computes as if there were none (Eq. 31): under the ceiling of
/// six metres all beacons of a cluster are about equally far from everywhere in it.
pub fn ibill_clusters(seed: u64) -> Scenario {
    let mut hall = Scenario::of_building(Building::hall(), &SteelParams::default(), seed);
    hall.radio = RadioScene::clusters(&hall.building, seed);
    hall.radio.transmitters.iter_mut().for_each(|beacon| beacon.place_m[2] = 1.1);
    hall
}

/// A trace through that hall: from one cluster to the other and back, with two turns by chance on either way.
///
/// # Source
/// iBILL 2017, Fig. 9, draws a trace that passes both clusters; its corners are ours.
pub fn ibill_trace(seed: u64) -> Vec<Point2> {
    let mut rng = CounterRng::new(seed, 0x6962_696c);
    let mut corner =
        |low_m: f64, high_m: f64| Point2::new(rng.random_range(low_m..high_m), rng.random_range(4.0..26.0));
    let clusters = [Point2::new(5.0, 15.0), Point2::new(55.0, 15.0)];
    let out = [corner(12.0, 28.0), corner(32.0, 48.0)];
    let back = [corner(32.0, 48.0), corner(12.0, 28.0)];
    [&clusters[..1], &out, &clusters[1..], &back, &clusters[..1]].concat()
}

/// Heights of the five users of iBILL 2017, in metres, from 1.57 to the tallest's 1.95; the third surveys.
///
/// # Source
/// The ends are the paper's, those between ours.
pub const IBILL_HEIGHTS_M: [f64; 5] = [1.57, 1.65, 1.73, 1.82, 1.95];

/// The office of Kwak 2018: 20.5 × 16 m, three rooms, four access points in the corners, a steel frame.
///
/// # Source
/// Extent and rooms are the paper's, its walls ours: [`Building::card_office`]. The frame is that of the other office
/// among the test beds: Kwak 2018, Fig. 13, shows a compass that is off by tens of degrees.
///
/// In the open rooms it bends the compass little: that is within 45° of the truth for 99 % of the time. In a trial with
/// corridors 2 m wide between closed rooms (24 offices) it was so for 96 %, errors were smaller (0.86 m on average), and the
/// motion model won nothing (−0.01 ± 0.08 m); with frames three times as strong it was so for 66 %, and it won 2.3 m.
pub fn kwak_office(seed: u64) -> Scenario {
    let building = Building::card_office();
    let radio = RadioScene::corners(&building, seed);
    let steel = SteelParams { column_ut_m2: 40.0, beam_ut_m2: 40.0, ..SteelParams::default() };
    Scenario { radio, ..Scenario::of_building(building, &steel, seed) }
}

/// Length of a trajectory at least, in metres: about a minute and a quarter at the usual speed.
const KWAK_TRAJECTORY_M: f64 = 80.0;

/// One of the seven trajectories, 0 to 6, the same in every office.
///
/// # Source
/// The paper draws them in a small picture; these are walks by chance along the rooms' lanes.
pub fn kwak_trajectory(office: &Scenario, trajectory: usize) -> Vec<Point2> {
    office.building.ways.wander(7_000 + trajectory as u64, KWAK_TRAJECTORY_M)
}

/// Heights of the three testers, in metres.
///
/// # Source
/// Ours: the paper says that they differ.
pub const KWAK_HEIGHTS_M: [f64; 3] = [1.62, 1.72, 1.82];

/// The speed of five trajectories, in m/s.
///
/// # Source
/// Kwak 2018, §6.2: 1.0 to 1.1 m/s.
pub const KWAK_USUAL_M_S: f64 = 1.05;

/// A walk of Kwak 2018.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KwakWalk {
    /// The trajectory's number.
    pub trajectory: usize,
    /// How fast it is walked, in m/s.
    pub speed_m_s: f64,
    /// Height of the card over the floor, in centimetres.
    pub card_height_cm: u16,
    /// Who walks, by the order of [`KWAK_HEIGHTS_M`].
    pub tester: usize,
}

/// The walks: two trajectories at three speeds, with the card at three heights, five at the usual speed.
///
/// # Source
/// Kwak 2018, §6.2. Which height goes with which speed is ours.
pub const KWAK_PACES: [KwakWalk; 11] = {
    const fn walk(trajectory: usize, speed_m_s: f64, card_height_cm: u16, tester: usize) -> KwakWalk {
        KwakWalk { trajectory, speed_m_s, card_height_cm, tester }
    }
    [
        walk(0, 0.58, 90, 0),
        walk(0, 0.91, 110, 1),
        walk(0, 1.30, 130, 2),
        walk(1, 0.58, 130, 2),
        walk(1, 0.91, 90, 0),
        walk(1, 1.30, 110, 1),
        walk(2, KWAK_USUAL_M_S, 110, 0),
        walk(3, KWAK_USUAL_M_S, 110, 1),
        walk(4, KWAK_USUAL_M_S, 110, 2),
        walk(5, KWAK_USUAL_M_S, 110, 0),
        walk(6, KWAK_USUAL_M_S, 110, 1),
    ]
};

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
    fn trajectories_are_seven_and_clear() {
        let office = kwak_office(1);
        let paths: Vec<_> = (0..7).map(|k| kwak_trajectory(&office, k)).collect();
        for (k, path) in paths.iter().enumerate() {
            assert!(path.windows(2).all(|pair| office.building.is_clear(pair[0], pair[1])), "trajectory {k}");
            assert!(paths[..k].iter().all(|other| other != path), "trajectory {k}");
            assert_eq!(*path, kwak_trajectory(&kwak_office(2), k));
        }
    }

    #[test]
    fn a_user_is_one_person() {
        assert_eq!(user(1.57), user(1.57));
        assert!(MASS_CENTERED_HEIGHTS_M.windows(2).all(|pair| user(pair[0]) != user(pair[1])));
    }
}
