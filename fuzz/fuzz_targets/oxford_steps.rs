//! The step collection's two files: reading never panics, ends, and gives nothing but finite numbers.
#![no_main]

use fieldwalk::sensor::Reading;
use fieldwalk_formats::oxford_steps::{AccelerometerReader, ContactReader};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let n_lines = bytes.split(|&byte| byte == b'\n').count();
    let mut n_samples = 0;
    for sample in AccelerometerReader::new(bytes, "fuzz") {
        match sample.map(|sample| sample.reading) {
            Ok(Reading::SpecificForce(force)) => assert!(force.iter().all(|c| c.is_finite())),
            Ok(other) => panic!("{other:?}"),
            Err(error) => assert!(!error.remedy().is_empty()),
        }
        n_samples += 1;
    }
    assert!(n_samples <= n_lines + 1);
    let mut n_contacts = 0;
    for contact in ContactReader::new(bytes, "fuzz") {
        match contact {
            Ok(contact) => assert!(contact.time.as_nanos() >= 0),
            Err(error) => assert!(!error.remedy().is_empty()),
        }
        n_contacts += 1;
    }
    assert!(n_contacts <= 2 * n_lines + 1);
});
