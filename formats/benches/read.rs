//! How fast recordings and maps are read: `cargo bench -p fieldwalk-formats`.

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fieldwalk::floor_plan::{FloorPlan, Polygon, Unit};
use fieldwalk::geometry::Point2;
use fieldwalk::map::{FloorMap, GridFrame, Layers};
use fieldwalk_formats::ilc::TraceReader;
use fieldwalk_formats::map::{decode_floor, encode_floor};

/// Ten seconds of a walk as the public collection writes it: five lines every 20 ms, a WiFi scan every two seconds.
fn trace_text() -> String {
    let mut text = String::new();
    let mut noise = 1_u32;
    let mut value = |scale: f32| {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (noise as f32 / u32::MAX as f32 - 0.5) * scale
    };
    for tick in 0..500_u64 {
        let ms = 1_574_559_495_401 + tick * 20;
        for (kind, scale) in
            [("ACCELEROMETER", 20.0), ("MAGNETIC_FIELD", 90.0), ("GYROSCOPE", 2.0), ("ROTATION_VECTOR", 1.0)]
        {
            let _ =
                writeln!(text, "{ms}\tTYPE_{kind}\t{}\t{}\t{}\t3", value(scale), value(scale), value(scale));
        }
        let _ = write!(text, "{ms}\tTYPE_MAGNETIC_FIELD_UNCALIBRATED");
        for _ in 0..6 {
            let _ = write!(text, "\t{}", value(600.0));
        }
        text.push_str("\t3\n");
        for row in 0..if tick % 100 == 0 { 250 } else { 0 } {
            let _ =
                writeln!(text, "{ms}\tTYPE_WIFI\tguest\ta8:0c:ca:03:9d:{row:02x}\t-49\t2422\t{}", ms - 900);
        }
    }
    text
}

/// A mall's floor: 240 m x 177 m at half a metre, with 170 shops.
fn mall_floor() -> FloorMap {
    let frame = GridFrame::covering(239.5, 176.5, 0.5);
    let mut layers = Layers::default();
    for (name, _) in Layers::default().named() {
        if let Some(layer) = layers.named_mut(name) {
            *layer = (0..frame.len()).map(|node| (node % 977) as f32 * 0.05).collect();
        }
    }
    let shop = |n: u32| {
        let (x, y) = (f64::from(n % 17) * 14.0, f64::from(n / 17) * 17.0);
        let ring =
            (0..8).map(|k| Point2::new(x, y) + Point2::from_polar(5.0, f64::from(k) * 0.785)).collect();
        Unit { name: format!("Shop {n}"), walkable: false, polygon: Polygon { rings: vec![ring] } }
    };
    let plan = FloorPlan {
        width_m: 240.0,
        height_m: 177.0,
        units: (0..170).map(shop).collect(),
        ..FloorPlan::default()
    };
    FloorMap { name: "F1".to_owned(), plan, frame, layers, ..FloorMap::default() }
}

fn read_trace(criterion: &mut Criterion) {
    let text = trace_text();
    let mut group = criterion.benchmark_group("ilc_trace");
    group.throughput(Throughput::Bytes(text.len() as u64));
    group.bench_function("read", |bencher| {
        bencher
            .iter(|| TraceReader::new(black_box(text.as_bytes()), "walk.txt").filter(Result::is_ok).count());
    });
    group.finish();
}

fn map(criterion: &mut Criterion) {
    let floor = mall_floor();
    let Ok(bytes) = encode_floor(&floor) else { return };
    let mut group = criterion.benchmark_group("floor_map");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("decode", |bencher| bencher.iter(|| decode_floor(black_box(&bytes))));
    group.bench_function("encode", |bencher| bencher.iter(|| encode_floor(black_box(&floor))));
    group.finish();
}

criterion_group!(benches, read_trace, map);
criterion_main!(benches);
