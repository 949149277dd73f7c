//! Phones' text logs: reading never panics, ends, and gives plausible samples only.
#![no_main]

use fieldwalk_formats::tyrex::{LogKind, Platform, SensorLogReader};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, text)) = bytes.split_first() else { return };
    let platform = if choice & 1 == 0 { Platform::Android } else { Platform::Ios };
    let kind = LogKind::ALL[usize::from(choice >> 1) % LogKind::ALL.len()];
    for sample in SensorLogReader::new(text, "fuzz", platform, kind, -1.5) {
        match sample {
            Ok(sample) => assert!(sample.is_plausible()),
            Err(error) => assert!(!error.remedy().is_empty()),
        }
    }
});
