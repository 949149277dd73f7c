//! Systems scored on recordings: one map per floor from its survey walks, errors on walks that the map has not seen.

mod cut_offs;
mod floor;
mod row;
mod start;
mod walk;

pub use floor::{Evaluation, FloorScores, ScoredWalk};
pub use row::{PointKind, Row, RowGroup};
pub use start::Start;
pub use walk::{ReadTest, TestWalk, TruthPoint, WalkScore, fixes, record, score, truth_points};

use std::path::Path;

use sha1::{Digest, Sha1};

/// Number of folds: every walk is a test walk of exactly one.
pub const N_FOLDS: u8 = 4;

/// Whether the walk in `trace` is a test walk of fold `fold`: the two low bits of the last byte of SHA-1 of its file
/// name say so.
pub fn is_test_walk(trace: &Path, fold: u8) -> bool {
    let name = trace.file_name().unwrap_or_default().as_encoded_bytes();
    let digest = Sha1::digest(name);
    digest.last().is_some_and(|byte| byte & (N_FOLDS - 1) == fold)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_walk_is_tested_in_one_of_four_folds() {
        for name in ["a.txt", "5dd9e7aac5b77e0006b1732b.txt", ""] {
            let folds = (0..N_FOLDS).filter(|&fold| is_test_walk(Path::new(name), fold)).count();
            assert_eq!(folds, 1, "{name}");
        }
    }

    #[test]
    fn the_folder_does_not_count() {
        // `printf a.txt | sha1sum` ends in 1c, which is 0 in its two low bits.
        assert!(is_test_walk(Path::new("a.txt"), 0));
        assert!(is_test_walk(Path::new("some/where/a.txt"), 0));
    }
}
