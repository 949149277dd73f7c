//! Distances of two histories with their means removed, many at a time where that is dear.

/// Rows compared at once. Each has sums of its own, so that a processor without wide registers gives the same bits.
pub(super) const LANES: usize = 8;

/// A number of each of [`LANES`] histories.
pub(super) type Lanes = [f32; LANES];

/// The Euclidean distance of two histories with their means removed, in µT; of what both have, where one is longer.
///
/// # Source
/// Kwak 2018, Eq. 5.
pub fn euclidean_ut(a_ut: &[f32], b_ut: &[f32]) -> f32 {
    let n = a_ut.len().min(b_ut.len());
    centred_square_ut2(&a_ut[..n], &b_ut[..n]).sqrt()
}

/// The distance of two histories with their means removed, in µT, under the warping of time that makes it least.
///
/// Its square is the least sum of squared differences along a way through the table of pairs, from the first reads to
/// the last, that steps on in one history or in both; with a `band`, no farther than that from the diagonal. For
/// histories of one length it is never more than the Euclidean distance, whose way is the diagonal. O(N·M).
///
/// # Source
/// Kwak 2018, §5.3.3: the measure that Magicol and others use.
pub fn dynamic_time_warping_ut(a_ut: &[f32], b_ut: &[f32], band: Option<usize>) -> f32 {
    let mut a_lanes: Vec<Lanes> = a_ut.iter().map(|&read_ut| [read_ut; LANES]).collect();
    remove_means(&mut a_lanes, |_| true);
    let mean_ut = b_ut.iter().sum::<f32>() / b_ut.len() as f32;
    let cost = |i: usize, j: usize| squares(&a_lanes[i], b_ut[j] - mean_ut);
    warped([a_ut.len(), b_ut.len()], band, cost, &mut Vec::new())[0].sqrt()
}

/// `Σ (e − ē)²` with `e = a − b`, of rows of one length: the square of the distance after the means have been removed.
pub(super) fn centred_square_ut2(a_ut: &[f32], b_ut: &[f32]) -> f32 {
    let n = a_ut.len();
    if n == 0 {
        return 0.0;
    }
    let mean_ut = sum(a_ut, b_ut, |off_ut| off_ut) / n as f32;
    sum(a_ut, b_ut, |off_ut| (off_ut - mean_ut) * (off_ut - mean_ut))
}

/// `Σ e` and `Σ e²` with `e = a − b`, of rows of one length.
pub(super) fn off_sums(a_ut: &[f32], b_ut: &[f32]) -> [f32; 2] {
    [sum(a_ut, b_ut, |off_ut| off_ut), sum(a_ut, b_ut, |off_ut| off_ut * off_ut)]
}

/// The sum of `term(a − b)`, as [`LANES`] sums side by side: a fixed order, whatever the processor adds at once.
#[inline(always)]
fn sum(a_ut: &[f32], b_ut: &[f32], term: impl Fn(f32) -> f32) -> f32 {
    let mut sums = [0.0f32; LANES];
    let (a_blocks, a_rest) = a_ut.as_chunks::<LANES>();
    let (b_blocks, b_rest) = b_ut.as_chunks::<LANES>();
    for (a, b) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..LANES {
            sums[lane] += term(a[lane] - b[lane]);
        }
    }
    for (lane, (a, b)) in a_rest.iter().zip(b_rest).enumerate() {
        sums[lane] += term(a - b);
    }
    sums.iter().sum()
}

/// Takes from each lane its mean over the reads that `counts`.
pub(super) fn remove_means(rows: &mut [Lanes], counts: impl Fn(usize) -> bool) {
    let (mut sums, mut n) = ([0.0f32; LANES], 0.0f32);
    for (_, row) in rows.iter().enumerate().filter(|(k, _)| counts(*k)) {
        n += 1.0;
        for lane in 0..LANES {
            sums[lane] += row[lane];
        }
    }
    let means = sums.map(|sum| sum / n.max(1.0));
    for row in rows {
        for lane in 0..LANES {
            row[lane] -= means[lane];
        }
    }
}

/// `(row − value)²` in each lane.
#[inline(always)]
pub(super) fn squares(row: &Lanes, value: f32) -> Lanes {
    row.map(|read| (read - value) * (read - value))
}

/// The least sum of `cost(i, j)` along a way from (0, 0) to the last pair of a table of `n_rows` × `n_columns`, in each
/// lane; 0 for an empty table, and infinite where the band holds no way.
#[inline(always)]
pub(super) fn warped(
    [n_rows, n_columns]: [usize; 2],
    band: Option<usize>,
    cost: impl Fn(usize, usize) -> Lanes,
    column: &mut Vec<Lanes>,
) -> Lanes {
    if n_rows == 0 || n_columns == 0 {
        return [0.0; LANES];
    }
    const FAR: Lanes = [f32::INFINITY; LANES];
    let band = band.unwrap_or(n_rows.max(n_columns));
    // `column[i + 1]` is the least sum up to (i, j); `column[0]` stands outside the table.
    column.clear();
    column.resize(n_rows + 1, FAR);
    column[0] = [0.0; LANES];
    for j in 0..n_columns {
        let first = j.saturating_sub(band).min(n_rows);
        let end = (j + band + 1).min(n_rows);
        // (first − 1, j) lies outside the band, (first − 1, j − 1) in it.
        let mut diagonal = core::mem::replace(&mut column[first], FAR);
        let mut below = FAR;
        for i in first..end {
            let step = cost(i, j);
            let left = column[i + 1];
            let mut least = FAR;
            for lane in 0..LANES {
                let of_two = if below[lane] < left[lane] { below[lane] } else { left[lane] };
                let of_three = if diagonal[lane] < of_two { diagonal[lane] } else { of_two };
                least[lane] = of_three + step[lane];
            }
            (diagonal, below) = (left, least);
            column[i + 1] = least;
        }
    }
    column[n_rows]
}
