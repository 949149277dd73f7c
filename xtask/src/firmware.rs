//! The ID card's firmware: built for its chip and for an emulated one, run there, compared with this machine's build.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::elf::Footprint;
use crate::firmware_toolchain::{TARGET, Toolchain};
use crate::install;
use crate::process::{find_program, output_of, run as execute};
use crate::report::Outcome;
use crate::workspace::Workspace;

pub const QEMU: &str = "qemu-system-arm";
pub const QEMU_PACKAGES: &[&str] = &["qemu-system-arm"];
/// The image must fit into a quarter of the flash, and into three eighths of the RAM.
const MAX_FLASH_BYTES: u64 = 128 * 1_024;
const MAX_RAM_BYTES: u64 = 24 * 1_024;
/// Two minutes of walking at least.
const MIN_ROUNDS: f64 = 120.0;
/// Kwak 2018, §6.2.
const MAX_MEDIAN_M: f64 = 1.62;
/// Far longer than the walks take.
const EMULATOR_TIMEOUT: Duration = Duration::from_secs(300);

/// What came out, one name and number each, as JSON has them.
type Figures = Vec<(&'static str, String)>;

pub fn run(workspace: &Workspace) -> Outcome {
    let result = result_file(workspace);
    let _ = fs::remove_file(&result);
    let toolchain = match Toolchain::find_or_install(workspace) {
        Ok(toolchain) => toolchain,
        Err(reason) => return Outcome::skipped(reason),
    };
    let (mut failures, mut skipped, mut figures) = (Vec::new(), Vec::new(), Figures::new());
    match image(workspace, &toolchain) {
        Ok(found) => figures.extend(found),
        Err(reason) => failures.push(reason),
    }
    install::require(QEMU, QEMU_PACKAGES);
    if find_program(QEMU).is_none() {
        skipped.push(format!(
            "{QEMU} is missing, the card is not emulated: apt-get install {}",
            QEMU_PACKAGES.join(" ")
        ));
    } else {
        match emulated(workspace, &toolchain) {
            Ok(found) => figures.extend(found),
            Err(reason) => failures.push(reason),
        }
    }
    failures.extend(judged(&figures));
    let fields: Vec<String> = figures.iter().map(|(name, value)| format!("\"{name}\": {value}")).collect();
    if let Err(error) = fs::write(&result, format!("{{{}}}\n", fields.join(", "))) {
        failures.push(format!("{}: {error}", result.display()));
    }
    Outcome::new(failures, skipped)
}

/// The figures of the last run as one JSON object; nothing where it was left out.
pub fn result(workspace: &Workspace) -> Option<String> {
    fs::read_to_string(result_file(workspace)).ok()
}

fn result_file(workspace: &Workspace) -> PathBuf {
    workspace.target.join("firmware").join("result.json")
}

/// Flash and RAM of the chip's image. No part of it is a maker's blob: the radio is driven directly.
fn image(workspace: &Workspace, toolchain: &Toolchain) -> Result<Figures, String> {
    let elf = build(workspace, toolchain, "nrf52832", "fieldwalk-card-nrf52832")?;
    let at = |error: &dyn std::fmt::Display| format!("{}: {error}", elf.display());
    let bytes = fs::read(&elf).map_err(|error| at(&error))?;
    let footprint = Footprint::read(&bytes).map_err(|error| at(&error))?;
    Ok(vec![
        ("flash_bytes", footprint.flash_bytes.to_string()),
        ("blob_bytes", "0".into()),
        ("ram_bytes", footprint.ram_bytes.to_string()),
    ])
}

/// Kwak's walks on the emulated card, its frames compared and positioned.
fn emulated(workspace: &Workspace, toolchain: &Toolchain) -> Result<Figures, String> {
    let elf = build(workspace, toolchain, "qemu", "fieldwalk-card-qemu")?;
    golden(workspace, &elf)?;
    let walks = workspace.target.join("firmware").join("walks");
    let _ = fs::remove_dir_all(&walks); // frames of an earlier run
    execute(workspace.cargo("run -q -p fieldwalk-cli -- card-walks").arg(&walks))?;
    let said = emulate(workspace, &elf, &walks)?;
    let mut score = workspace.cargo("run -q -p fieldwalk-cli -- card-walks --score");
    let scored = output_of(score.arg(&walks)).ok_or("the emulated card's frames cannot be scored")?;
    let number = |name: &str| number(&scored, name).ok_or(format!("`card-walks --score` says no {name}"));
    let stack = said.split_once("stack_bytes ").and_then(|(_, rest)| rest.split_whitespace().next());
    Ok(vec![
        ("stack_bytes", stack.ok_or(format!("the emulated card says no stack_bytes: {said}"))?.to_owned()),
        ("rounds", number("rounds")?),
        ("frames_equal", number("frames_equal")?),
        ("instructions_per_round", number("instructions_per_round")?),
        ("median_m", number("median_m")?),
    ])
}

/// The golden readings on the emulated card give the golden frames: see `firmware/golden/README.md`.
fn golden(workspace: &Workspace, elf: &Path) -> Result<(), String> {
    let (golden, folder) = (workspace.root.join("firmware/golden"), workspace.target.join("firmware/golden"));
    let failed = |error: std::io::Error| format!("firmware/golden: {error}");
    fs::create_dir_all(&folder).map_err(failed)?;
    fs::copy(golden.join("walk-01.readings"), folder.join("walk-01.readings")).map_err(failed)?;
    emulate(workspace, elf, &folder)?;
    let frames = fs::read(folder.join("walk-01.frames")).map_err(failed)?;
    let expected = fs::read_to_string(golden.join("walk-01.frames.txt")).map_err(failed)?;
    if golden_lines(&frames) == expected {
        Ok(())
    } else {
        Err("the emulated card's frames of firmware/golden/walk-01.readings are not the golden ones".into())
    }
}

/// The emulator's records as the golden file has them: a time in µs and 31 bytes in hexadecimal digits, a line each.
fn golden_lines(records: &[u8]) -> String {
    let mut lines = String::new();
    for record in records.as_chunks::<{ 8 + 31 + 4 }>().0 {
        let time_us = u64::from_le_bytes(std::array::from_fn(|k| record[k]));
        let digits: String = record[8..39].iter().map(|byte| format!("{byte:02x}")).collect();
        lines += &format!("{time_us} {digits}\n");
    }
    lines
}

fn build(workspace: &Workspace, toolchain: &Toolchain, folder: &str, name: &str) -> Result<PathBuf, String> {
    let target = workspace.target.join("firmware");
    let mut cargo = toolchain.cargo(workspace);
    cargo.args(["build", "--release", "--locked", "--target", TARGET]);
    cargo.arg("--target-dir").arg(&target).args(toolchain.build_flags());
    execute(cargo.current_dir(workspace.root.join("firmware").join(folder)))?;
    Ok(target.join(TARGET).join("release").join(name))
}

/// Runs the image with `walks` as its working folder, and gives what it says.
fn emulate(workspace: &Workspace, elf: &Path, walks: &Path) -> Result<String, String> {
    let mut qemu = workspace.command(QEMU);
    // An instruction takes 64 ns of the board's time, and nothing depends on this machine's speed.
    qemu.args(["-machine", "mps2-an386", "-cpu", "cortex-m4", "-icount", "shift=6"]);
    qemu.args(["-nographic", "-monitor", "none", "-serial", "none"]);
    qemu.args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(elf);
    eprintln!("$ {QEMU} -machine mps2-an386 -icount shift=6 -kernel {}", elf.display());
    let child = qemu.current_dir(walks).stdin(Stdio::null()).stdout(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| format!("{QEMU} did not start: {error}"))?;
    let is_done = wait(&mut child);
    let output = child.wait_with_output().map_err(|error| format!("{QEMU}: {error}"))?;
    let said = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    match is_done {
        true if output.status.success() => Ok(said),
        true => Err(format!("the emulated card failed ({}): {said}", output.status)),
        false => Err(format!("the emulated card did not end within {} s", EMULATOR_TIMEOUT.as_secs())),
    }
}

/// Whether the child ends in time; else it is killed.
fn wait(child: &mut Child) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < EMULATOR_TIMEOUT {
        if !matches!(child.try_wait(), Ok(None)) {
            return true;
        }
        sleep(Duration::from_millis(50));
    }
    let _ = child.kill();
    false
}

/// What is beyond its bounds.
fn judged(figures: &Figures) -> Vec<String> {
    let value = |name: &str| figures.iter().find(|(known, _)| *known == name)?.1.parse::<f64>().ok();
    let mut failures = Vec::new();
    for (name, bound, most) in [
        ("flash_bytes", MAX_FLASH_BYTES as f64, true),
        ("ram_bytes", MAX_RAM_BYTES as f64, true),
        ("rounds", MIN_ROUNDS, false),
        ("median_m", MAX_MEDIAN_M, true),
    ] {
        if let Some(value) = value(name)
            && (if most { value > bound } else { value < bound })
        {
            failures
                .push(format!("{name} is {value}, {} {bound}", if most { "more than" } else { "less than" }));
        }
    }
    if figures.iter().any(|(name, value)| *name == "frames_equal" && value != "true") {
        failures.push("the emulated card's frames are not those of this machine's build".into());
    }
    failures
}

/// The value of `name` in one flat JSON object.
fn number(json: &str, name: &str) -> Option<String> {
    let (_, rest) = json.split_once(&format!("\"{name}\":"))?;
    Some(rest.split([',', '}']).next()?.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_found_in_a_flat_object() {
        let json = r#"{"rounds":1024,"frames_equal":true,"median_m":1.5}"#;
        assert_eq!(number(json, "rounds").as_deref(), Some("1024"));
        assert_eq!(number(json, "frames_equal").as_deref(), Some("true"));
        assert_eq!(number(json, "median_m").as_deref(), Some("1.5"));
        assert_eq!(number(json, "walks"), None);
    }

    #[test]
    fn a_record_is_a_line() {
        let mut record = vec![0; 43];
        (record[0], record[1], record[8], record[38]) = (0x40, 0x01, 0xAB, 0x0C);
        assert_eq!(golden_lines(&record), format!("320 ab{}0c\n", "00".repeat(29)));
    }

    #[test]
    fn what_is_beyond_its_bounds_fails() {
        let good =
            vec![("flash_bytes", "131072".into()), ("rounds", "120".into()), ("median_m", "1.62".into())];
        assert_eq!(judged(&good), Vec::<String>::new());
        let bad: Figures = vec![
            ("flash_bytes", "131073".into()),
            ("ram_bytes", "24577".into()),
            ("rounds", "119".into()),
            ("frames_equal", "false".into()),
            ("median_m", "1.63".into()),
        ];
        assert_eq!(judged(&bad).len(), 5);
    }
}
