//! Small floors in the public layout, written by the tests, and the command run on them.
#![allow(dead_code)]

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Readings a second.
const RATE_HZ: f64 = 50.0;
const STEPS_PER_S: f64 = 1.8;
const SPEED_M_S: f64 = 1.2;
/// Time to turn at a corner, in seconds.
const TURN_S: f64 = 1.5;
/// The corners of the loop round the shop, in metres.
const CORNERS: [[f64; 2]; 4] = [[3.0, 3.0], [17.0, 3.0], [17.0, 17.0], [3.0, 17.0]];
const BEACONS: [[f64; 2]; 3] = [[1.0, 1.0], [19.0, 10.0], [5.0, 19.0]];

/// An empty folder for the test called `name`.
pub fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    if dir.exists() {
        fs::remove_dir_all(&dir).unwrap();
    }
    fs::create_dir_all(&dir).unwrap();
    dir
}

/// Writes a floor of 20 m by 20 m with one shop and `n_walks` walks round it, and gives its folder.
pub fn write_floor(site: &Path, floor: &str, n_walks: usize) -> PathBuf {
    let dir = site.join(floor);
    fs::create_dir_all(dir.join("traces")).unwrap();
    fs::write(dir.join("floor_info.json"), r#"{"map_info": {"width": 20.0, "height": 20.0}}"#).unwrap();
    let shop = ring([[6.0, 6.0], [14.0, 6.0], [14.0, 14.0], [6.0, 14.0]]);
    let outline = ring([[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]]);
    fs::write(dir.join("geojson_map.json"), plan(&[("floor", outline), ("shop", shop)])).unwrap();
    for k in 0..n_walks {
        fs::write(trace(&dir, k), walk(k)).unwrap();
    }
    dir
}

/// The file of walk `k` on the floor in `dir`. Of the first twelve, walks 0, 5 and 11 are test walks of fold 0.
pub fn trace(dir: &Path, k: usize) -> PathBuf {
    dir.join("traces").join(format!("walk-{k:02}.txt"))
}

/// A GeoJSON plan of typed rings, the first of which is the outline.
pub fn plan(rings: &[(&str, String)]) -> String {
    let features: Vec<String> = rings
        .iter()
        .map(|(kind, ring)| {
            format!(
                r#"{{"type": "Feature", "properties": {{"type": "{kind}"}}, "geometry": {{"type": "Polygon", "coordinates": [{ring}]}}}}"#
            )
        })
        .collect();
    format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, features.join(", "))
}

/// A ring given in metres, in degrees at the equator.
fn ring(corners: [[f64; 2]; 4]) -> String {
    let closed = corners.iter().chain(&corners[..1]);
    let points: Vec<String> =
        closed.map(|[x, y]| format!("[{}, {}]", x / 111_320.0, y / 111_320.0)).collect();
    format!("[{}]", points.join(", "))
}

/// Runs the command.
pub fn fieldwalk(arguments: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_fieldwalk")).args(arguments).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!errors.contains("panicked"), "{arguments:?}: {errors}");
    output
}

/// Runs the command, which must succeed, and gives its standard output.
pub fn succeed(arguments: &[&str]) -> String {
    let output = fieldwalk(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Runs the command, which must fail with `code` and say all of `messages` on standard error.
#[track_caller]
pub fn fail(arguments: &[&str], code: i32, messages: &[&str]) {
    let output = fieldwalk(arguments);
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments:?}: {errors}");
    for message in messages {
        assert!(errors.contains(message), "{arguments:?} does not say `{message}`: {errors}");
    }
}

/// The text of a path, for arguments.
pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// One walk round the loop: a flat phone that looks ahead, over a field with a gradient and a wave.
pub fn walk(k: usize) -> String {
    let mut trace =
        Trace { text: "#\tstartTime:1574567556121\n".into(), time_s: 0.0, began_ms: 1_574_567_556_121 };
    trace.began_ms += k as i64 * 1_000_000;
    let turn = if k.is_multiple_of(2) { 1 } else { 3 };
    let corner = |n: usize| CORNERS[(k + n * turn) % 4];
    trace.stand(corner(0), heading(corner(0), corner(1)), 1.0);
    for n in 0..6 {
        let (from, to, next) = (corner(n), corner(n + 1), corner(n + 2));
        trace.waypoint(from);
        trace.walk_line(from, to);
        trace.turn(to, heading(from, to), heading(to, next));
    }
    trace.waypoint(corner(6));
    trace.text
}

struct Trace {
    text: String,
    time_s: f64,
    began_ms: i64,
}

impl Trace {
    fn waypoint(&mut self, [x, y]: [f64; 2]) {
        writeln!(self.text, "{}\tTYPE_WAYPOINT\t{x}\t{y}", self.now_ms()).unwrap();
    }

    fn stand(&mut self, place: [f64; 2], heading_rad: f64, span_s: f64) {
        for _ in 0..(span_s * RATE_HZ) as usize {
            self.tick(place, heading_rad, 0.0, 0.0);
        }
    }

    fn walk_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        let length_m = (to[0] - from[0]).hypot(to[1] - from[1]);
        let span_s = length_m / SPEED_M_S;
        let n = (span_s * RATE_HZ) as usize;
        for k in 0..n {
            let share = k as f64 / n as f64;
            let place = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            let bounce = 2.5 * (TAU * STEPS_PER_S * k as f64 / RATE_HZ).sin();
            self.tick(place, heading(from, to), bounce, 0.0);
        }
    }

    fn turn(&mut self, place: [f64; 2], from_rad: f64, to_rad: f64) {
        let by_rad = (to_rad - from_rad + PI).rem_euclid(TAU) - PI;
        let n = (TURN_S * RATE_HZ) as usize;
        for k in 0..n {
            let heading_rad = from_rad + by_rad * k as f64 / n as f64;
            // Headings are clockwise, rates counter-clockwise.
            self.tick(place, heading_rad, 0.0, -by_rad / TURN_S);
        }
    }

    fn tick(&mut self, place: [f64; 2], heading_rad: f64, bounce: f64, rate_rad_s: f64) {
        let ms = self.now_ms();
        let [x, y] = place;
        let (east, north, up) = (2.0 + 4.0 * (0.9 * x).sin(), 28.0 + 3.0 * (0.7 * y).cos(), -38.0 + 0.3 * x);
        let (sin, cos) = heading_rad.sin_cos();
        let (right, ahead) = (east * cos - north * sin, east * sin + north * cos);
        let lines = [
            format!("TYPE_ACCELEROMETER\t0.01\t0.02\t{:.5}\t3", 9.81 + bounce),
            format!("TYPE_MAGNETIC_FIELD\t{right:.4}\t{ahead:.4}\t{up:.4}\t3"),
            format!("TYPE_GYROSCOPE\t0\t0\t{rate_rad_s:.5}\t3"),
        ];
        for line in lines {
            writeln!(self.text, "{ms}\t{line}").unwrap();
        }
        if ((self.time_s * RATE_HZ).round() as u64).is_multiple_of(25) {
            self.beacons(place);
        }
        self.time_s += 1.0 / RATE_HZ;
    }

    fn beacons(&mut self, [x, y]: [f64; 2]) {
        let ms = self.now_ms();
        for (k, [bx, by]) in BEACONS.iter().enumerate() {
            let rssi = (-50.0 - 20.0 * (bx - x).hypot(by - y).max(1.0).log10()).round();
            writeln!(
                self.text,
                "{ms}\tTYPE_BEACON\tFDA50693-A4E2-4FB1-AFCF-C6EB07647825\t10\t{k}\t-59\t{rssi}\t3.0\t11:22:33:44:55:0{k}\t{ms}"
            )
            .unwrap();
        }
    }

    fn now_ms(&self) -> i64 {
        self.began_ms + (self.time_s * 1e3).round() as i64
    }
}

/// Clockwise from +y, in radians.
fn heading(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).atan2(to[1] - from[1])
}
