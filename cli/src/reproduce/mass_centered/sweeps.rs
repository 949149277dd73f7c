//! The weight's parameters swept: window `W` and threshold `T`, by the field's strength alone, as in the paper.

use fieldwalk::observation::mass_centered::MassCenteredParams;
use fieldwalk::system::{MagneticRule, Recipe};

use crate::plot::{Chart, Series, cdf};
use crate::reproduce::estimate::mean_of;
use crate::reproduce::{Estimate, Finding, Findings, Picture};

/// Short windows, then long ones, in steps.
const SHORT: [usize; 5] = [1, 2, 3, 4, 5];
const LONG: [usize; 4] = [6, 9, 12, 15];
/// The threshold of the window's sweep, in µT.
///
/// # Source
/// Mass-centred 2019, Fig. 22.
const THRESHOLD_OF_WINDOWS_UT: f32 = 0.5;
/// Thresholds in µT, the last the one said to be worst; at the recipe's window.
///
/// # Source
/// Mass-centred 2019, Fig. 24.
const THRESHOLDS_UT: [f32; 5] = [0.01, 0.05, 0.1, 0.5, 1.1];

/// What one building gave: errors in metres.
pub struct Measured {
    /// By window.
    windows: Vec<Vec<f64>>,
    /// By threshold.
    thresholds: Vec<Vec<f64>>,
}

/// Measures with `errors_m`, which runs a recipe over all walks.
pub fn measure(errors_m: impl Fn(&Recipe) -> Vec<f64>) -> Measured {
    let with = |change: &dyn Fn(&mut MassCenteredParams)| {
        let mut recipe = Recipe::mass_centered();
        if let MagneticRule::MassCentered(params) = &mut recipe.magnetic {
            params.direction = None;
            change(params);
        }
        errors_m(&recipe)
    };
    let window = |window: usize| {
        with(&|params| (params.window, params.threshold_ut) = (window, THRESHOLD_OF_WINDOWS_UT))
    };
    Measured {
        windows: SHORT.into_iter().chain(LONG).map(window).collect(),
        thresholds: THRESHOLDS_UT.map(|ut| with(&|params| params.threshold_ut = ut)).into(),
    }
}

/// Adds what the sweeps say.
pub fn conclude(findings: Findings, seeds: &[&Measured]) -> Findings {
    let n = seeds.len();
    let window_m = |k: usize| -> Vec<f64> { seeds.iter().map(|one| mean_of(&one.windows[k])).collect() };
    let threshold_m =
        |k: usize| -> Vec<f64> { seeds.iter().map(|one| mean_of(&one.thresholds[k])).collect() };
    let mean_over = |from: usize, to: usize| -> Vec<f64> {
        (0..n).map(|seed| mean_of(&(from..to).map(|k| window_m(k)[seed]).collect::<Vec<_>>())).collect()
    };
    let (short, long) = (mean_over(0, SHORT.len()), mean_over(SHORT.len(), SHORT.len() + LONG.len()));
    let worst = THRESHOLDS_UT.len() - 1;
    let orders: Vec<Estimate> =
        (0..worst).map(|k| Estimate::paired(&threshold_m(k), &threshold_m(worst))).collect();
    let windows = SHORT.iter().chain(&LONG);
    let points = windows.enumerate().map(|(k, &window)| (window as f64, mean_of(&window_m(k)))).collect();
    let sweep = Chart::new("Window", "W (steps)", "mean error (m)").with(Series::line("mean error", points));
    let pooled: Vec<Vec<f64>> = (0..THRESHOLDS_UT.len())
        .map(|k| seeds.iter().flat_map(|one| one.thresholds[k].iter().copied()).collect())
        .collect();
    let names = THRESHOLDS_UT.map(|ut| format!("T = {ut} µT"));
    let lines: Vec<(&str, &[f64])> =
        names.iter().zip(&pooled).map(|(name, errors)| (&name[..], &errors[..])).collect();
    findings
        .with(Finding::new("mc-window", n, [Estimate::paired(&short, &long)]).because(
            "corridors leave the particles so little room that 3000 of them suffice for long windows too",
        ))
        .with(Finding::new("mc-threshold", n, orders).because(
            "changes of strength at the true place differ from the map's by 0.8 µT in the middle, where reading errs by \
             0.3 µT: the map blurs, since surveyors hold the phone ahead of them and walk both ways; lower thresholds \
             choose by chance",
        ))
        .with_picture(Picture::of("The window swept at T = 0.5 µT.", sweep.to_svg()))
        .with_picture(Picture::of(
            "The threshold swept at the recipe's window.",
            cdf("Threshold", "error (m)", &lines).to_svg(),
        ))
}
