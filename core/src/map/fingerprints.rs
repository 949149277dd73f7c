//! Radio fingerprints: the mean received power of every transmitter in every cell that a survey came by.

use std::collections::BTreeMap;

use crate::geometry::Point2;

/// The fingerprints of a floor: which transmitters are received how strongly where.
///
/// Entries stand by transmitter, since a match needs those of the few transmitters heard alone.
///
/// # Source
/// Kwak 2018, §5.3.4, after RADAR (Bahl and Padmanabhan 2000).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fingerprints {
    /// Per cell, the mean place of its sightings.
    pub places: Vec<Point2>,
    /// Per transmitter of the map, where its entries begin, and at last their number; empty without fingerprints.
    pub starts: Vec<u32>,
    /// Per entry, the cell; ascending within a transmitter.
    pub cells: Vec<u32>,
    /// Per entry, the mean received power, in dBm.
    pub rssi_dbm: Vec<f32>,
}

impl Fingerprints {
    /// The fingerprints of `sightings`: each a place, a transmitter's index below `n_transmitters`, and a power in dBm.
    ///
    /// Cells are squares of `cell_m` from the floor's origin. Powers are averaged in dBm, as RADAR does. Sightings of
    /// unknown transmitters, at places more than 10⁶ cells away or with numbers that are not finite are left out.
    pub fn of(
        cell_m: f64,
        n_transmitters: usize,
        sightings: impl IntoIterator<Item = (Point2, u32, f64)>,
    ) -> Self {
        let mut cells: BTreeMap<(i32, i32), Mean<Point2>> = BTreeMap::new();
        let mut powers: BTreeMap<(u32, (i32, i32)), Mean<f64>> = BTreeMap::new();
        for (place, transmitter, rssi_dbm) in sightings {
            let at = |m: f64| Some((m / cell_m).floor()).filter(|k| k.abs() <= 1e6).map(|k| k as i32);
            let Some(cell) = at(place.y_m).zip(at(place.x_m)) else { continue };
            if rssi_dbm.is_finite() && (transmitter as usize) < n_transmitters {
                cells.entry(cell).or_default().add(place);
                powers.entry((transmitter, cell)).or_default().add(rssi_dbm);
            }
        }
        if cells.is_empty() {
            return Self::default();
        }
        let indices: BTreeMap<(i32, i32), u32> = cells.keys().copied().zip(0..).collect();
        let mut starts = vec![0; n_transmitters + 1];
        for (transmitter, _) in powers.keys() {
            starts[*transmitter as usize + 1] += 1;
        }
        for transmitter in 0..n_transmitters {
            starts[transmitter + 1] += starts[transmitter];
        }
        Self {
            places: cells.values().map(|mean| mean.sum * (1.0 / f64::from(mean.n))).collect(),
            starts,
            cells: powers.keys().map(|(_, cell)| indices[cell]).collect(),
            rssi_dbm: powers.values().map(|mean| (mean.sum / f64::from(mean.n)) as f32).collect(),
        }
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.places.len()
    }

    /// Whether there are no fingerprints.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The cells that received `transmitter`, with the mean power in dBm; none for one that is unknown.
    pub fn of_transmitter(&self, transmitter: u32) -> impl Iterator<Item = (usize, f32)> {
        let bounds = self.starts.get(transmitter as usize..).and_then(|starts| starts.first_chunk());
        let range = bounds.map_or(0..0, |&[start, end]| start as usize..end as usize);
        let cells = self.cells.get(range.clone()).unwrap_or_default().iter();
        cells.map(|&cell| cell as usize).zip(self.rssi_dbm.get(range).unwrap_or_default().iter().copied())
    }

    /// Whether the arrays fit together and `n_transmitters`, and every number is finite: a file's may not.
    pub fn is_sound(&self, n_transmitters: usize) -> bool {
        let Self { places, starts, cells, rssi_dbm } = self;
        if places.is_empty() {
            return starts.is_empty() && cells.is_empty() && rssi_dbm.is_empty();
        }
        starts.len() == n_transmitters + 1
            && starts.first() == Some(&0)
            && starts.last().is_some_and(|&end| end as usize == cells.len())
            && starts.is_sorted()
            && cells.len() == rssi_dbm.len()
            && cells.iter().all(|&cell| (cell as usize) < places.len())
            && places.iter().all(|place| place.is_finite())
            && rssi_dbm.iter().all(|rssi_dbm| rssi_dbm.is_finite())
    }
}

/// A mean in the making.
#[derive(Clone, Copy, Debug, Default)]
struct Mean<T> {
    sum: T,
    n: u32,
}

impl<T: core::ops::Add<Output = T> + Copy> Mean<T> {
    fn add(&mut self, value: T) {
        self.sum = self.sum + value;
        self.n += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, y_m: f64) -> Point2 {
        Point2::new(x_m, y_m)
    }

    #[test]
    fn cells_hold_means_by_hand() {
        let fingerprints = Fingerprints::of(
            2.0,
            3,
            [
                (at(0.5, 0.5), 0, -60.0),
                (at(1.5, 0.5), 0, -64.0),
                (at(1.0, 1.1), 2, -80.0),
                (at(3.0, 1.0), 2, -70.0),
                (at(-0.5, 1.0), 2, -90.0),
                // Left out: an unknown transmitter, a place and a power that are none.
                (at(9.0, 9.0), 3, -50.0),
                (at(f64::NAN, 1.0), 0, -50.0),
                (at(1.0, 1e9), 0, -50.0),
                (at(1.0, 1.0), 0, f64::NEG_INFINITY),
            ],
        );
        // By rows, from the left: x in [−2, 0), [0, 2), [2, 4).
        let places = &fingerprints.places;
        assert_eq!((places.len(), places[0], places[2]), (3, at(-0.5, 1.0), at(3.0, 1.0)));
        assert!(places[1].distance_m(at(1.0, 0.7)) < 1e-12);
        let of = |transmitter| fingerprints.of_transmitter(transmitter).collect::<Vec<_>>();
        assert_eq!(of(0), [(1, -62.0)]);
        assert_eq!(of(1), []);
        assert_eq!(of(2), [(0, -90.0), (1, -80.0), (2, -70.0)]);
        assert_eq!(of(3), []);
        assert_eq!(of(u32::MAX), []);
        assert!(fingerprints.is_sound(3) && !fingerprints.is_sound(2));
    }

    #[test]
    fn nothing_heard_gives_none_and_a_senseless_cell_too() {
        assert_eq!(Fingerprints::of(2.0, 4, []), Fingerprints::default());
        for cell_m in [0.0, f64::NAN] {
            assert!(Fingerprints::of(cell_m, 1, [(at(1.0, 1.0), 0, -60.0)]).is_empty());
        }
        assert!(Fingerprints::default().is_sound(4));
    }

    #[test]
    fn arrays_that_do_not_fit_are_seen() {
        let sound = Fingerprints::of(1.0, 2, [(at(0.5, 0.5), 0, -60.0), (at(1.5, 0.5), 1, -70.0)]);
        let breaks: [fn(&mut Fingerprints); 7] = [
            |f| f.starts = vec![0, 2, 1],
            |f| f.starts = vec![1, 1, 2],
            |f| f.starts.clear(),
            |f| f.cells[0] = 2,
            |f| f.rssi_dbm[1] = f32::NAN,
            |f| f.places[0].x_m = f64::INFINITY,
            |f| f.places.clear(),
        ];
        assert!(sound.is_sound(2));
        for (k, break_it) in breaks.iter().enumerate() {
            let mut broken = sound.clone();
            break_it(&mut broken);
            assert!(!broken.is_sound(2), "{k}");
        }
    }
}
