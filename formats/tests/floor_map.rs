//! Maps on disk: round trips, damage, versions.

use std::fs;
use std::path::PathBuf;

use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::{Point2, Segment};
use fieldwalk::map::{BuildingMap, Fingerprints, FloorMap, GridFrame, Layers, Transmitter};
use fieldwalk::sensor::TransmitterId;
use fieldwalk_formats::map::{
    MANIFEST_FILE, decode_floor, encode_floor, open_building, pack_building, unpack_building, write_building,
};
use proptest::prelude::*;

/// Every layer filled by `value(layer, node)`.
fn layers(frame: &GridFrame, value: impl Fn(usize, usize) -> f32) -> Layers {
    let mut layers = Layers::default();
    for (index, (name, _)) in Layers::default().named().into_iter().enumerate() {
        if let Some(layer) = layers.named_mut(name) {
            *layer = (0..frame.len()).map(|node| value(index, node)).collect();
        }
    }
    layers
}

/// A floor of 3 x 2 nodes with one of everything; every number is exact in the file.
fn small_floor(name: &str, ordinal: i32) -> FloorMap {
    let frame = GridFrame { origin: Point2::new(-0.5, 0.25), cell_m: 0.5, nx: 3, ny: 2 };
    let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.75)].map(|(x, y)| Point2::new(x, y)).to_vec();
    FloorMap {
        name: name.to_owned(),
        ordinal,
        plan: FloorPlan {
            width_m: 1.0,
            height_m: 0.75,
            outline: vec![Polygon { rings: vec![square.clone()] }],
            units: vec![Unit { name: "Café \"1\"".into(), walkable: true, polygon: Polygon::default() }],
            walls: vec![Segment { a: square[0], b: square[1] }],
            pathways: vec![square],
            georeference: None,
        },
        frame,
        layers: layers(&frame, |layer, node| layer as f32 * 8.0 - node as f32 * 0.25),
        routes: vec![vec![Point2::new(0.5, 0.25), Point2::new(1.0, 0.5)], vec![], vec![Point2::default()]],
        transmitters: vec![Transmitter {
            id: TransmitterId::BleAddress([1, 2, 3, 4, 5, 6]),
            position: Point2::new(0.25, 0.5),
            power_at_1m_dbm: -59.0,
            path_loss_exponent: 2.5,
            sigma_db: 4.0,
            n_sightings: 12,
        }],
        fingerprints: Fingerprints::default(),
    }
}

/// Fingerprints of the places of `heard`, where every transmitter has the same power.
fn heard_everywhere(heard: &[(Point2, f32)], n_transmitters: usize) -> Fingerprints {
    if heard.is_empty() {
        return Fingerprints::default();
    }
    let n = heard.len() as u32;
    Fingerprints {
        places: heard.iter().map(|(place, _)| *place).collect(),
        starts: (0..=n_transmitters as u32).map(|transmitter| transmitter * n).collect(),
        cells: (0..n_transmitters).flat_map(|_| 0..n).collect(),
        rssi_dbm: (0..n_transmitters).flat_map(|_| heard.iter().map(|(_, rssi_dbm)| *rssi_dbm)).collect(),
    }
}

/// [`small_floor`] with two cells that heard its transmitter.
fn small_floor_with_fingerprints() -> FloorMap {
    let heard = [(Point2::new(0.5, 0.25), -61.5), (Point2::new(1.5, 0.25), -70.25)];
    FloorMap { fingerprints: heard_everywhere(&heard, 1), ..small_floor("F1", 0) }
}

fn empty_folder(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("fieldwalk-{name}-{}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    dir
}

#[test]
fn a_floor_survives_being_written_and_its_bytes_are_fixed() {
    let floor = small_floor("F1", 0);
    let bytes = encode_floor(&floor).unwrap();
    assert_eq!(decode_floor(&bytes).unwrap(), floor);
    assert_eq!(encode_floor(&floor).unwrap(), bytes);
}

#[test]
fn version_1_stays_readable() {
    let floor = decode_floor(include_bytes!("fixtures/map_v1.safetensors")).unwrap();
    let expected = small_floor("F1", 0);
    assert_eq!((&floor.name, floor.ordinal, floor.frame), (&expected.name, expected.ordinal, expected.frame));
    assert_eq!(floor.plan, expected.plan);
    assert_eq!(floor.routes, expected.routes);
    assert_eq!(floor.transmitters, expected.transmitters);
    let layers_then = [
        "field_x_ut",
        "field_y_ut",
        "field_z_ut",
        "field_variance_ut2",
        "strength_ut",
        "compass_deviation_rad",
        "route_distance_m",
    ];
    for (name, layer) in floor.layers.named() {
        match layers_then.iter().position(|then| *then == name) {
            Some(index) => assert_eq!(layer[3], index as f32 * 8.0 - 0.75, "{name}"),
            None => assert!(layer.iter().all(|value| value.is_nan()), "{name} was unknown then"),
        }
    }
}

#[test]
fn version_1_with_fingerprints_stays_readable() {
    let floor = decode_floor(include_bytes!("fixtures/map_v1_fingerprints.safetensors")).unwrap();
    assert_eq!(floor, small_floor_with_fingerprints());
}

#[test]
fn fingerprints_that_do_not_fit_are_refused() {
    let breaks: [fn(&mut Fingerprints); 4] = [
        |f| f.cells[1] = 2,
        |f| f.starts = vec![0, 1],
        |f| f.rssi_dbm[0] = f32::NAN,
        |f| f.places[0].x_m = 1e300,
    ];
    for (k, break_it) in breaks.iter().enumerate() {
        let mut floor = small_floor_with_fingerprints();
        break_it(&mut floor.fingerprints);
        let error = encode_floor(&floor).unwrap_err();
        assert!(error.to_string().contains("fingerprints"), "{k}: {error}");
    }
    // The same in a file that nobody's encoder wrote: a cell that is none.
    let mut bytes = encode_floor(&small_floor_with_fingerprints()).unwrap();
    let cells = [0_u32, 1].map(u32::to_le_bytes).concat();
    let at = bytes.windows(8).rposition(|window| window == cells).unwrap();
    bytes[at + 4] = 9;
    sign(&mut bytes);
    assert!(decode_floor(&bytes).unwrap_err().to_string().contains("fingerprints"));
}

#[test]
fn the_metadata_is_one_key_of_sorted_json() {
    let bytes = encode_floor(&small_floor("F1", 0)).unwrap();
    let n = usize::try_from(u64::from_le_bytes(bytes[..8].try_into().unwrap())).unwrap();
    let header: serde_json::Value = serde_json::from_slice(&bytes[8..8 + n]).unwrap();
    let metadata = header["__metadata__"].as_object().unwrap();
    assert_eq!(metadata.len(), 1);
    let text = metadata["fieldwalk"].as_str().unwrap();
    let positions: Vec<_> =
        ["\"format\"", "\"frame\"", "\"name\"", "\"ordinal\"", "\"plan\"", "\"sha256\"", "\"transmitters\""]
            .iter()
            .map(|key| text.find(key).unwrap())
            .collect();
    assert!(positions.is_sorted(), "{text}");
    assert!(
        text.contains(r#""frame":{"cell_m":0.5,"nx":3,"ny":2,"origin":{"x_m":-0.5,"y_m":0.25}}"#),
        "{text}"
    );
}

#[test]
fn what_half_floats_cannot_hold_is_clamped_and_gaps_stay_gaps() {
    let mut floor = small_floor("F1", 0);
    floor.layers.field_x_ut =
        vec![1e9, -1e9, f32::NAN, f32::from_bits(0xffc0_1234), f32::INFINITY, 48.437_5 + 0.01];
    let bytes = encode_floor(&floor).unwrap();
    let x = decode_floor(&bytes).unwrap().layers.field_x_ut;
    assert_eq!((x[0], x[1], x[4]), (65_504.0, -65_504.0, f32::INFINITY));
    assert!(x[2].is_nan() && x[3].is_nan());
    assert!((x[5] - 48.447_5).abs() <= 0.016);
    floor.layers.field_x_ut[3] = f32::NAN;
    assert_eq!(encode_floor(&floor).unwrap(), bytes, "every gap is written alike");
}

#[test]
fn a_floor_that_does_not_fit_together_is_not_written() {
    let spoilt: [fn(&mut FloorMap); 7] = [
        |floor| floor.layers.strength_ut.truncate(5),
        |floor| floor.frame.nx = usize::MAX,
        |floor| floor.frame.cell_m = f64::NAN,
        |floor| floor.frame.cell_m = 0.0,
        |floor| floor.routes[0][0].x_m = 1e300,
        |floor| floor.transmitters[0].sigma_db = f64::INFINITY,
        |floor| floor.plan.width_m = f64::NAN,
    ];
    for spoil in spoilt {
        let mut floor = small_floor("F1", 0);
        spoil(&mut floor);
        assert!(encode_floor(&floor).is_err());
    }
}

#[test]
fn a_small_file_cannot_ask_for_a_large_grid() {
    let mut bytes = encode_floor(&FloorMap { name: "x".repeat(20), ..FloorMap::default() }).unwrap();
    let change = |bytes: &mut Vec<u8>, from: &str, to: &str| {
        let text = String::from_utf8(bytes.split_off(8)).unwrap();
        assert!(text.contains(from));
        let text = text.replace(from, to);
        *bytes = (text.len() as u64).to_le_bytes().to_vec();
        bytes.extend(text.into_bytes());
    };
    change(&mut bytes, r#"\"cell_m\":0.0,\"nx\":0,\"ny\":0"#, r#"\"cell_m\":0.5,\"nx\":5000,\"ny\":5000"#);
    change(&mut bytes, "\"shape\":[0,0]", "\"shape\":[5000,0]");
    sign(&mut bytes);
    assert!(decode_floor(&bytes).unwrap_err().message().contains("[5000, 0]"));
    for (name, _) in Layers::default().named() {
        change(&mut bytes, name, &format!("{name}_no_more"));
    }
    sign(&mut bytes);
    assert_eq!(decode_floor(&bytes).unwrap_err().message(), "no layer at all");
}

#[test]
fn an_empty_floor_is_a_floor() {
    let floor = FloorMap::default();
    assert_eq!(decode_floor(&encode_floor(&floor).unwrap()).unwrap(), floor);
}

#[test]
fn damage_to_any_byte_is_noticed() {
    let floor = small_floor("F1", 0);
    let bytes = encode_floor(&floor).unwrap();
    for at in 0..bytes.len() {
        for mask in [0x01, 0x02, 0x10, 0x20, 0x80, 0xff] {
            let mut damaged = bytes.clone();
            damaged[at] ^= mask;
            assert!(decode_floor(&damaged).is_err(), "byte {at} ^ {mask:#x}");
        }
    }
    for length in 0..bytes.len() {
        assert!(decode_floor(&bytes[..length]).is_err(), "cut at {length}");
    }
    assert!(decode_floor(&[bytes.as_slice(), b"x"].concat()).is_err());
}

#[test]
fn a_changed_map_a_newer_map_and_no_map_are_told_apart() {
    let bytes = encode_floor(&small_floor("F1", 0)).unwrap();
    let replaced = |from: &str, to: &str| {
        assert_eq!(from.len(), to.len());
        let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut changed = bytes.clone();
        changed[at..at + to.len()].copy_from_slice(to.as_bytes());
        decode_floor(&changed).unwrap_err()
    };
    assert!(replaced(r#"\"version\":1"#, r#"\"version\":2"#).is_newer_version());
    assert!(replaced(r#"\"nx\":3"#, r#"\"nx\":4"#).is_corrupt());
    assert!(replaced("fieldwalk-floor", "fieldwork-floor").message().contains("fieldwork-floor"));
    assert!(replaced(r#""fieldwalk""#, r#""fieldwork""#).message().contains("not a floor map"));
    assert!(decode_floor(b"PK\x03\x04 a zip file").unwrap_err().message().contains("not a floor map"));
}

#[test]
fn a_building_survives_being_written() {
    let dir = empty_folder("building");
    let building = BuildingMap {
        name: "Mall".into(),
        floors: vec![small_floor("B1", -1), small_floor("F1", 0), small_floor("f1", 1)],
    };
    let mut shuffled = building.clone();
    shuffled.floors.swap(0, 2);
    write_building(&dir, &shuffled).unwrap();
    write_building(&dir, &shuffled).unwrap();
    assert_eq!(open_building(&dir).unwrap(), building);
    let mut files: Vec<_> = fs::read_dir(&dir).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["B1.safetensors", "F1.safetensors", MANIFEST_FILE, "f1_2.safetensors"]);
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn a_building_with_a_wrong_or_missing_part_is_refused() {
    let dir = empty_folder("parts");
    assert!(open_building(&dir).unwrap_err().is_not_found());
    let building =
        BuildingMap { name: "Mall".into(), floors: vec![small_floor("F1", 0), small_floor("F2", 1)] };
    write_building(&dir, &building).unwrap();
    let (first, second) = (dir.join("F1.safetensors"), dir.join("F2.safetensors"));

    let other = encode_floor(&small_floor("F9", 9)).unwrap();
    fs::write(&second, other).unwrap();
    let error = open_building(&dir).unwrap_err();
    assert!(error.is_corrupt() && error.path() == Some(second.as_path()), "{error}");

    fs::remove_file(&first).unwrap();
    let error = open_building(&dir).unwrap_err();
    assert!(error.is_not_found() && error.path() == Some(first.as_path()), "{error}");

    let manifest = fs::read_to_string(dir.join(MANIFEST_FILE)).unwrap();
    fs::write(dir.join(MANIFEST_FILE), manifest.replace("\"version\": 1", "\"version\": 7")).unwrap();
    assert!(open_building(&dir).unwrap_err().is_newer_version());
    fs::remove_dir_all(&dir).unwrap();
}

fn floor() -> impl Strategy<Value = FloorMap> {
    let id = prop_oneof![
        any::<[u8; 6]>().prop_map(TransmitterId::BleAddress),
        any::<[u8; 6]>().prop_map(TransmitterId::WifiBssid),
        (any::<[u8; 16]>(), any::<u16>(), any::<u16>())
            .prop_map(|(uuid, major, minor)| TransmitterId::Ibeacon { uuid, major, minor }),
    ];
    let number = || (-1e3_f32..1e3).prop_map(f64::from);
    let point = move || (number(), number()).prop_map(|(x, y)| Point2::new(x, y));
    let transmitter = (id, point(), number(), number(), number(), any::<u32>()).prop_map(
        |(id, position, power_at_1m_dbm, path_loss_exponent, sigma_db, n_sightings)| Transmitter {
            id,
            position,
            power_at_1m_dbm,
            path_loss_exponent,
            sigma_db,
            n_sightings,
        },
    );
    // Every pattern of sixteen bits is a half float; NaNs are left out here, since they equal nothing.
    let half = any::<u16>().prop_map(|bits| {
        let value = half::f16::from_bits(bits);
        if value.is_nan() { 0.0 } else { value.to_f32() }
    });
    (
        ".{0,12}",
        any::<i32>(),
        (0_usize..6, 0_usize..6, point(), 0.01..10.0_f64),
        proptest::collection::vec(half, 25 * 32),
        proptest::collection::vec(proptest::collection::vec(point(), 0..4), 0..4),
        proptest::collection::vec(transmitter, 0..4),
        (0.0..1e3, proptest::collection::vec(point(), 0..5)),
        proptest::collection::vec((point(), -100_f32..-20.0), 0..5),
    )
        .prop_map(
            |(
                name,
                ordinal,
                (nx, ny, origin, cell_m),
                halves,
                routes,
                transmitters,
                (width_m, ring),
                heard,
            )| {
                let frame = GridFrame { origin, cell_m, nx, ny };
                let plan = FloorPlan { width_m, pathways: vec![ring], ..FloorPlan::default() };
                let layers = layers(&frame, |layer, node| halves[(layer * 25 + node) % halves.len()]);
                let fingerprints = heard_everywhere(&heard, transmitters.len());
                FloorMap { name, ordinal, plan, frame, layers, routes, transmitters, fingerprints }
            },
        )
}

proptest! {
    #[test]
    fn floors_survive_being_written(floor in floor()) {
        let bytes = encode_floor(&floor).unwrap();
        let again = decode_floor(&bytes).unwrap();
        prop_assert_eq!(encode_floor(&again).unwrap(), bytes);
        prop_assert_eq!(again, floor);
    }

    #[test]
    fn any_bytes_are_decoded_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(decode_floor(&bytes).is_err());
    }

    /// Headers that are valid safetensors around metadata that is not quite right.
    #[test]
    fn forged_files_are_decoded_without_panic(
        floor in floor(),
        at: prop::sample::Index,
        byte: u8,
        is_signed: bool,
    ) {
        let mut bytes = encode_floor(&floor).unwrap();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if is_signed {
            sign(&mut bytes);
        }
        let _ = decode_floor(&bytes);
    }
}

/// Puts the right digest into a changed file, as a forger would.
fn sign(bytes: &mut [u8]) {
    use sha2::Digest as _;
    let key = br#"\"sha256\":\""#;
    let Some(at) = bytes.windows(key.len()).position(|window| window == key).map(|at| at + key.len()) else {
        return;
    };
    bytes[at..at + 64].fill(b'0');
    let digest = sha2::Sha256::digest(&*bytes);
    for (digits, byte) in bytes[at..at + 64].chunks_mut(2).zip(digest) {
        digits.copy_from_slice(format!("{byte:02x}").as_bytes());
    }
}

#[test]
fn a_building_is_one_archive_too_and_any_tar_makes_one() {
    let floors = vec![small_floor("Ground", 0), small_floor("Up", 1)];
    let building = BuildingMap { name: "Hall".into(), floors };
    let packed = pack_building(&building).unwrap();
    assert_eq!(pack_building(&building).unwrap(), packed);
    assert_eq!(unpack_building(&packed).unwrap(), building);

    let dir = empty_folder("archive");
    let (folder, file) = (dir.join("hall.map"), dir.join("hall.tar"));
    write_building(&folder, &building).unwrap();
    fs::write(&file, &packed).unwrap();
    assert_eq!(open_building(&file).unwrap(), building);
    // As `tar -cf hall.tar hall.map` packs it: with folders, and with files that are none of ours.
    fs::write(folder.join("notes.txt"), "not a map").unwrap();
    let mut by_hand = tar::Builder::new(Vec::new());
    by_hand.append_dir_all("hall.map", &folder).unwrap();
    assert_eq!(unpack_building(&by_hand.into_inner().unwrap()).unwrap(), building);
    fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn an_archive_that_is_cut_or_changed_anywhere_is_refused() {
    let building = BuildingMap { name: "Hall".into(), floors: vec![small_floor("F1", 0)] };
    let packed = pack_building(&building).unwrap();
    // Two empty blocks end an archive; tar does without them.
    for length in (0..packed.len() - 1_024).step_by(97) {
        assert!(unpack_building(&packed[..length]).is_err(), "{length} bytes");
    }
    let content = 512..512 + encode_floor(&building.floors[0]).unwrap().len();
    for at in content.step_by(53) {
        let mut changed = packed.clone();
        changed[at] ^= 0x20;
        assert!(unpack_building(&changed).is_err(), "byte {at}");
    }
    let error = unpack_building(b"PK\x03\x04 and so on").unwrap_err();
    assert!(error.remedy().contains("tar -cf"), "{error}");
}

proptest! {
    #[test]
    fn no_change_of_an_archive_panics(at in 0usize..4_000, byte: u8, cut in 0usize..8_000) {
        let building = BuildingMap { name: "Hall".into(), floors: vec![small_floor("F1", 0)] };
        let mut packed = pack_building(&building).unwrap();
        packed.truncate(cut);
        if let Some(b) = packed.get_mut(at) {
            *b = byte;
        }
        if let Ok(read) = unpack_building(&packed) {
            prop_assert_eq!(read.floors, building.floors);
        }
    }
}
