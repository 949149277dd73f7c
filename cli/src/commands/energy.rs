//! `fieldwalk energy`: what an ID card draws, as ranges.

use std::io::Write;

use fieldwalk_kmx62::{Rate, Resolution, WakeUpRate};
use fieldwalk_sim::card::{CardNoise, FIELD_READINGS, READINGS};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::json;

use crate::arguments::EnergyArguments;
use crate::card_walks::{CardWalks, host_frames};
use crate::energy::{
    Budget, CAPACITIES_MAH, Design, PAPER_ACTIVE_MA, PAPER_ASLEEP_MA, PARAMETERS, Range, Sampling,
    TransmitPower, asleep_at_ua, asleep_ua, days, paper_share, range,
};
use crate::reproduce::Estimate;
use crate::reproduce::estimate::{mean_of, quantile_of};
use crate::stop::Stop;
use crate::table::{number, table};

/// Noises that the simulator is run with.
const NOISES: [(&str, CardNoise); 3] =
    [("low", CardNoise::LOW), ("middle", CardNoise::MIDDLE), ("high", CardNoise::HIGH)];

/// How the system `card` fares at a resolution.
#[derive(Debug, Serialize)]
struct Accuracy {
    resolution: &'static str,
    noise: &'static str,
    noise_ut: f64,
    median_m: f64,
    /// Of the mean error, less that at full resolution, in metres: value, and its 95 % interval.
    worse_by_m: [f64; 3],
}

/// Prints the model's results, or its parameters.
pub fn run(arguments: &EnergyArguments, out: &mut impl Write) -> Result<(), Stop> {
    if arguments.parameters {
        return print_parameters(arguments.json, out);
    }
    let accuracy = arguments.accuracy.map(measure).unwrap_or_default();
    if arguments.json { print_json(&accuracy, out) } else { print_tables(&accuracy, out) }
}

/// What each choice is worth: what it would be otherwise, and that design.
fn choices() -> [(&'static str, Design); 9] {
    let ours = Design::OURS;
    [
        ("full resolution", Design { resolution: Resolution::Maximum, ..ours }),
        ("least resolution", Design { resolution: Resolution::Averages4And2, ..ours }),
        ("acceleration at 12.5 Hz", Design { acceleration_rate: Rate::Hz12_5, ..ours }),
        ("field at 3.125 Hz", Design { field_rate: Rate::Hz3_125, ..ours }),
        ("field at 25 Hz", Design { field_rate: Rate::Hz25, ..ours }),
        ("polling instead of the buffer", Design { sampling: Sampling::Polled, ..ours }),
        ("-40 dBm", Design { power: TransmitPower::Minus40Dbm, ..ours }),
        ("0 dBm", Design { power: TransmitPower::Zero, ..ours }),
        ("no DC/DC converter", Design { has_dc_dc: false, ..ours }),
    ]
}

fn active_ua(design: &Design) -> Range {
    range(|figures| Budget::of(design, figures).active_ua())
}

/// What not sleeping would cost, while the card lies still.
fn never_asleep_ua() -> Range {
    range(|figures| Budget::of(&Design::OURS, figures).active_ua() - asleep_ua(figures))
}

fn changes_ua() -> Vec<(&'static str, Range)> {
    let ours_ua = active_ua(&Design::OURS);
    let change = |design: &Design| {
        let other_ua = active_ua(design);
        [0, 1, 2].map(|k| other_ua[k] - ours_ua[k])
    };
    let mut changes: Vec<_> = choices().iter().map(|(what, design)| (*what, change(design))).collect();
    changes.push(("no sleep: while it lies still", never_asleep_ua()));
    changes
}

/// Days at a capacity: worst, middle, best.
fn our_days(capacity_mah: f64) -> Range {
    let (active, asleep) = (active_ua(&Design::OURS), range(asleep_ua));
    [2, 1, 0].map(|k| days(capacity_mah, 1e-3 * active[k], 1e-3 * asleep[k]))
}

/// The rate of the motion engine whose middle current is nearest to the paper's asleep, and its range in mA.
fn paper_engine() -> (f64, Range) {
    use WakeUpRate::{Hz0_781, Hz1_563, Hz3_125, Hz6_25, Hz12_5, Hz25};
    let at = |rate: WakeUpRate| range(|figures| 1e-3 * asleep_at_ua(rate.hz(), figures));
    let off_ma = |rate: WakeUpRate| (at(rate)[1] - PAPER_ASLEEP_MA).abs();
    let rates = [Hz1_563, Hz3_125, Hz6_25, Hz12_5, Hz25];
    let best =
        rates.into_iter().fold(Hz0_781, |best, rate| if off_ma(rate) < off_ma(best) { rate } else { best });
    (best.hz(), at(best))
}

fn items() -> Vec<(&'static str, Range)> {
    let ranges = Budget::of(&Design::OURS, &crate::energy::Figures::ALL[1]).items();
    (0..ranges.len())
        .map(|k| (ranges[k].0, range(|figures| Budget::of(&Design::OURS, figures).items()[k].1)))
        .collect()
}

fn cpu_percent() -> Range {
    range(|figures| 100.0 * Budget::of(&Design::OURS, figures).cpu_share)
}

/// Positions the walks of `n` offices at each resolution's noise.
fn measure(n: u64) -> Vec<Accuracy> {
    let cases: Vec<(&'static str, Resolution, &'static str, CardNoise)> = NOISES
        .iter()
        .flat_map(|&(name, noise)| {
            [
                ("full", Resolution::Maximum, name, noise),
                ("32 and 16", Resolution::Averages32And16, name, noise),
                ("4 and 2", Resolution::Averages4And2, name, noise),
            ]
        })
        .collect();
    // Errors by office, then by case.
    let errors_m: Vec<Vec<Vec<f64>>> = (1..=n)
        .into_par_iter()
        .map(|seed| {
            let usual = CardWalks::of(seed);
            let office = |(_, resolution, _, noise): &(_, Resolution, _, CardNoise)| {
                let walks = usual.with_cards(|card| card.at_resolution(*resolution, noise));
                let frames: Vec<_> = walks.entries().map(|entries| host_frames(entries, 1)).collect();
                let errors_m = (0..frames.len()).flat_map(|k| walks.errors_m(k, &frames[k]));
                errors_m.filter(|error_m| error_m.is_finite()).collect::<Vec<f64>>()
            };
            cases.iter().map(office).collect()
        })
        .collect();
    cases
        .iter()
        .enumerate()
        .map(|(k, &(resolution, setting, noise, figures))| {
            // Full resolution stands first of its noise.
            let means = |k: usize| errors_m.iter().map(|office| mean_of(&office[k])).collect::<Vec<f64>>();
            let worse = Estimate::paired(&means(3 * (k / 3)), &means(k));
            Accuracy {
                resolution,
                noise,
                noise_ut: figures.sd(setting, [FIELD_READINGS, READINGS])[0],
                median_m: quantile_of(errors_m.iter().flat_map(|office| office[k].iter().copied()), 0.5),
                worse_by_m: [worse.value, worse.low, worse.high],
            }
        })
        .collect()
}

fn print_parameters(as_json: bool, out: &mut impl Write) -> Result<(), Stop> {
    if as_json {
        for parameter in PARAMETERS {
            let (name, values, source) = (parameter.name, parameter.values, parameter.source);
            writeln!(out, "{}", json!({ "name": name, "values": values, "source": source }))?;
        }
        return Ok(());
    }
    let rows = PARAMETERS.iter().map(|parameter| {
        let values = parameter.values.map(|value| format!("{value}"));
        [vec![parameter.name.to_owned()], values.to_vec(), vec![parameter.source.to_owned()]].concat()
    });
    writeln!(out, "{}", table(&["parameter", "low", "middle", "high", "source"], 1, rows))?;
    Ok(())
}

fn print_json(accuracy: &[Accuracy], out: &mut impl Write) -> Result<(), Stop> {
    let object = |pairs: &[(&'static str, Range)]| -> serde_json::Value {
        pairs
            .iter()
            .map(|(what, values)| ((*what).to_owned(), json!(values)))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    let by_capacity = |of: &dyn Fn(f64) -> serde_json::Value| -> serde_json::Value {
        CAPACITIES_MAH
            .iter()
            .map(|&mah| (format!("{mah}"), of(mah)))
            .collect::<serde_json::Map<_, _>>()
            .into()
    };
    let (engine_hz, asleep_ma) = paper_engine();
    let object = json!({
        "ours": {
            "active_ma": active_ua(&Design::OURS).map(|ua| 1e-3 * ua),
            "asleep_ma": range(asleep_ua).map(|ua| 1e-3 * ua),
            "items_ua": object(&items()),
            "days": by_capacity(&|mah| json!(our_days(mah))),
        },
        "paper": {
            "active_ma": PAPER_ACTIVE_MA,
            "asleep_ma": PAPER_ASLEEP_MA,
            "days": by_capacity(&|mah| json!(days(mah, PAPER_ACTIVE_MA, PAPER_ASLEEP_MA))),
            "share_at_full_power": paper_share(),
            "engine_hz": engine_hz,
            "engine_asleep_ma": asleep_ma,
        },
        "choices": object(&changes_ua()),
        "cpu_percent": cpu_percent(),
        "accuracy": accuracy,
        "kind": "modelled, not measured",
    });
    writeln!(out, "{object}")?;
    Ok(())
}

fn print_tables(accuracy: &[Accuracy], out: &mut impl Write) -> Result<(), Stop> {
    let row = |what: &str, values: Range, decimals: usize| {
        [vec![what.to_owned()], values.map(|value| number(value, decimals)).to_vec()].concat()
    };
    writeln!(
        out,
        "Modelled, not measured: all figures at their frugal end, in the middle, at their dear end.\n"
    )?;
    let mut rows: Vec<_> = items().into_iter().map(|(what, values)| row(what, values, 1)).collect();
    rows.push(row("active, together", active_ua(&Design::OURS), 1));
    rows.push(row("asleep", range(asleep_ua), 1));
    writeln!(out, "{}\n", table(&["µA", "low", "middle", "high"], 1, rows))?;
    let [low, middle, high] = cpu_percent();
    writeln!(out, "Processor active {low:.2}, {middle:.2}, {high:.2} % of the time at 64 MHz.\n")?;
    let paper = |mah: f64| number(days(mah, PAPER_ACTIVE_MA, PAPER_ASLEEP_MA), 0);
    let rows = CAPACITIES_MAH
        .iter()
        .map(|&mah| [row(&format!("{mah} mAh"), our_days(mah), 0), vec![paper(mah)]].concat());
    writeln!(
        out,
        "{}\n",
        table(&["days at 8 h a day", "worst", "middle", "best", "paper's currents"], 1, rows)
    )?;
    let [frugal, middle, dear] = paper_share().map(|share| 100.0 * share);
    writeln!(
        out,
        "The paper's {PAPER_ACTIVE_MA} mA: its schedule with the sensor at full power for {middle:.0} % of the time \
         ({dear:.0} to {frugal:.0}), as three starts a second of a tenth each."
    )?;
    let (engine_hz, [low_ma, middle_ma, high_ma]) = paper_engine();
    writeln!(
        out,
        "The paper's {PAPER_ASLEEP_MA} mA asleep: a motion engine at {engine_hz} Hz draws {middle_ma:.4} mA \
         ({low_ma:.4} to {high_ma:.4}).\n"
    )?;
    let rows = changes_ua().into_iter().map(|(what, values)| row(what, values, 1));
    writeln!(out, "{}", table(&["were it otherwise, µA more", "low", "middle", "high"], 1, rows))?;
    if !accuracy.is_empty() {
        let rows = accuracy.iter().map(|row| {
            let [value, low, high] = row.worse_by_m;
            vec![
                row.resolution.to_owned(),
                row.noise.to_owned(),
                number(row.noise_ut, 2),
                number(row.median_m, 2),
                format!("{} ({} to {})", number(value, 2), number(low, 2), number(high, 2)),
            ]
        });
        let header = ["resolution", "noise", "µT", "median m", "mean m more than full"];
        writeln!(out, "\n{}", table(&header, 2, rows))?;
    }
    Ok(())
}
