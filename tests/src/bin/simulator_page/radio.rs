//! Radio: path loss, spread and gaps, beside a room with fixed receivers and a moving beacon.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use fieldwalk::geometry::Point2;
use fieldwalk::sensor::{Reading, TransmitterId};
use fieldwalk_cli::plot::{Chart, Series, cdf};
use fieldwalk_sim::radio::Transmitter;
use fieldwalk_sim::scenario::{ORIGIN, Scenario, Walk};
use fieldwalk_sim::walker::Pause;
use fieldwalk_tests::recordings::collection;

use crate::page::Page;
use crate::spread::{Spread, mean, sd};

/// Packets between one transmitter and one receiver: seconds, dBm, and metres between them.
#[derive(Default)]
struct Link {
    packets: Vec<(f64, f64, f64)>,
}

/// Real links: those of the tracks, and those at fixed points.
struct Room {
    tracks: Vec<Link>,
    fixed: Vec<Link>,
}

/// The positions of the receivers from `tetam.dev`: `"name": [[x, y, z], colour, "alias"]`.
fn receivers(text: &str) -> BTreeMap<String, [f64; 3]> {
    let mut found = BTreeMap::new();
    for entry in text.split("],").flat_map(|part| part.split('{')) {
        let quoted: Vec<&str> = entry.split('"').collect();
        if let [_, name, rest, ..] = quoted[..] {
            let numbers: Vec<f64> =
                rest.split(['[', ',', ']', ':']).filter_map(|part| part.trim().parse().ok()).collect();
            if let [x, y, z] = numbers[..] {
                found.insert(name.to_owned(), [x, y, z]);
            }
        }
    }
    found
}

fn files(dir: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut found = Vec::new();
    let mut folders = vec![dir.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "mbd") {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

/// `time,receiver,beacon,rssi[,x,y,z,…]`, a packet a line; other lines are left out.
fn read(
    path: &Path,
    places: &BTreeMap<String, [f64; 3]>,
    at: Option<[f64; 3]>,
) -> Result<Link, Box<dyn Error>> {
    let mut link = Link::default();
    for line in fs::read_to_string(path)?.lines() {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |k: usize| fields.get(k).and_then(|field| field.parse::<f64>().ok());
        let Some(receiver) = fields.get(1).and_then(|name| places.get(*name)) else { continue };
        let place = at.or_else(|| Some([number(4)?, number(5)?, number(6)?]));
        if let (Some(time_s), Some(rssi_dbm), Some(place)) = (number(0), number(3), place) {
            let square: f64 = (0..3).map(|c| (place[c] - receiver[c]) * (place[c] - receiver[c])).sum();
            link.packets.push((time_s, rssi_dbm, square.sqrt()));
        }
    }
    Ok(link)
}

fn real() -> Result<Option<Room>, Box<dyn Error>> {
    let Some(folder) = collection("ble-annotated") else { return Ok(None) };
    let places = receivers(&fs::read_to_string(folder.join("cnf/tetam.dev"))?);
    let mut room = Room { tracks: Vec::new(), fixed: Vec::new() };
    for path in files(&folder.join("trk"))? {
        // The merged files repeat those of each receiver.
        if !path.to_string_lossy().contains("all_sensors") {
            room.tracks.push(read(&path, &places, None)?);
        }
    }
    for path in files(&folder.join("hst"))? {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let at: Vec<f64> = stem.split('_').filter_map(|part| part.parse().ok()).collect();
        if let [x, y, z] = at[..] {
            room.fixed.push(read(&path, &places, Some([x, y, z]))?);
        }
    }
    Ok(Some(room))
}

/// The same of simulated phones in a room of that size: walks with stops of half a minute.
fn simulated() -> Room {
    let mut room = Room { tracks: Vec::new(), fixed: Vec::new() };
    for seed in 1..=6 {
        let Some(office) = Scenario::named("card-office", seed) else { continue };
        for walk in office.test_walks(4, 60.0) {
            let stops = [10.0, 22.0, 34.0, 46.0].map(|at_m| Pause { at_m, duration_s: 30.0 });
            let recorded = office.simulate(&Walk { pauses: stops.to_vec(), ..walk });
            let is_standing = |time_s: f64| {
                recorded.steps.windows(2).any(|p| p[0].end_s + 1.0 < time_s && time_s < p[1].start_s - 1.0)
            };
            let mut walked: BTreeMap<TransmitterId, Link> = BTreeMap::new();
            let mut stood: BTreeMap<(TransmitterId, i64), Link> = BTreeMap::new();
            for sample in &recorded.samples {
                let Reading::Radio(sighting) = sample.reading else { continue };
                let is_sender = |t: &&Transmitter| t.id == sighting.transmitter;
                let Some(sender) = office.radio.transmitters.iter().find(is_sender) else { continue };
                let Some(truth) = recorded.truth_at(sample.time) else { continue };
                let flat_m = Point2::new(sender.place_m[0], sender.place_m[1]).distance_m(truth.position);
                let up_m = sender.place_m[2] - 1.1;
                let time_s = sample.time.secs_since(ORIGIN);
                let packet = (time_s, f64::from(sighting.rssi_dbm), (flat_m * flat_m + up_m * up_m).sqrt());
                if is_standing(time_s) {
                    let place = (10.0 * truth.position.x_m).round() as i64 * 10_000
                        + (10.0 * truth.position.y_m).round() as i64;
                    stood.entry((sender.id, place)).or_default().packets.push(packet);
                } else {
                    walked.entry(sender.id).or_default().packets.push(packet);
                }
            }
            room.tracks.extend(walked.into_values());
            room.fixed.extend(stood.into_values());
        }
    }
    room
}

/// Mean power by distance in bins a quarter of an octave wide: metres, dBm, standard deviation in dB.
fn by_distance(links: &[Link]) -> Vec<(f64, f64, f64)> {
    let mut bins: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for (_, rssi_dbm, far_m) in links.iter().flat_map(|link| &link.packets) {
        bins.entry((4.0 * libm::log2(far_m.max(0.5))).round() as i64).or_default().push(*rssi_dbm);
    }
    bins.retain(|_, values| values.len() >= 30);
    let bin = |(k, values): (i64, Vec<f64>)| {
        (libm::exp2(0.25 * k as f64), mean(values.iter().copied()), sd(&values))
    };
    bins.into_iter().map(bin).collect()
}

/// Least squares of power over the logarithm of distance: power at 1 m in dBm, exponent, residual in dB.
fn path_loss(links: &[Link]) -> (f64, f64, f64) {
    let points: Vec<(f64, f64)> = links
        .iter()
        .flat_map(|link| &link.packets)
        .map(|(_, rssi_dbm, far_m)| (10.0 * libm::log10(far_m.max(0.5)), *rssi_dbm))
        .collect();
    let (mx, my) = (mean(points.iter().map(|p| p.0)), mean(points.iter().map(|p| p.1)));
    let (mut xx, mut xy) = (0.0, 0.0);
    for (x, y) in &points {
        xx += (x - mx) * (x - mx);
        xy += (x - mx) * (y - my);
    }
    let slope = xy / xx;
    let rest: Vec<f64> = points.iter().map(|(x, y)| y - my - slope * (x - mx)).collect();
    (my - slope * mx, -slope, sd(&rest))
}

/// Standard deviation of the power of each link that stays as it is, in dB.
fn still_db(links: &[Link]) -> Vec<f64> {
    let of = |link: &Link| sd(&link.packets.iter().map(|packet| packet.1).collect::<Vec<_>>());
    links.iter().filter(|link| link.packets.len() >= 30).map(of).collect()
}

/// Time between packets over its median, link by link.
fn gaps(links: &[Link]) -> Vec<f64> {
    let mut all = Vec::new();
    for link in links.iter().filter(|link| link.packets.len() >= 30) {
        let gaps: Vec<f64> = link.packets.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let middle = Spread::new("", true, gaps.clone()).quantile(0.5);
        all.extend(gaps.into_iter().map(|gap| gap / middle));
    }
    all
}

pub fn write(page: &mut Page) -> Result<(), Box<dyn Error>> {
    page.heading("Radio");
    page.say(
        "Beside the Position-Annotated BLE RSSI Dataset: a beacon moved by hand among twelve fixed receivers in 20.7 × 17.6 m, \
         and left at fixed points. Simulated: phones that walk and stop among the four beacons of `card-office`, \
         20.5 × 16 m, six offices, four people each. What differs by design: the real beacon is held up free of the body, the \
         simulated phone has a body behind it.",
    );
    let made = simulated();
    let real = real()?;
    let mut rows = vec![["", "real", "simulated"].map(String::from).to_vec()];
    let both = |value: &dyn Fn(&Room) -> String| vec![real.as_ref().map_or("–".into(), value), value(&made)];
    let mut row = |name: &str, value: &dyn Fn(&Room) -> String| {
        rows.push([vec![name.to_owned()], both(value)].concat());
    };
    row("path-loss exponent along tracks", &|room| format!("{:.2}", path_loss(&room.tracks).1));
    row("power at 1 m (dBm)", &|room| format!("{:.0}", path_loss(&room.tracks).0));
    row("spread about that law along tracks (dB)", &|room| format!("{:.1}", path_loss(&room.tracks).2));
    row("spread at a fixed place (dB)", &|room| Spread::new("", true, still_db(&room.fixed)).text());
    row("packets after more than 1.5 intervals (%)", &|room| {
        let gaps = gaps(&room.fixed);
        format!("{:.1}", 100.0 * gaps.iter().filter(|gap| **gap > 1.5).count() as f64 / gaps.len() as f64)
    });
    page.table(&rows);
    let mut chart = Chart::new("Mean loss since 1 m by distance", "distance (m)", "loss (dB)");
    let mut spread =
        Chart::new("Spread of the power at one distance", "distance (m)", "standard deviation (dB)");
    for (name, room) in real.iter().map(|room| ("real", room)).chain([("simulated", &made)]) {
        let at_1m_dbm = path_loss(&room.tracks).0;
        let bins = by_distance(&room.tracks);
        chart = chart.with(Series::line(name, bins.iter().map(|bin| (bin.0, at_1m_dbm - bin.1)).collect()));
        spread = spread.with(Series::line(name, bins.iter().map(|bin| (bin.0, bin.2)).collect()));
    }
    page.picture("path-loss", "loss by distance", &chart.to_svg())?;
    page.picture("rssi-spread", "spread of power by distance", &spread.to_svg())?;
    let still: Vec<(&str, Vec<f64>)> = real
        .iter()
        .map(|room| ("real", still_db(&room.fixed)))
        .chain([("simulated", still_db(&made.fixed))])
        .collect();
    let still: Vec<(&str, &[f64])> = still.iter().map(|(name, values)| (*name, values.as_slice())).collect();
    let svg = cdf("Spread of the power while nothing moves", "standard deviation (dB)", &still).to_svg();
    page.picture("rssi-still", "spread of power while nothing moves", &svg)?;
    page.say(
        "The simulated office has walls between its rooms and bodies in the way, which steepens its law; in \
         sight its beacons follow an exponent of 1.7. Real links vary from hardly at all to 6 dB while nothing \
         is seen to move, simulated ones all alike.",
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn receivers_are_read_and_a_law_is_fitted() {
        let text =
            r#"Dongles:{"b8": [[7.00, 7.09, 1.22], 167, "sensor10"], "01": [[7.18, 0.68, 2.30], 16, "s"] }"#;
        let found = receivers(text);
        assert_eq!(found["b8"], [7.00, 7.09, 1.22]);
        assert_eq!(found["01"], [7.18, 0.68, 2.30]);
        // −60 dBm at 1 m, exponent 2: −80 at 10 m.
        let packet = |far_m: f64| (0.0, -60.0 - 20.0 * libm::log10(far_m), far_m);
        let link = Link { packets: [1.0, 2.0, 5.0, 10.0].map(packet).to_vec() };
        let (at_1m_dbm, exponent, rest_db) = path_loss(&[link]);
        assert!((at_1m_dbm + 60.0).abs() < 1e-9 && (exponent - 2.0).abs() < 1e-9 && rest_db < 1e-9);
    }
}
