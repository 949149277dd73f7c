//! The command line.

use crate::stages::STAGES;

pub const USAGE: &str = "\
cargo xtask test [--quick] [--only STAGE]… [--seconds N]   every check, or the stages named
cargo xtask fuzz [--seconds N]                             every fuzz target, N seconds each (20)
cargo xtask tidy                                           documents, equation list, files, manifests
cargo xtask aarch64                                        the same bits on arm64, under qemu
cargo xtask bindings                                       the library for other languages, their sources
cargo xtask kotlin                                         Kotlin's, compiled and tested on the JVM
cargo xtask swift                                          Swift's, compiled and tested on Linux
cargo xtask python                                         Python's, as a wheel, installed and tested
cargo xtask android [--json]                               the engine for phones, the AAR and its tests; or sizes alone
cargo xtask firmware [--json]                              the ID card's images, run on an emulated one
cargo xtask xcframework                                    the engine for iOS, for ios/
cargo xtask bench-jvm                                      what pushing samples costs on the JVM, as tables

stages: install format tidy clippy docs deny test bindings kotlin swift python android firmware fuzz aarch64
--quick leaves out install, deny, bindings, kotlin, swift, python, android, firmware, fuzz and
aarch64. firmware ends with its figures as a JSON object; --json leaves standard output to figures.
FIELDWALK_DATA=FOLDER       where recordings are; without it the tests that need them are skipped
FIELDWALK_REQUIRE_DATA=1    a missing recording fails instead
FIELDWALK_SWIFT_ROOT=FOLDER where Debian's Swift is unpacked, when no Swift is installed; in the cache by default
";

/// What to run.
#[derive(Debug, PartialEq)]
pub struct Arguments {
    /// Leave out the stages that install, need a network or take minutes.
    pub quick: bool,
    /// Stages to run; empty for all.
    pub only: Vec<String>,
    /// Time for each fuzz target.
    pub fuzz_seconds: u32,
    /// Print figures alone, a JSON object a line.
    pub json: bool,
}

impl Arguments {
    /// Reads the arguments after the program's name; `None` asks for the usage text.
    ///
    /// # Errors
    /// A sentence for the user when a command, an option, a stage or a number is unknown.
    pub fn parse(words: impl Iterator<Item = String>) -> Result<Option<Self>, String> {
        let mut words = words;
        let mut arguments = Self { quick: false, only: Vec::new(), fuzz_seconds: 20, json: false };
        match words.next().as_deref() {
            Some("test") => {}
            Some(
                stage @ ("fuzz" | "tidy" | "aarch64" | "bindings" | "kotlin" | "swift" | "python" | "android"
                | "bench-jvm" | "xcframework" | "firmware"),
            ) => arguments.only.push(stage.to_owned()),
            None | Some("help" | "--help" | "-h") => return Ok(None),
            Some(other) => return Err(format!("unknown command `{other}`")),
        }
        while let Some(word) = words.next() {
            match word.as_str() {
                "--quick" => arguments.quick = true,
                "--json" if arguments.only == ["android"] || arguments.only == ["firmware"] => {
                    arguments.json = true;
                }
                "--only" => {
                    let stage = words.next().ok_or("--only needs a stage")?;
                    if !STAGES.iter().any(|known| known.name == stage) {
                        return Err(format!("unknown stage `{stage}`"));
                    }
                    arguments.only.push(stage);
                }
                "--seconds" => {
                    let seconds = words.next().ok_or("--seconds needs a number")?;
                    arguments.fuzz_seconds = seconds
                        .parse()
                        .ok()
                        .filter(|&s| s > 0)
                        .ok_or(format!("`{seconds}` is not a number of seconds"))?;
                }
                "--help" | "-h" => return Ok(None),
                other => return Err(format!("unknown option `{other}`")),
            }
        }
        Ok(Some(arguments))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Option<Arguments>, String> {
        Arguments::parse(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn a_command_chooses_its_stage() {
        let fuzz = parse("fuzz --seconds 5").unwrap().unwrap();
        assert_eq!((fuzz.only, fuzz.fuzz_seconds), (vec!["fuzz".to_owned()], 5));
        let test = parse("test --quick --only docs --only deny").unwrap().unwrap();
        assert!(test.quick);
        assert!(parse("android --json").unwrap().unwrap().json);
        assert_eq!(test.only, ["docs", "deny"]);
    }

    #[test]
    fn unknown_words_are_refused() {
        for line in
            ["tset", "test --quik", "test --only nothing", "fuzz --seconds 0", "test --only", "fuzz --json"]
        {
            assert!(parse(line).is_err(), "{line}");
        }
    }

    #[test]
    fn the_usage_text_names_every_stage() {
        for stage in STAGES {
            assert!(USAGE.contains(stage.name), "{}", stage.name);
        }
    }
}
