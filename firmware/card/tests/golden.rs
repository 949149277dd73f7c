//! The golden frames: `firmware/golden/` holds readings, and the frames that every build makes of them.

use std::cell::Cell;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use fieldwalk_card::replay::{ReplayCard, SensorReading, finish, lasts_another_round};
use fieldwalk_card::{CardParams, RoundOutcome};
use fieldwalk_codec::{CardFrame, CardRepr};
use fieldwalk_kmx62::{AccelerationRange, BufferEntry};

fn frames(entries: &[BufferEntry]) -> Vec<(u64, [u8; 31])> {
    let now_us = Cell::new(0);
    let readings = entries.iter().map(|entry| SensorReading {
        force_m_s2: entry.acceleration_m_s2(AccelerationRange::G4),
        field_ut: entry.field_ut(),
    });
    let mut card = ReplayCard::switched_on(&now_us, readings, CardParams::of_card(1));
    let mut frames = Vec::new();
    while lasts_another_round(entries.len(), now_us.get()) {
        let RoundOutcome::Sent(frame) = finish(card.round()) else { unreachable!("a walk is no sleep") };
        frames.push((now_us.get(), frame));
    }
    frames
}

#[test]
fn the_golden_readings_give_the_golden_frames() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden");
    let bytes = fs::read(folder.join("walk-01.readings")).unwrap();
    let (entries, rest) = bytes.as_chunks();
    assert!(rest.is_empty() && entries.len() == 1_500);
    let entries: Vec<BufferEntry> =
        entries.iter().map(|bytes| BufferEntry::from_bytes(*bytes).expect("no filler")).collect();
    let frames = frames(&entries);
    let mut text = String::new();
    for (time_us, frame) in &frames {
        let digits: String = frame.iter().map(|byte| format!("{byte:02x}")).collect();
        writeln!(text, "{time_us} {digits}").unwrap();
    }
    let golden = folder.join("walk-01.frames.txt");
    if std::env::var_os("FIELDWALK_UPDATE_GOLDEN").is_some() {
        fs::write(&golden, &text).unwrap();
    }
    assert_eq!(text, fs::read_to_string(&golden).unwrap());
    // They are frames of a walk: numbered, complete but for the field before the first, with the field of an office.
    assert_eq!(frames.len(), 59);
    for (k, (_, frame)) in frames.iter().enumerate() {
        let repr = CardRepr::parse(&CardFrame::new_checked(frame).unwrap()).unwrap();
        let round = repr.to_physical();
        assert_eq!((usize::from(repr.header.sequence), repr.header.card_id), (k, 1));
        assert!((0..3).all(|third| (10.0..100.0).contains(&round.b_h_ut[third].hypot(round.b_v_ut[third]))));
        assert_eq!(round.previous_b_ut.iter().any(|b| b.is_nan()), k == 0);
    }
}
