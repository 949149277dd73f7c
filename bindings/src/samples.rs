//! Batches taken apart, for every object that takes samples in.

use fieldwalk::sensor::Sample;
use fieldwalk_batch::SampleBatch;

use crate::status::BatchFaults;

/// Gives `take` every sample of `batch` in order, and counts the records that give none.
///
/// # Errors
/// The first error of `take`; what follows is not taken then.
pub(crate) fn take_each<E>(
    batch: &SampleBatch<'_>,
    faults: &mut BatchFaults,
    mut take: impl FnMut(Sample) -> Result<(), E>,
) -> Result<(), E> {
    for sample in batch.samples() {
        match sample {
            Ok(sample) => take(sample)?,
            Err(fault) => faults.count(fault),
        }
    }
    Ok(())
}
