//! Motion captures: reading never panics and gives finite poses with unit quaternions.
#![no_main]

use fieldwalk_formats::tyrex::Truth;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match Truth::parse(bytes) {
        Ok(truth) => {
            for pose in &truth.poses {
                assert!(pose.position_m.iter().all(|c| c.is_finite()));
                let norm = pose.earth_from_device.iter().map(|c| c * c).sum::<f64>();
                assert!((norm - 1.0).abs() < 1e-6);
            }
        }
        Err(error) => assert!(!error.remedy().is_empty()),
    }
});
