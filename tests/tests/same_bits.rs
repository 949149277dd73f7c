//! Same recording, same seed, same bits: on every machine, and however the samples are delivered.
#![allow(clippy::expect_used, clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, LazyLock};

use fieldwalk::Rejections;
use fieldwalk::geometry::Point2;
use fieldwalk::map::{Fingerprints, FloorIndex};
use fieldwalk::positioner::{Fix, Positioner};
use fieldwalk::sensor::{RadioSighting, Reading, Sample, TransmitterId};
use fieldwalk::system::Recipe;
use fieldwalk::time::{Duration, Timestamp};
use fieldwalk_tests::synthetic::{Floor, Recorded};

/// The digests that every machine must find, one `name digest` a line.
const GOLDEN: &str = include_str!("../golden/same_bits.txt");
const GOLDEN_FILE: &str = "golden/same_bits.txt";
const UPDATE: &str = "FIELDWALK_UPDATE_GOLDEN";

const SEED: u64 = 7;

struct World {
    floor: Arc<FloorIndex>,
    walk: Recorded,
}

static WORLD: LazyLock<World> = LazyLock::new(|| {
    let floor = Floor::new(1);
    let map = floor.surveyed_map().expect("the synthetic survey gives a map");
    World { floor: Arc::new(FloorIndex::new(map)), walk: floor.round_trip(1) }
});

impl World {
    fn positioner(&self, recipe: &Recipe) -> Positioner {
        let mut positioner = Positioner::new(Arc::clone(&self.floor), recipe.clone(), SEED);
        positioner.hint(self.walk.hint(Point2::new(0.6, -0.4)).unwrap()).unwrap();
        positioner
    }
}

fn recipes() -> Vec<Recipe> {
    Recipe::NAMES.iter().map(|name| Recipe::named(name).unwrap()).collect()
}

/// FNV-1a, 64 bits.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

fn bits(fix: &Fix) -> [u64; 8] {
    let Fix { time, floor, position, heading_rad, speed_m_s, radius_68_m, radius_95_m, .. } = fix;
    let numbers = [position.x_m, position.y_m, *heading_rad, *speed_m_s, *radius_68_m, *radius_95_m];
    let [x, y, heading, speed, r68, r95] = numbers.map(f64::to_bits);
    [time.as_nanos() as u64, *floor as u64, x, y, heading, speed, r68, r95]
}

fn digest_of_fixes(fixes: &[Fix]) -> u64 {
    let mut digest = Digest::new();
    for word in fixes.iter().flat_map(bits) {
        digest.add(&word.to_le_bytes());
    }
    digest.0
}

fn all_bits(fixes: &[Fix]) -> Vec<[u64; 8]> {
    fixes.iter().map(bits).collect()
}

fn digests() -> BTreeMap<String, u64> {
    let mut digests = BTreeMap::new();
    for recipe in recipes() {
        let mut positioner = WORLD.positioner(&recipe);
        let fixes: Vec<Fix> = WORLD.walk.samples.iter().filter_map(|s| positioner.push(*s)).collect();
        assert!(fixes.len() > 70, "{}: {} fixes", recipe.name, fixes.len());
        digests.insert(format!("fixes/{}", recipe.name), digest_of_fixes(&fixes));
    }
    let map = WORLD.floor.map();
    for (name, layer) in map.layers.named() {
        let mut digest = Digest::new();
        assert_eq!(layer.len(), map.frame.len());
        for value in layer {
            digest.add(&value.to_bits().to_le_bytes());
        }
        digests.insert(format!("map/{name}"), digest.0);
    }
    let mut digest = Digest::new();
    assert!(!map.transmitters.is_empty());
    for t in &map.transmitters {
        let numbers = [t.position.x_m, t.position.y_m, t.power_at_1m_dbm, t.path_loss_exponent, t.sigma_db];
        for number in numbers {
            digest.add(&number.to_bits().to_le_bytes());
        }
    }
    digests.insert("map/transmitters".into(), digest.0);
    let Fingerprints { places, starts, cells, rssi_dbm } = &map.fingerprints;
    let mut digest = Digest::new();
    assert!(!rssi_dbm.is_empty());
    places.iter().flat_map(|p| [p.x_m, p.y_m]).for_each(|m| digest.add(&m.to_bits().to_le_bytes()));
    starts.iter().chain(cells).for_each(|count| digest.add(&count.to_le_bytes()));
    rssi_dbm.iter().for_each(|dbm| digest.add(&dbm.to_bits().to_le_bytes()));
    digests.insert("map/fingerprints".into(), digest.0);
    digests
}

#[test]
fn every_machine_finds_the_committed_bits() {
    let found: String = digests().iter().map(|(name, digest)| format!("{name} {digest:016x}\n")).collect();
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(GOLDEN_FILE), &found).unwrap();
        return;
    }
    assert!(
        found == GOLDEN,
        "the bits have changed; this machine finds\n\n{found}\nand {GOLDEN_FILE} says\n\n{GOLDEN}\n\
         If the change is meant: {UPDATE}=1 cargo test -p fieldwalk-tests --test same_bits, then check the result on \
         the other architecture too (cargo xtask test).",
    );
}

#[test]
fn a_second_run_gives_the_same_fixes() {
    for recipe in recipes() {
        let run = || {
            let mut positioner = WORLD.positioner(&recipe);
            WORLD.walk.samples.iter().filter_map(|s| positioner.push(*s)).collect::<Vec<Fix>>()
        };
        assert_eq!(all_bits(&run()), all_bits(&run()), "{}", recipe.name);
    }
}

#[test]
fn another_seed_gives_other_fixes() {
    // RADAR draws nothing once it has matched, and the nearest neighbour never.
    for recipe in recipes().into_iter().filter(|recipe| recipe.radar.is_none() && recipe.name != "nearest") {
        let run = |seed: u64| {
            let mut positioner = Positioner::new(Arc::clone(&WORLD.floor), recipe.clone(), seed);
            positioner.hint(WORLD.walk.hint(Point2::default()).unwrap()).unwrap();
            let samples = WORLD.walk.samples.iter().take(2_000);
            samples.filter_map(|s| positioner.push(*s)).collect::<Vec<Fix>>()
        };
        assert_ne!(all_bits(&run(1)), all_bits(&run(2)), "{}", recipe.name);
    }
}

/// The walk's samples in blocks of `block_ms`.
fn blocks(block_ms: i64) -> Vec<Vec<Sample>> {
    let mut blocks = BTreeMap::<i64, Vec<Sample>>::new();
    for sample in &WORLD.walk.samples {
        blocks.entry(sample.time.as_nanos() / (block_ms * 1_000_000)).or_default().push(*sample);
    }
    blocks.into_values().collect()
}

/// The fix after each block, and after the rest; `rearrange` orders each block's samples.
fn fixes_by_block(
    recipe: &Recipe,
    blocks: &[Vec<Sample>],
    rearrange: impl Fn(&mut Vec<Sample>),
) -> Vec<[u64; 8]> {
    let mut positioner = WORLD.positioner(recipe);
    let mut fixes = Vec::new();
    for block in blocks {
        let mut block = block.clone();
        rearrange(&mut block);
        for sample in block {
            positioner.push(sample);
        }
        fixes.extend(positioner.fix());
    }
    positioner.flush();
    fixes.extend(positioner.fix());
    assert_eq!(positioner.rejections(), Rejections::default(), "{}", recipe.name);
    all_bits(&fixes)
}

/// A fixed, well-mixed order.
fn shuffle(samples: &mut [Sample]) {
    samples.sort_by_key(|sample| {
        let mut digest = Digest::new();
        digest.add(&sample.time.as_nanos().to_le_bytes());
        digest.0
    });
}

#[test]
fn samples_that_arrive_out_of_order_change_nothing() {
    let blocks = blocks(150);
    for recipe in recipes() {
        let in_order = fixes_by_block(&recipe, &blocks, |_| {});
        let shuffled = fixes_by_block(&recipe, &blocks, |block| shuffle(block));
        assert!(in_order.len() > 400);
        assert_eq!(in_order, shuffled, "{}", recipe.name);
    }
}

#[test]
fn batches_of_each_sensor_change_nothing() {
    fn sensor(sample: &Sample) -> u8 {
        match sample.reading {
            Reading::Radio(_) => 0,
            Reading::UncalibratedMagneticField { .. } => 1,
            Reading::AngularRate(_) => 2,
            Reading::SpecificForce(_) => 3,
            _ => 4,
        }
    }
    let blocks = blocks(100);
    for recipe in recipes() {
        let in_order = fixes_by_block(&recipe, &blocks, |_| {});
        let by_sensor = fixes_by_block(&recipe, &blocks, |block| block.sort_by_key(sensor));
        let reversed =
            fixes_by_block(&recipe, &blocks, |block| block.sort_by_key(|s| (3 - sensor(s), s.time)));
        assert_eq!(in_order, by_sensor, "{}", recipe.name);
        assert_eq!(in_order, reversed, "{}", recipe.name);
    }
}

#[test]
fn packets_of_one_instant_count_the_same_in_any_order() {
    let transmitter = WORLD.floor.map().transmitters[0].id;
    let run = |order: [usize; 3]| {
        let mut positioner = WORLD.positioner(&Recipe::fused());
        let mut fixes = Vec::new();
        for sample in WORLD.walk.samples.iter().take(2_000) {
            if let Reading::Radio(_) = sample.reading {
                let powers = [-61.1f32, -70.7, -83.3];
                for at in order {
                    let reading = Reading::Radio(RadioSighting { transmitter, rssi_dbm: powers[at] });
                    fixes.extend(positioner.push(Sample { time: sample.time, reading }));
                }
            } else {
                fixes.extend(positioner.push(*sample));
            }
        }
        all_bits(&fixes)
    };
    let first = run([0, 1, 2]);
    assert!(first.len() > 10);
    for order in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        assert!(first == run(order), "another order than {order:?} gives other bits");
    }
}

#[test]
fn a_restored_snapshot_continues_to_the_bit() {
    let samples = &WORLD.walk.samples;
    for recipe in recipes() {
        let mut original = WORLD.positioner(&recipe);
        // Before any sample, between two steps, and late in the walk.
        let mut at = 0;
        for stop in [0, 1_003, 2 * samples.len() / 3] {
            for sample in &samples[at..stop] {
                original.push(*sample);
            }
            at = stop;
            let json = serde_json::to_string(&original.snapshot()).unwrap();
            let mut restored = Positioner::new(Arc::clone(&WORLD.floor), recipe.clone(), SEED);
            let snapshot = serde_json::from_str(&json)
                .unwrap_or_else(|error| panic!("{}, after {stop} samples: {error}", recipe.name));
            restored.restore(snapshot).unwrap();
            let name = &recipe.name;
            assert_eq!(restored.fix().map(|f| bits(&f)), original.fix().map(|f| bits(&f)), "{name}, {stop}");
            let mut continued = original.clone();
            for sample in &samples[at..] {
                let (a, b) = (continued.push(*sample), restored.push(*sample));
                assert_eq!(a.map(|f| bits(&f)), b.map(|f| bits(&f)), "{name}, {stop}, {:?}", sample.time);
            }
            continued.flush();
            restored.flush();
            assert_eq!(restored.fix().map(|f| bits(&f)), continued.fix().map(|f| bits(&f)), "{name}, {stop}");
        }
    }
}

#[test]
fn a_restored_snapshot_forgets_what_the_positioner_knew() {
    let recipe = Recipe::fused();
    let fresh = Positioner::new(Arc::clone(&WORLD.floor), recipe.clone(), SEED);
    let mut walked = WORLD.positioner(&recipe);
    for sample in WORLD.walk.samples.iter().take(2_000) {
        walked.push(*sample);
    }
    walked.restore(fresh.snapshot()).unwrap();
    assert_eq!(walked.fix(), None);
    assert!(walked.fix_at(Timestamp::MAX).is_err());
}

#[test]
fn asking_for_fixes_changes_nothing() {
    for recipe in recipes() {
        let (mut asked, mut left_alone) = (WORLD.positioner(&recipe), WORLD.positioner(&recipe));
        for (k, sample) in WORLD.walk.samples.iter().enumerate() {
            let (a, b) = (asked.push(*sample), left_alone.push(*sample));
            assert_eq!(a.map(|f| bits(&f)), b.map(|f| bits(&f)), "{}", recipe.name);
            if k % 60 == 0 {
                let later = sample.time + Duration::from_millis(k as i64 % 7_000);
                let first = asked.fix_at(later);
                assert_eq!(first, asked.fix_at(later));
                // The hint's time is the earliest, even while the first samples wait for 200 ms to be consumed.
                assert!(asked.fix_at(Timestamp::MIN).is_err(), "{k}");
            }
        }
    }
}

#[test]
fn unknown_transmitters_change_nothing() {
    let (mut crowded, mut quiet) = (WORLD.positioner(&Recipe::fused()), WORLD.positioner(&Recipe::fused()));
    for sample in WORLD.walk.samples.iter().take(3_000) {
        for k in 0..3 {
            let sighting =
                RadioSighting { transmitter: TransmitterId::WifiBssid([9, 9, 9, 9, 9, k]), rssi_dbm: -30.0 };
            let before = Sample { time: sample.time, reading: Reading::Radio(sighting) };
            crowded.push(before);
        }
        // A stranger at the same instant may be what completes the window: compare what is known, not when.
        crowded.push(*sample);
        quiet.push(*sample);
        assert_eq!(crowded.fix().map(|f| bits(&f)), quiet.fix().map(|f| bits(&f)));
    }
}
