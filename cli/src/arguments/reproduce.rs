//! What can be asked of `fieldwalk reproduce`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Which papers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PaperChoice {
    /// The card with access points.
    #[value(name = "kwak2018")]
    Kwak2018,
    /// The phone without infrastructure, of 2019.
    MassCentered,
    /// iBeacons in open halls, of 2017.
    Ibill,
    /// The sensor at the waist, of 2016.
    Wila,
    /// Few particles at similar intensities, of 2014.
    Song,
    /// All five.
    All,
}

/// Run the papers' experiments on simulated test beds and judge every claim.
///
/// Each claim is a row: the paper's value, ours, the 95 % interval over seeds, and whether the claim holds. An order holds
/// when the whole interval of the paired difference is on its side; a figure holds within its stated tolerance. A claim
/// that fails is told as failed, with the likely cause.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  fieldwalk reproduce all --report papers.html
  fieldwalk reproduce mass-centered --json
  fieldwalk reproduce song --seeds 2
      # quick; orders need two seeds at least, and few seeds prove little

JSON: one object a claim.
  id, paper, claim, unit, paper_value (null where the paper gives none)
  ours, low, high     the value and its 95 % interval; of the first part that fails,
                      else of the first
  holds               whether every part passes its test
  cause               the likely cause of a failure, else null
  seeds               number of seeds behind it
  parts               what, test, ours, low, high, holds
A number that does not exist is null.

The same seeds give the same numbers but for the claims about time, which are
measured alone after all others. The exit code is 0 when every claim was judged,
whether or not it holds; with --strict, 1 when one fails. See `fieldwalk --help` for
the other exit codes.")]
pub struct ReproduceArguments {
    /// Whose claims.
    #[arg(value_name = "PAPER")]
    pub paper: PaperChoice,

    /// At most this many seeds for each claim, 1 to 1000 [default: as many as its interval needs].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000))]
    pub seeds: Option<u64>,

    /// Only these claims, by their ids, separated by commas.
    #[arg(long, value_name = "IDS", value_delimiter = ',')]
    pub only: Vec<String>,

    /// A JSON array of claims, each with an `id` and a `paper`; fails unless each is measured.
    #[arg(long, value_name = "FILE.json")]
    pub claims: Option<PathBuf>,

    /// Fail when a claim does not hold.
    #[arg(long)]
    pub strict: bool,

    /// Write a page with the claims and the plots: one HTML file, replaced if it is there.
    #[arg(long, value_name = "FILE.html")]
    pub report: Option<PathBuf>,

    /// Print one JSON object a claim instead of a table.
    #[arg(long)]
    pub json: bool,
}
