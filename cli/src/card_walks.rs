//! Kwak's walks with the card's own application in place of the simulator's card: readings out, frames in, errors.
//!
//! The emulated card and the host are given the same readings; frames of either are positioned here.

use std::cell::Cell;

use fieldwalk::system::Recipe;
use fieldwalk_card::replay::{ReplayCard, SensorReading, finish, lasts_another_round};
use fieldwalk_card::{CardParams, RoundOutcome};
use fieldwalk_kmx62::BufferEntry;
use fieldwalk_sim::card::{CardModel, CardReadings, RANGE, SentFrame};
use fieldwalk_sim::scenario::Walk;

use crate::evaluation::Start;
use crate::reproduce::kwak2018::office;
use crate::reproduce::surveyed::Surveyed;
use crate::reproduce::test_bed::KWAK_PACES;
use crate::simulated::test_walk;

/// Errors count from this second on, as in the paper's own experiment, when the start's filter ends.
const SETTLED_S: i64 = 10;

/// The walks of Kwak 2018 in one office, and what the card's sensor read on them.
#[derive(Clone, Debug)]
pub struct CardWalks {
    office: Surveyed,
    walks: Vec<(Walk, CardReadings)>,
    seed: u64,
}

impl CardWalks {
    /// The walks in the office of `seed`.
    pub fn of(seed: u64) -> Self {
        Self::in_office(office::surveyed(seed), seed, |card| card)
    }

    /// The same walks with `change`d cards.
    #[must_use]
    pub fn with_cards(&self, change: impl Fn(CardModel) -> CardModel) -> Self {
        Self::in_office(self.office.clone(), self.seed, change)
    }

    fn in_office(office: Surveyed, seed: u64, change: impl Fn(CardModel) -> CardModel) -> Self {
        let walks = (0..KWAK_PACES.len())
            .filter_map(|k| {
                let usual = office::walk(&office, k, seed);
                let walk = Walk { card: usual.card.map(&change), ..usual };
                let readings = office.scenario.card_readings(&walk)?;
                Some((walk, readings))
            })
            .collect();
        Self { office, walks, seed }
    }

    /// What the sensor's buffer gave, walk by walk.
    pub fn entries(&self) -> impl Iterator<Item = &[BufferEntry]> {
        self.walks.iter().map(|(_, readings)| readings.entries.as_slice())
    }

    /// Errors of the system `card` in metres on the walk number `k`, once a second, where the card sent `frames`; infinite
    /// where there was no fix.
    pub fn errors_m(&self, k: usize, frames: &[SentFrame]) -> Vec<f64> {
        let Some((walk, _)) = self.walks.get(k) else { return Vec::new() };
        let recorded = self.office.scenario.simulate_frames(walk, frames);
        let Some(scored) = test_walk(recorded, SETTLED_S) else { return Vec::new() };
        self.office.errors_m(&Recipe::card(), Start::Cold, self.seed, &scored)
    }
}

/// The frames that a card sends whose sensor reads `entries`, by the build for this machine.
pub fn host_frames(entries: &[BufferEntry], card_id: u16) -> Vec<SentFrame> {
    let now_us = Cell::new(0);
    let readings = entries.iter().map(|entry| SensorReading {
        force_m_s2: entry.acceleration_m_s2(RANGE),
        field_ut: entry.field_ut(),
    });
    let mut card = ReplayCard::switched_on(&now_us, readings, CardParams::of_card(card_id));
    let mut frames = Vec::new();
    while lasts_another_round(entries.len(), now_us.get()) {
        if let RoundOutcome::Sent(frame) = finish(card.round()) {
            // The event's own delay stands between this round's end and the next.
            frames.push((now_us.get(), frame));
        }
    }
    frames
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldwalk::card::CardReceiver;
    use fieldwalk::sensor::Reading;
    use fieldwalk_sim::card::READINGS;
    use fieldwalk_sim::scenario::Recorded;

    /// Rounds and steps that a receiver makes of a walk's frames, and the steps made.
    fn received(recorded: &Recorded) -> [usize; 3] {
        let mut receiver = CardReceiver::default();
        for sample in &recorded.samples {
            let Reading::CardFrame(frame) = &sample.reading else { continue };
            receiver.push(sample.time, frame);
        }
        let rounds: Vec<_> = std::iter::from_fn(|| receiver.pop()).collect();
        assert_eq!((receiver.counts().n_malformed, receiver.counts().n_foreign), (0, 0));
        let n_steps = rounds.iter().map(|round| usize::from(round.n_steps)).sum();
        [rounds.len(), n_steps, recorded.steps.len()]
    }

    #[test]
    fn what_the_application_sends_is_heard_as_a_walk() {
        let walks = CardWalks::of(1);
        let entries: Vec<&[BufferEntry]> = walks.entries().collect();
        assert_eq!(entries.len(), KWAK_PACES.len());
        let (mut n_counted, mut n_by_paper, mut n_made) = (0, 0, 0);
        for (k, entries) in entries.into_iter().enumerate() {
            let frames = host_frames(entries, k as u16);
            let duration_s = entries.len() as f64 / READINGS.hz();
            assert!(
                (frames.len() as f64 - duration_s / 1.005).abs() < 3.0,
                "{} of {duration_s} s",
                frames.len()
            );
            let (walk, _) = &walks.walks[k];
            let scenario = &walks.office.scenario;
            let [n_rounds, n_steps, n_true] = received(&scenario.simulate_frames(walk, &frames));
            let [_, by_paper, _] = received(&scenario.simulate(walk));
            assert!(n_rounds + 3 >= frames.len());
            println!("walk {k}: {n_steps} and {by_paper} of {n_true}");
            (n_counted, n_by_paper, n_made) = (n_counted + n_steps, n_by_paper + by_paper, n_made + n_true);
        }
        let [ours, papers] = [n_counted, n_by_paper].map(|n| n as f64 / n_made as f64);
        println!("{ours:.3} and {papers:.3} of {n_made}");
        // Counted right on the whole, as by the paper's 15 readings a second.
        assert!((0.94..1.06).contains(&ours) && (0.94..1.06).contains(&papers), "{ours} {papers}");
    }
}
