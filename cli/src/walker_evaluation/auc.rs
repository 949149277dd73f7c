//! The area under the receiver's curve.

/// The chance that a positive scores higher than a negative, ties counting half; NaN where either is missing.
pub fn auc(positives: &[f64], negatives: &[f64]) -> f64 {
    let labelled = |scores: &[f64], is_positive| {
        scores.iter().map(move |&score| (score, is_positive)).collect::<Vec<_>>()
    };
    let mut all = [labelled(positives, true), labelled(negatives, false)].concat();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut below, mut pairs) = (0.0, 0.0);
    for tied in all.chunk_by(|a, b| a.0 == b.0) {
        let n_positive = tied.iter().filter(|(_, is_positive)| *is_positive).count() as f64;
        let n_negative = tied.len() as f64 - n_positive;
        pairs += n_positive * (below + 0.5 * n_negative);
        below += n_negative;
    }
    pairs / (positives.len() as f64 * negatives.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_by_hand() {
        assert_eq!(auc(&[2.0, 3.0], &[0.0, 1.0]), 1.0);
        assert_eq!(auc(&[0.0], &[1.0, 2.0]), 0.0);
        assert_eq!(auc(&[1.0, 1.0], &[1.0]), 0.5);
        // 3 beats 2 and 1, 1.5 beats 1 only: 3 of 4 pairs.
        assert_eq!(auc(&[3.0, 1.5], &[2.0, 1.0]), 0.75);
        assert!(auc(&[], &[1.0]).is_nan());
    }
}
