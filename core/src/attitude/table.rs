//! Feature events of a stride, and how likely each combination is for each way to hold a phone, screen up.

use serde::{Deserialize, Serialize};

/// Where the top edge of a phone that is held screen up points, seen by the walker.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pointing {
    /// UF: ahead.
    Forward,
    /// UB: to the walker.
    Backward,
    /// UL: to the left.
    Leftward,
    /// UR: to the right.
    Rightward,
}

impl Pointing {
    /// All of them, in the order of the columns of [`EventTable::likelihood`].
    pub const ALL: [Self; 4] = [Self::Forward, Self::Backward, Self::Leftward, Self::Rightward];
}

/// Which of the three feature events a stride shows.
///
/// # Source
/// Mass-centred 2019, Alg. 2 and its text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct FeatureEvents {
    /// E1: the peak along the top edge comes in the latter half of the step, which runs between vertical peaks.
    pub late_forward_peak: bool,
    /// E2: the mean along the top edge is greater than the mean to the right: the screen is turned to the eyes.
    pub tilted_to_eyes: bool,
    /// E3: to the right, the device sways with the stride rather than with the step.
    pub sways_with_stride: bool,
}

impl FeatureEvents {
    /// Every combination, in the order of the rows of [`EventTable::likelihood`].
    pub const ALL: [Self; 8] = [
        Self::new(true, true, true),
        Self::new(false, true, true),
        Self::new(true, false, true),
        Self::new(true, true, false),
        Self::new(false, false, true),
        Self::new(false, true, false),
        Self::new(true, false, false),
        Self::new(false, false, false),
    ];

    /// The events E1, E2 and E3.
    pub const fn new(e1: bool, e2: bool, e3: bool) -> Self {
        Self { late_forward_peak: e1, tilted_to_eyes: e2, sways_with_stride: e3 }
    }

    /// Its row in an [`EventTable`].
    pub const fn row(self) -> usize {
        match (self.late_forward_peak, self.tilted_to_eyes, self.sways_with_stride) {
            (true, true, true) => 0,
            (false, true, true) => 1,
            (true, false, true) => 2,
            (true, true, false) => 3,
            (false, false, true) => 4,
            (false, true, false) => 5,
            (true, false, false) => 6,
            (false, false, false) => 7,
        }
    }
}

/// Probabilities of the events' combinations for each way to point, and of the ways themselves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventTable {
    /// `P(events | pointing)`, 0 to 1: rows as [`FeatureEvents::ALL`], columns as [`Pointing::ALL`]; columns sum to 1.
    pub likelihood: [[f32; 4]; 8],
    /// `P(pointing)` before any stride, as [`Pointing::ALL`]; sums to 1.
    pub prior: [f32; 4],
}

impl EventTable {
    /// The paper's table, of a hundred users' hundred steps in each way to hold the phone, with its equal priors.
    ///
    /// # Source
    /// Mass-centred 2019, Table 3; the bars over absent events, lost in print, are read so that the posteriors of
    /// Mass-centred 2019, Table 4 follow.
    pub const fn printed() -> Self {
        Self {
            likelihood: [
                [0.9386, 0.0, 0.0, 0.0],
                [0.0307, 0.0, 0.0, 0.0],
                [0.0, 0.0, 0.0044, 0.0],
                [0.0307, 0.0, 0.0, 0.4545],
                [0.0, 0.9248, 0.0044, 0.0],
                [0.0, 0.0, 0.0, 0.5455],
                [0.0, 0.0, 0.4204, 0.0],
                [0.0, 0.0752, 0.5708, 0.0],
            ],
            prior: [0.25; 4],
        }
    }

    /// Our table: 493 strides of one person with two phones (the trials of texting in the Tyrex benchmark), each also
    /// turned in quarters for the other ways to point; expects the phone to be held forward.
    ///
    /// `fieldwalk train attitude` makes it. The pattern is the paper's: each way has its own two or three combinations.
    pub const fn estimated() -> Self {
        Self {
            likelihood: [
                [0.7696, 0.001, 0.001, 0.0392],
                [0.0131, 0.0111, 0.0091, 0.0835],
                [0.0111, 0.0131, 0.0835, 0.0091],
                [0.1881, 0.001, 0.0151, 0.3531],
                [0.001, 0.7696, 0.0392, 0.001],
                [0.0091, 0.007, 0.0392, 0.4598],
                [0.007, 0.0091, 0.4598, 0.0392],
                [0.001, 0.1881, 0.3531, 0.0151],
            ],
            prior: [0.7, 0.1, 0.1, 0.1],
        }
    }

    /// `P(pointing | events)` of one stride that was expected to point as `prior`, as [`Pointing::ALL`].
    ///
    /// Where the table calls the events impossible for all that `prior` allows, the answer is `prior`.
    ///
    /// # Source
    /// Mass-centred 2019, Eq. 1.
    pub fn posterior(&self, events: FeatureEvents, prior: [f32; 4]) -> [f32; 4] {
        let likelihood = self.likelihood[events.row()];
        let joint = [0, 1, 2, 3].map(|k| likelihood[k] * prior[k]);
        let total: f32 = joint.iter().sum();
        if total > 0.0 && total.is_finite() { joint.map(|p| p / total) } else { prior }
    }

    /// The same table if this share of strides, 0 to 1, showed any of the eight combinations alike.
    #[must_use]
    pub fn with_broken_share(mut self, share: f32) -> Self {
        let share = share.clamp(0.0, 1.0);
        for row in &mut self.likelihood {
            *row = row.map(|p| p + share * (0.125 - p));
        }
        self
    }

    /// Whether every number is a probability, and every column and the prior sum to 1.
    pub fn is_valid(&self) -> bool {
        let is_distribution = |values: &mut dyn Iterator<Item = f32>| {
            let mut sum = 0.0;
            let mut is_probability = true;
            for p in values {
                is_probability &= (0.0..=1.0).contains(&p);
                sum += p;
            }
            is_probability && (sum - 1.0).abs() < 1e-3
        };
        (0..4).all(|k| is_distribution(&mut self.likelihood.iter().map(|row| row[k])))
            && is_distribution(&mut self.prior.iter().copied())
    }
}

/// Strides counted by their events, to estimate an [`EventTable`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventCounts {
    n: [[u32; 4]; 8],
}

impl EventCounts {
    /// Counts a stride with the phone known to be `pointing`.
    pub fn add(&mut self, events: FeatureEvents, pointing: Pointing) {
        self.n[events.row()][pointing as usize] += 1;
    }

    /// Adds what `other` counted.
    pub fn merge(&mut self, other: &Self) {
        for (row, others) in self.n.iter_mut().zip(&other.n) {
            for (n, more) in row.iter_mut().zip(others) {
                *n += more;
            }
        }
    }

    /// Strides counted with the phone `pointing`.
    pub fn n_strides(&self, pointing: Pointing) -> u32 {
        self.n.iter().map(|row| row[pointing as usize]).sum()
    }

    /// The table that makes these counts likely, expecting `prior`.
    ///
    /// Half a stride is added to every combination (the Krichevsky–Trofimov estimate), so that none is impossible: the
    /// paper's zeros come from its users, not from nature.
    pub fn table(&self, prior: [f32; 4]) -> EventTable {
        const PSEUDO_COUNT: f32 = 0.5;
        let totals = Pointing::ALL.map(|pointing| self.n_strides(pointing) as f32 + 8.0 * PSEUDO_COUNT);
        let likelihood = self.n.map(|row| [0, 1, 2, 3].map(|k| (row[k] as f32 + PSEUDO_COUNT) / totals[k]));
        EventTable { likelihood, prior }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_printed_posteriors_follow_from_the_printed_table() {
        // Mass-centred 2019, Table 4, by the order of the rows.
        let printed_percent = [100.0, 100.0, 0.0, 6.33, 0.0, 0.0, 0.0, 0.0];
        let table = EventTable::printed();
        assert!(table.is_valid() && EventTable::estimated().is_valid());
        for (events, percent) in FeatureEvents::ALL.into_iter().zip(printed_percent) {
            let posterior = table.posterior(events, table.prior);
            assert!((100.0 * posterior[0] - percent).abs() < 0.005, "{events:?}: {posterior:?}");
            assert!((posterior.iter().sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn rows_are_in_the_order_of_the_combinations() {
        for (row, events) in FeatureEvents::ALL.into_iter().enumerate() {
            assert_eq!(events.row(), row);
        }
    }

    #[test]
    fn what_the_table_calls_impossible_changes_nothing() {
        let certain = [0.0, 1.0, 0.0, 0.0];
        assert_eq!(EventTable::printed().posterior(FeatureEvents::ALL[0], certain), certain);
        let broken = EventTable { likelihood: [[f32::NAN; 4]; 8], prior: [0.25; 4] };
        assert_eq!(broken.posterior(FeatureEvents::ALL[0], certain), certain);
        assert!(!broken.is_valid());
    }

    #[test]
    fn broken_strides_make_the_table_milder() {
        let milder = EventTable::printed().with_broken_share(0.2);
        // 0.8·0.9386 + 0.2/8 against 0.2/8.
        assert!((milder.likelihood[0][0] - 0.77588).abs() < 1e-6 && milder.likelihood[0][1] == 0.025);
        assert!(milder.is_valid());
        assert_eq!(EventTable::printed().with_broken_share(0.0), EventTable::printed());
    }

    #[test]
    fn counts_make_a_table() {
        let mut counts = EventCounts::default();
        for _ in 0..6 {
            counts.add(FeatureEvents::ALL[0], Pointing::Forward);
        }
        let mut more = EventCounts::default();
        more.add(FeatureEvents::ALL[7], Pointing::Leftward);
        counts.merge(&more);
        let table = counts.table([0.25; 4]);
        // (6 + ½) / (6 + 4), ½ / 10, (1 + ½) / 5, and an eighth where nothing was counted.
        assert_eq!(table.likelihood[0], [0.65, 0.125, 0.1, 0.125]);
        assert_eq!(table.likelihood[7], [0.05, 0.125, 0.3, 0.125]);
        assert!(table.is_valid());
    }
}
