//! Attitudes and turning rates of carried phones: simulated ways to carry beside motion capture.

use std::error::Error;

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk_formats::tyrex::{Motion, find_trials};
use fieldwalk_sim::phone::CarryMode;
use fieldwalk_tests::recordings::tyrex_attitude;

use crate::gait::simulated;
use crate::motion::{Force, Walking};
use crate::page::Page;
use crate::spread::{Spread, boxes};

const ALIKE: [(Motion, CarryMode, &str); 6] = [
    (Motion::Texting, CarryMode::HeldLevel, "texting"),
    (Motion::AugmentedReality, CarryMode::HeldUpright, "camera held up"),
    (Motion::Phoning, CarryMode::AtEar, "phoning"),
    (Motion::Swinging, CarryMode::SwingingHand, "swinging"),
    (Motion::FrontPocket, CarryMode::FrontPocket, "front pocket"),
    (Motion::BackPocket, CarryMode::BackPocket, "back pocket"),
];

/// What one recording says of how the phone was carried.
struct Held {
    /// Root mean square of the angular rate in stretches that are straight, in rad/s.
    rate_rms: f64,
    vertical_rms: f64,
    step_hz: f64,
    /// The share of gravity on the axis that has most of it.
    up: [f64; 3],
}

/// By windows of three seconds, of which the half with the least turning about the vertical counts: the laboratory is small.
fn held(samples: &[Sample]) -> Option<Held> {
    let force = Force::of(samples)?;
    let rates: Vec<(f64, [f64; 3])> = samples
        .iter()
        .filter_map(|sample| match sample.reading {
            Reading::AngularRate(rate) => Some((sample.time.secs_since(force.start), rate.map(f64::from))),
            _ => None,
        })
        .collect();
    let mut windows: Vec<(f64, f64)> = Vec::new();
    let mut sum_up = [0.0; 3];
    for (k, part) in force.values.chunks_exact(300).enumerate() {
        let sum = part.iter().fold([0.0; 3], |sum, f| [0, 1, 2].map(|c| sum[c] + f[c]));
        let long = sum.iter().map(|c| c * c).sum::<f64>().sqrt();
        let up = sum.map(|c| c / long);
        sum_up = [0, 1, 2].map(|c| sum_up[c] + up[c]);
        let (from_s, to_s) = (3.0 * k as f64, 3.0 * (k + 1) as f64);
        let inside: Vec<[f64; 3]> =
            rates.iter().filter(|(t, _)| (from_s..to_s).contains(t)).map(|(_, rate)| *rate).collect();
        let n = inside.len() as f64;
        if n < 30.0 {
            continue;
        }
        let square: f64 = inside.iter().flatten().map(|c| c * c).sum();
        let turning: f64 = inside.iter().map(|r| r[0] * up[0] + r[1] * up[1] + r[2] * up[2]).sum();
        windows.push(((turning / n).abs(), (square / n).sqrt()));
    }
    windows.sort_by(|a, b| a.0.total_cmp(&b.0));
    windows.truncate(windows.len().div_ceil(2));
    let gait: Vec<Walking> = force.windows();
    let middle =
        |value: fn(&Walking) -> f64| Spread::new("", true, gait.iter().map(value).collect()).quantile(0.5);
    let long = sum_up.iter().map(|c| c * c).sum::<f64>().sqrt();
    Some(Held {
        rate_rms: Spread::new("", true, windows.iter().map(|w| w.1).collect()).quantile(0.5),
        vertical_rms: middle(|w| w.vertical_rms),
        step_hz: middle(|w| w.step_hz),
        up: sum_up.map(|c| c / long),
    })
}

pub fn write(page: &mut Page) -> Result<(), Box<dyn Error>> {
    page.heading("Ways to carry");
    page.say(
        "Beside the attitude benchmark of Tyrex: one person, two phones, two minutes each on short loops at 0.7 to 1.0 m/s, \
         slower than the simulated walkers' 1.2 m/s. *Up* is the direction of gravity in the device frame (x right, y to the \
         top edge, z out of the screen), averaged over the recordings; the real pockets hold the phone with its top edge up, \
         as it happened, the simulated front pocket with its top edge down; the ear is the left one there, the right one here; the \
         real camera was held across.",
    );
    let trials = match tyrex_attitude() {
        Some(folder) => find_trials(&folder)?.trials,
        None => Vec::new(),
    };
    let head =
        ["carried", "", "angular rate, rms (rad/s)", "vertical acceleration, rms (m/s²)", "step (Hz)", "up"];
    let mut rows = vec![head.map(String::from).to_vec()];
    let mut spreads = Vec::new();
    for (motion, mode, name) in ALIKE {
        let mut real = Vec::new();
        for trial in trials.iter().filter(|trial| trial.motion == motion && !trial.is_disturbed) {
            real.extend(held(&trial.samples()?.samples));
        }
        let made: Vec<Held> = simulated(mode).iter().filter_map(|(samples, _)| held(samples)).collect();
        for (kind, helds) in [("real", real), ("simulated", made)] {
            if helds.is_empty() {
                continue;
            }
            let is_real = kind == "real";
            let spread =
                |value: fn(&Held) -> f64| Spread::new(name, is_real, helds.iter().map(value).collect());
            let n = helds.len() as f64;
            let up = helds.iter().fold([0.0; 3], |sum, h| [0, 1, 2].map(|c| sum[c] + h.up[c] / n));
            rows.push(vec![
                name.into(),
                kind.into(),
                spread(|h| h.rate_rms).text(),
                spread(|h| h.vertical_rms).text(),
                spread(|h| h.step_hz).text(),
                format!("{:.2}, {:.2}, {:.2}", up[0], up[1], up[2]),
            ]);
            spreads.push(spread(|h| h.rate_rms));
        }
    }
    page.table(&rows);
    let svg = boxes("Angular rate by the way to carry", "root mean square (rad/s)", &spreads);
    page.picture("angular-rate", "angular rate by the way to carry", &svg)?;
    Ok(())
}
