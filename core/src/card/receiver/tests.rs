use super::*;
use fieldwalk_codec::{CardFlags, CardHeader};
use proptest::prelude::*;

/// The frame of round `k`, which stands in its fields.
fn frame(k: i64) -> [u8; 31] {
    frame_of(k, CardFlags::default())
}

fn frame_of(k: i64, flags: CardFlags) -> [u8; 31] {
    let header = CardHeader { flags, sequence: k as u8, card_id: 7, ..CardHeader::default() };
    let nan_if = |value: f32| if flags.motion_missing { f32::NAN } else { value };
    let round = CardRound {
        // 20 000 rounds in steps of 0.04 µT.
        b_v_ut: [k as f32 * 0.04; 3],
        b_h_ut: [25.0; 3],
        previous_b_ut: [(1 + (k - 1).rem_euclid(250)) as f32; 3],
        acceleration_max_m_s2: [13.0, 10.0, 13.0],
        acceleration_min_m_s2: [7.0, 9.0, 7.0].map(nan_if),
        orientation_rad: 0.5,
    };
    let mut bytes = [0; 31];
    CardRepr::from_physical(header, &round).emit(&mut CardFrame::new_unchecked(&mut bytes));
    bytes
}

fn at(k: i64) -> Timestamp {
    Timestamp::from_millis(1_000_000 + 1_005 * k)
}

/// The round that an event says it is, if it has a level read.
fn number(event: &StepEvent) -> Option<i64> {
    let [_, b_v_ut] = event.reads[0]?.horizontal_vertical_ut?;
    Some((b_v_ut / 0.04).round() as i64)
}

fn events(receiver: &mut CardReceiver) -> Vec<StepEvent> {
    core::iter::from_fn(|| receiver.pop()).collect()
}

#[test]
fn a_round_by_hand() {
    let mut receiver = CardReceiver::default();
    receiver.push(at(3), &frame(3));
    receiver.push(at(4), &frame(4));
    let [first, second] = events(&mut receiver)[..] else { panic!("two rounds") };
    assert!(first.cycle.is_first && !second.cycle.is_first);
    assert_eq!((second.cycle.start, second.cycle.end, second.n_steps), (at(3), at(4), 2));
    // A 256th of a turn is the orientation's step.
    assert!((second.azimuth_rad().unwrap() - 0.5).abs() < 0.013);
    let field = second.forward_field.unwrap();
    assert!((field.horizontal_ut() - 25.0).abs() < 1e-4 && (field.vertical_ut() - 0.16).abs() < 1e-6);
    assert_eq!(second.end_strength_ut, second.reads[2].map(|read| read.strength_ut));
    assert_eq!(receiver.counts(), CardCounts { n_rounds: 2, ..CardCounts::default() });
}

#[test]
fn a_lost_round_is_refilled_by_the_next_frame() {
    let mut receiver = CardReceiver::default();
    for k in [1, 2, 4, 8] {
        receiver.push(at(k), &frame(k));
    }
    let rounds = events(&mut receiver);
    let numbers: Vec<_> = rounds.iter().map(number).collect();
    assert_eq!(numbers, [Some(1), Some(2), None, Some(4), None, None, None, Some(8)]);
    // Frame 4 tells the strength of round 3, which is its number and one; frame 8 that of 7; of 5 and 6 nothing is known.
    let strengths = |i: usize| rounds[i].reads.map(|read| read.map(|read| read.strength_ut));
    assert_eq!((strengths(2), strengths(6)), ([Some(4.0); 3], [Some(8.0); 3]));
    assert_eq!((strengths(4), rounds[5].reads), ([None; 3], [None; 3]));
    // The walker is taken to have walked on.
    assert!(rounds.iter().all(|round| round.n_steps == 2));
    assert!(rounds.windows(2).all(|pair| pair[0].cycle.end == pair[1].cycle.start));
    assert_eq!(rounds[4].cycle.end, at(5));
    let counts = receiver.counts();
    assert_eq!((counts.n_rounds, counts.n_refilled, counts.n_unknown, counts.n_restarts), (4, 2, 2, 0));
}

#[test]
fn frames_that_have_no_place_are_counted() {
    let mut receiver = CardReceiver::default();
    receiver.push(at(5), &frame(5));
    receiver.push(at(5), &frame(5));
    receiver.push(at(6), &frame(4));
    receiver.push(at(6), &[0; 31]);
    receiver.push(at(6), &[]);
    let mut foreign = frame(6);
    foreign[10] = 8;
    receiver.push(at(6), &foreign);
    assert_eq!(events(&mut receiver).len(), 1);
    let expected = CardCounts {
        n_rounds: 1,
        n_repeated: 1,
        n_late: 1,
        n_malformed: 2,
        n_foreign: 1,
        ..CardCounts::default()
    };
    assert_eq!(receiver.counts(), expected);
}

#[test]
fn a_reset_card_and_a_long_silence_begin_anew() {
    let mut receiver = CardReceiver::default();
    receiver.push(at(0), &frame(100));
    // The number says 20 rounds, the clock one.
    receiver.push(at(1), &frame(120));
    // The number says one round, but the card says that it woke.
    receiver.push(at(2), &frame_of(121, CardFlags { just_woke: true, ..CardFlags::default() }));
    // Six lost in a row, then a whole turn of the sequence number.
    receiver.push(at(9), &frame(128));
    receiver.push(at(9 + 256), &frame(128 + 256));
    receiver.push(at(10 + 256), &frame(129 + 256));
    let rounds = events(&mut receiver);
    let firsts: Vec<_> = rounds.iter().map(|round| round.cycle.is_first).collect();
    assert_eq!(firsts, [true, true, true, true, true, false]);
    assert_eq!(receiver.counts().n_restarts, 4);
}

#[test]
fn a_card_without_motion_walks_on() {
    let mut receiver = CardReceiver::default();
    receiver.push(at(0), &frame_of(0, CardFlags { motion_missing: true, ..CardFlags::default() }));
    receiver.push(at(1), &frame(1));
    receiver.push(at(2), &frame_of(2, CardFlags { motion_missing: true, ..CardFlags::default() }));
    let rounds = events(&mut receiver);
    assert_eq!(rounds.iter().map(|round| round.n_steps).collect::<Vec<_>>(), [0, 2, 2]);
    assert!((rounds[2].level_heading_rad - rounds[1].level_heading_rad).abs() < 1e-6);
}

/// What the air and the network do to frames: `(round, arrival)`, in the order of arrival.
fn arrivals(seed: u64, n_rounds: i64) -> Vec<(i64, Timestamp)> {
    let mut rng = crate::random::CounterRng::new(seed, 1);
    let mut next = |n: u32| rand::Rng::next_u32(&mut rng) % n;
    let mut arrivals = Vec::new();
    let loss = next(40);
    let mut deaf_until = 0;
    for k in 0..n_rounds {
        if next(400) == 0 {
            deaf_until = k + i64::from(next(700));
        }
        if k < deaf_until {
            continue;
        }
        for _ in 0..4 {
            if next(100) >= loss {
                // Mostly a little late, sometimes by more than a round.
                let delay_ms = if next(30) == 0 { next(2_500) } else { next(60) };
                arrivals.push((k, at(k) + Duration::from_millis(delay_ms.into())));
            }
        }
    }
    arrivals.sort_by_key(|&(k, time)| (time, k));
    arrivals
}

#[test]
fn no_round_is_ever_in_the_wrong_place() {
    let (mut n_frames, mut n_heard, mut n_distinct) = (0, 0u64, 0);
    for seed in 0..160 {
        let mut receiver = CardReceiver::default();
        let arrivals = arrivals(seed, 4_000);
        let (mut last, mut n_between) = (None::<StepEvent>, 0);
        for &(k, time) in &arrivals {
            n_frames += 1;
            receiver.push(time, &frame(k));
            while let Some(event) = receiver.pop() {
                assert!(event.cycle.start < event.cycle.end, "{event:?}");
                let Some(heard) = number(&event) else {
                    n_between += 1;
                    if let Some(read) = event.reads[0] {
                        // The frame that is being taken in tells of the round before it.
                        assert_eq!(read.strength_ut, (1 + (k - 1).rem_euclid(250)) as f32);
                    }
                    continue;
                };
                assert_eq!(heard, k, "a round of another frame");
                let off_s = event.cycle.end.secs_since(at(k));
                assert!((0.0..2.6).contains(&off_s), "round {k} placed {off_s} s off");
                let before = last.replace(event).and_then(|event| number(&event));
                if let Some(before) = before.filter(|_| !event.cycle.is_first) {
                    assert_eq!(heard - before - 1, n_between, "seed {seed}, round {k} after {before}");
                }
                assert!(before.is_none_or(|before| heard > before), "round {k} after {before:?}");
                n_between = 0;
            }
        }
        let counts = receiver.counts();
        let n_seen = counts.n_rounds + counts.n_repeated + counts.n_late;
        assert_eq!((n_seen, counts.n_malformed + counts.n_foreign), (arrivals.len() as u64, 0));
        n_heard += counts.n_rounds;
        let mut distinct: Vec<_> = arrivals.iter().map(|&(k, _)| k).collect();
        distinct.sort_unstable();
        distinct.dedup();
        n_distinct += distinct.len() as u64;
    }
    // And nearly all that arrived in time are used.
    assert!(
        n_frames > 1_000_000 && n_heard * 100 > n_distinct * 98,
        "{n_heard} of {n_distinct}, {n_frames} frames"
    );
}

/// Which frame a card sends in each of `n_rounds`, if any: `(sequence, has just woken)`. It is reset now and then, sleeps, and
/// has its battery changed.
fn sent(seed: u64, n_rounds: i64) -> Vec<Option<(u8, bool)>> {
    let mut rng = crate::random::CounterRng::new(seed, 2);
    let mut next = |n: u32| rand::Rng::next_u32(&mut rng) % n;
    let (mut sequence, mut just_woke, mut silent_until) = (0u8, true, 0);
    (0..n_rounds)
        .map(|k| {
            if k >= silent_until && next(150) == 0 {
                just_woke = true;
                silent_until = k + i64::from(match next(3) {
                    // A watchdog's reset; a sleep; another battery, which nobody changes within ten seconds.
                    0 => next(3),
                    1 => 1 + next(600),
                    _ => 12 + next(300),
                });
                let is_forgotten = silent_until - k >= 12 && next(2) == 0;
                sequence =
                    if is_forgotten { 0 } else { sequence.wrapping_add(fieldwalk_card::DISCONTINUITY) };
            }
            if k < silent_until {
                return None;
            }
            let frame = (sequence, core::mem::take(&mut just_woke));
            sequence = sequence.wrapping_add(1);
            Some(frame)
        })
        .collect()
}

#[test]
fn no_reset_or_sleep_puts_a_round_in_the_wrong_place() {
    let (mut n_frames, mut n_followed, mut n_begun) = (0, 0, 0);
    for seed in 0..220 {
        let mut receiver = CardReceiver::default();
        let sent = sent(seed, 6_000);
        let (mut last, mut n_between) = (None::<i64>, 0);
        for (k, time) in arrivals(seed, 6_000) {
            let Some((sequence, just_woke)) = sent[k as usize] else { continue };
            n_frames += 1;
            let mut bytes = frame_of(k, CardFlags { just_woke, ..CardFlags::default() });
            bytes[9] = sequence;
            receiver.push(time, &bytes);
            while let Some(event) = receiver.pop() {
                let Some(heard) = number(&event) else {
                    n_between += 1;
                    continue;
                };
                assert_eq!(heard, k, "a round of another frame");
                let off_s = event.cycle.end.secs_since(at(k));
                assert!((0.0..2.6).contains(&off_s), "round {k} placed {off_s} s off");
                if event.cycle.is_first {
                    n_begun += 1;
                } else {
                    n_followed += 1;
                    let before = last.expect("a round before");
                    assert_eq!(heard - before - 1, n_between, "seed {seed}, round {k} after {before}");
                    let is_whole = (before..=k).all(|between| sent[between as usize].is_some());
                    let has_woken =
                        (before + 1..=k).any(|between| sent[between as usize].is_some_and(|(_, woke)| woke));
                    assert!(is_whole && !has_woken, "seed {seed}: {before} and {k} are of two lives");
                }
                last = Some(heard);
                n_between = 0;
            }
        }
    }
    assert!(
        n_frames > 1_000_000 && n_followed > 300_000 && n_begun > 2_000,
        "{n_frames} {n_followed} {n_begun}"
    );
}

proptest! {
    #[test]
    fn any_bytes_at_any_time_are_borne(
        pushes in proptest::collection::vec((any::<i64>(), any::<u8>(), any::<[u8; 31]>(), any::<bool>()), 0..60),
    ) {
        let mut receiver = CardReceiver::default();
        for (ns, sequence, mut bytes, is_frame) in pushes {
            if is_frame {
                let body = bytes;
                bytes = frame(0);
                bytes[12..].copy_from_slice(&body[12..]);
                bytes[9] = sequence;
                bytes[7] = 0x10 | body[0] & 0x0F;
            }
            receiver.push(Timestamp::from_nanos(ns), &bytes);
            while let Some(event) = receiver.pop() {
                prop_assert!(event.cycle.start < event.cycle.end || event.cycle.end == Timestamp::MIN);
                prop_assert!(event.level_heading_rad.is_finite() && event.n_steps <= 3);
                let finite = |read: &FieldRead| read.strength_ut.is_finite();
                prop_assert!(event.reads.iter().flatten().all(finite));
            }
        }
        prop_assert!(receiver.counts().n_malformed <= 60);
    }
}
