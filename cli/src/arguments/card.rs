//! What can be asked for of the ID card.

use std::path::PathBuf;

use clap::Args;

/// Readings of a simulated card's sensor for its firmware, and what the frames are worth that this makes of them.
///
/// `cargo xtask firmware` calls this: the walks of Kwak 2018 in its office, once to write the readings, once with
/// --score to compare the emulated card's frames with the host's and to position the wearer from them.
#[derive(Debug, Args)]
pub struct CardWalksArguments {
    /// Where walk-01.readings and so on go, and where walk-01.frames and so on are: a folder, made if need be.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,

    /// Score the frames in DIR, and print one JSON object.
    #[arg(long)]
    pub score: bool,

    /// Random seed, 0 to 2^64 - 1: of the office, its walkers, their cards.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// What an ID card draws from its battery, and how long that lasts: modelled, not measured.
///
/// The sensor's current at low power, its start-up and its noise are not published; every such figure is a parameter with
/// a low, a middle and a high value (--parameters lists them with their sources), and results are ranges: all parameters at
/// their frugal end, in the middle, at their dear end at once. Resolution is one parameter of the energy and of the noise:
/// with --accuracy the walks of Kwak 2018 are positioned with the noise of each resolution.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk energy
  fieldwalk energy --parameters
  fieldwalk energy --accuracy 12 --json

JSON: one object.
  ours          active_ma, asleep_ma, items_ua: [low, middle, high] each; days: by
                capacity in mAh, at 8 h a day active, [worst, middle, best]
  paper         active_ma and asleep_ma as printed; days by capacity; the share of time
                at full power that the model gives 0.159 mA at, [low, middle, high]; the
                rate of the motion engine at which it is nearest to 0.004 mA, in Hz
  choices       what, and the change of the active current in µA if it were made
                otherwise, [low, middle, high]
  cpu_percent   share of time that the processor is active, [low, middle, high]
  accuracy      with --accuracy: for each resolution and noise, the field's noise in µT,
                the median error in metres, and by how much the mean error differs from
                that at full resolution, with its 95 % interval over offices

See `fieldwalk --help` for the exit codes.")]
pub struct EnergyArguments {
    /// List the parameters instead.
    #[arg(long, conflicts_with = "accuracy")]
    pub parameters: bool,

    /// Also position walks in so many offices, 2 to 100, at each resolution's noise; takes about half a minute an office.
    #[arg(long, value_name = "OFFICES", value_parser = clap::value_parser!(u64).range(2..=100))]
    pub accuracy: Option<u64>,

    /// Print one JSON object instead of tables.
    #[arg(long)]
    pub json: bool,
}
