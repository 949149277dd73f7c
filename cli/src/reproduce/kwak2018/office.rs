//! The office, who walks in it, and the systems that are compared.

use fieldwalk::observation::history::{HistoryMetric, HistoryParams};
use fieldwalk::system::{HeadingRule, LengthRule, MagneticRule, Recipe};
use fieldwalk_sim::card::CardModel;
use fieldwalk_sim::scenario::Walk;

use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::test_bed::{self, KWAK_HEIGHTS_M, KWAK_PACES, KwakWalk};

/// The office, surveyed by phone beside a card whose strength the access points tell.
///
/// # Source
/// Kwak 2018, §5.2: `B_h`, `B_v` and the strengths at the access points, collected with a phone.
pub fn surveyed(seed: u64) -> Surveyed {
    let card = CardModel { sends_frames: false, ..CardModel::default() };
    Surveyed::of(test_bed::kwak_office(seed), |walk| Walk { card: Some(card), ..walk })
}

/// The walk number `k` of [`KWAK_PACES`] in the office of `seed`; every one is of its own chance.
pub fn walk(office: &Surveyed, k: usize, seed: u64) -> Walk {
    let KwakWalk { trajectory, speed_m_s, card_height_cm, tester } = KWAK_PACES[k];
    let path = test_bed::kwak_trajectory(&office.scenario, trajectory);
    let card = CardModel { height_cm: card_height_cm, ..CardModel::default() };
    let mut walker = test_bed::user(KWAK_HEIGHTS_M[tester]);
    walker.speed_m_s = speed_m_s;
    let usual = Walk::along(format!("walk-{k}"), path, 1_000 * seed + k as u64);
    Walk { walker, card: Some(card), device: 10 * seed + tester as u64, ..usual }
}

fn with_history(change: impl FnOnce(&mut HistoryParams)) -> Recipe {
    let mut recipe = Recipe::card();
    if let MagneticRule::History(params) = &mut recipe.magnetic {
        change(params);
    }
    recipe
}

/// `EUC` with that many particles.
pub fn euclidean(n_particles: usize) -> Recipe {
    Recipe { n_particles, ..Recipe::card() }
}

/// `DTW` with that many particles.
pub fn warping(n_particles: usize) -> Recipe {
    let recipe = with_history(|params| params.metric = HistoryMetric::DynamicTimeWarping { band: None });
    Recipe { n_particles, ..recipe }
}

/// Histories of so many seconds.
pub fn remembering(seconds: usize) -> Recipe {
    with_history(|params| params.window = 3 * seconds)
}

/// `PDR_RAW`: every particle takes the raw orientation.
pub fn raw_heading() -> Recipe {
    let mut recipe = Recipe::card();
    if let HeadingRule::Pathway(params) = &mut recipe.motion.heading {
        (params.by_compass, params.by_last_heading) = (0.0, 0.0);
    }
    recipe
}

/// Without the heuristics: the dead are not replenished but the living resampled, and strides vary as those of others.
///
/// # Source
/// Kwak 2018, §5.3.5 and Fig. 17; σ = 0.2 l is the paper's for others.
pub fn plain() -> Recipe {
    let mut recipe = Recipe { replenish: None, resample_below: 1.0, ..Recipe::card() };
    if let LengthRule::Alike { mean_m, round_sd_m } = &mut recipe.motion.length {
        *round_sd_m = 0.2 * *mean_m;
    }
    recipe
}

/// Without the filter of the start.
pub fn unfiltered() -> Recipe {
    Recipe { ble_filter: None, ..Recipe::card() }
}
