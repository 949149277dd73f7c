//! One floor as a safetensors file.

use std::collections::HashMap;

use fieldwalk::geometry::Point2;
use fieldwalk::map::{Fingerprints, FloorMap, GridFrame, Layers, Transmitter};
use safetensors::SafeTensors;

use super::check::{check_floor, check_frame};
use super::metadata::{FLOOR_FORMAT, FloorMetadata, NO_DIGEST};
use super::tensors::{Tensor, Tensors, unfit};
use super::{MAP_VERSION, disk};
use crate::error::FormatError;
use crate::transmitter_id;

/// The file's one metadata key.
const METADATA_KEY: &str = "fieldwalk";

/// The digest's place in the header: JSON text within JSON text.
const DIGEST_KEY: &[u8] = br#"\"sha256\":\""#;

const ROUTE_POINTS: &str = "route_points_m";
const ROUTE_STARTS: &str = "route_starts";
const RADIO_POSITION: &str = "radio_position_m";
const RADIO_POWER: &str = "radio_power_at_1m_dbm";
const RADIO_EXPONENT: &str = "radio_path_loss_exponent";
const RADIO_SIGMA: &str = "radio_sigma_db";
const RADIO_SIGHTINGS: &str = "radio_sightings";
const FINGERPRINT_PLACES: &str = "fingerprint_places_m";
const FINGERPRINT_STARTS: &str = "fingerprint_starts";
const FINGERPRINT_CELLS: &str = "fingerprint_cells";
const FINGERPRINT_RSSI: &str = "fingerprint_rssi_dbm";

/// A floor's file, parsed but not yet checked.
#[derive(Debug)]
pub(super) struct FloorFile<'a> {
    file: &'a [u8],
    header_end: usize,
    metadata: FloorMetadata,
    tensors: Tensors<'a>,
}

/// The bytes of a floor's file: the same bytes for the same floor, everywhere.
///
/// Layers are rounded to half floats (11 significant bits: 0.03 µT at 50 µT), with finite values clamped to ±65504;
/// routes, transmitters and fingerprints are rounded to single floats.
///
/// # Errors
/// When a layer does not fit the grid, or when a number outside the layers is not finite.
pub fn encode_floor(floor: &FloorMap) -> Result<Vec<u8>, FormatError> {
    check_floor(floor)?;
    let metadata = FloorMetadata {
        format: FLOOR_FORMAT.to_owned(),
        frame: floor.frame,
        name: floor.name.clone(),
        ordinal: floor.ordinal,
        plan: floor.plan.clone(),
        sha256: NO_DIGEST.map(char::from).iter().collect(),
        transmitters: transmitter_names(&floor.transmitters)?,
        version: MAP_VERSION,
    };
    let tensors = tensors_of(floor);
    let views = tensors
        .iter()
        .map(|tensor| Ok((tensor.name(), tensor.view()?)))
        .collect::<Result<Vec<_>, FormatError>>()?;
    let metadata = HashMap::from([(METADATA_KEY.to_owned(), metadata.to_json()?)]);
    let mut bytes =
        safetensors::serialize(views, Some(metadata)).map_err(|error| unfit(error.to_string()))?;

    let digest = disk::sha256_hex(&[&bytes]);
    let header_end = bytes.len() - tensors.iter().map(Tensor::n_bytes).sum::<usize>();
    let at = digest_position(&bytes[..header_end]).ok_or_else(no_digest)?;
    bytes[at..at + NO_DIGEST.len()].copy_from_slice(digest.as_bytes());
    Ok(bytes)
}

impl<'a> FloorFile<'a> {
    /// Parses the header.
    pub(super) fn parse(file: &'a [u8]) -> Result<Self, FormatError> {
        let (n_header, metadata) = SafeTensors::read_metadata(file).map_err(|error| {
            FormatError::malformed(format!("not a floor map: {error}"), "give a map that Fieldwalk exported")
        })?;
        let header_end = size_of::<u64>() + n_header;
        let bytes = file.get(header_end..).unwrap_or_default();
        let text = metadata.metadata().as_ref().and_then(|entries| entries.get(METADATA_KEY));
        let text = text.ok_or_else(|| {
            FormatError::malformed(
                "not a floor map: a safetensors file without `fieldwalk` metadata",
                "give a map that Fieldwalk exported",
            )
        })?;
        let floor_metadata = FloorMetadata::from_json(text)?;
        Ok(Self { file, header_end, metadata: floor_metadata, tensors: Tensors { metadata, bytes } })
    }

    /// Checks that no byte of the file has changed since it was written.
    pub(super) fn check_digest(&self) -> Result<(), FormatError> {
        let at = digest_position(&self.file[..self.header_end]).ok_or_else(no_digest)?;
        let (before, rest) = self.file.split_at(at);
        let (found, after) = rest.split_at(NO_DIGEST.len());
        // No mutation of a fuzzer would ever get past a digest.
        if cfg!(fuzzing) || disk::sha256_hex(&[before, &NO_DIGEST, after]).as_bytes() == found {
            return Ok(());
        }
        Err(FormatError::corrupt(
            "the map has changed since it was written: its SHA-256 does not match",
            "copy the file again, or export the map anew",
        ))
    }

    /// The floor; everything is checked but the digest.
    pub(super) fn to_map(&self) -> Result<FloorMap, FormatError> {
        let FloorMetadata { frame, name, ordinal, plan, transmitters, .. } = &self.metadata;
        check_frame(frame)?;
        let floor = FloorMap {
            name: name.clone(),
            ordinal: *ordinal,
            plan: plan.clone(),
            frame: *frame,
            layers: self.layers(frame)?,
            routes: self.routes()?,
            transmitters: self.transmitters(transmitters)?,
            fingerprints: self.fingerprints()?,
        };
        check_floor(&floor)?;
        Ok(floor)
    }

    /// The layers; one that an older build did not know was not surveyed.
    fn layers(&self, frame: &GridFrame) -> Result<Layers, FormatError> {
        let mut layers = Layers::default();
        let mut missing = Vec::new();
        let names = Layers::default().named().map(|(name, _)| name);
        for name in names {
            match (self.tensors.f16(name, &[frame.ny, frame.nx])?, layers.named_mut(name)) {
                (Some(values), Some(layer)) => *layer = values,
                _ => missing.push(name),
            }
        }
        if missing.len() == names.len() && !frame.is_empty() {
            // Filling them would let a small file ask for any amount of memory.
            return Err(unfit("no layer at all".to_owned()));
        }
        for name in missing {
            if let Some(layer) = layers.named_mut(name) {
                *layer = vec![f32::NAN; frame.len()];
            }
        }
        Ok(layers)
    }

    fn routes(&self) -> Result<Vec<Vec<Point2>>, FormatError> {
        let points = points(&self.tensors.f32(ROUTE_POINTS, 2)?);
        let starts: Vec<usize> =
            self.tensors.u32(ROUTE_STARTS)?.into_iter().map(|start| start as usize).collect();
        let ends = starts.iter().copied().skip(1).chain([points.len()]);
        if starts.first().map_or(!points.is_empty(), |&first| first != 0) {
            return Err(unfit("the routes do not begin at their first point".to_owned()));
        }
        let route = |(start, end): (usize, usize)| {
            let route = points.get(start..end).map(<[Point2]>::to_vec);
            route.ok_or_else(|| unfit(format!("a route from point {start} to {end}")))
        };
        starts.iter().copied().zip(ends).map(route).collect()
    }

    fn transmitters(&self, names: &[String]) -> Result<Vec<Transmitter>, FormatError> {
        let positions = points(&self.tensors.f32(RADIO_POSITION, 2)?);
        let powers = self.tensors.f32(RADIO_POWER, 1)?;
        let exponents = self.tensors.f32(RADIO_EXPONENT, 1)?;
        let sigmas = self.tensors.f32(RADIO_SIGMA, 1)?;
        let sightings = self.tensors.u32(RADIO_SIGHTINGS)?;
        let lengths = [positions.len(), powers.len(), exponents.len(), sigmas.len(), sightings.len()];
        if lengths.iter().any(|&length| length != names.len()) {
            return Err(unfit(format!("{} transmitters in tables of {lengths:?} rows", names.len())));
        }
        let transmitter = |(row, name): (usize, &String)| {
            let id = transmitter_id::from_text(name)
                .ok_or_else(|| unfit(format!("transmitter `{name}` is of an unknown kind")))?;
            Ok(Transmitter {
                id,
                position: positions[row],
                power_at_1m_dbm: powers[row],
                path_loss_exponent: exponents[row],
                sigma_db: sigmas[row],
                n_sightings: sightings[row],
            })
        };
        names.iter().enumerate().map(transmitter).collect()
    }

    /// The fingerprints; none in the file of a floor without radio, or of an older build.
    fn fingerprints(&self) -> Result<Fingerprints, FormatError> {
        if self.tensors.metadata.info(FINGERPRINT_PLACES).is_none() {
            return Ok(Fingerprints::default());
        }
        let rssi_dbm = self.tensors.f32(FINGERPRINT_RSSI, 1)?;
        Ok(Fingerprints {
            places: points(&self.tensors.f32(FINGERPRINT_PLACES, 2)?),
            starts: self.tensors.u32(FINGERPRINT_STARTS)?,
            cells: self.tensors.u32(FINGERPRINT_CELLS)?,
            rssi_dbm: rssi_dbm.into_iter().map(|rssi_dbm| rssi_dbm as f32).collect(),
        })
    }
}

fn tensors_of(floor: &FloorMap) -> Vec<Tensor> {
    let FloorMap { frame, layers, routes, transmitters, fingerprints, .. } = floor;
    let layer_shape = || vec![frame.ny, frame.nx];
    let layers = layers.named().map(|(name, layer)| Tensor::f16(name, layer_shape(), layer));

    let coordinates = |point: &Point2| [point.x_m, point.y_m];
    let n_points = routes.iter().map(Vec::len).sum();
    let starts = routes.iter().scan(0_u32, |next, route| {
        let start = *next;
        *next += route.len() as u32;
        Some(start)
    });
    let column = |name, value: fn(&Transmitter) -> f64| {
        Tensor::f32(name, vec![transmitters.len()], transmitters.iter().map(value))
    };
    let positions = transmitters.iter().flat_map(|transmitter| coordinates(&transmitter.position));
    layers
        .into_iter()
        .chain([
            Tensor::f32(ROUTE_POINTS, vec![n_points, 2], routes.iter().flatten().flat_map(coordinates)),
            Tensor::u32(ROUTE_STARTS, starts),
            Tensor::f32(RADIO_POSITION, vec![transmitters.len(), 2], positions),
            column(RADIO_POWER, |transmitter| transmitter.power_at_1m_dbm),
            column(RADIO_EXPONENT, |transmitter| transmitter.path_loss_exponent),
            column(RADIO_SIGMA, |transmitter| transmitter.sigma_db),
            Tensor::u32(RADIO_SIGHTINGS, transmitters.iter().map(|transmitter| transmitter.n_sightings)),
        ])
        .chain(fingerprint_tensors(fingerprints))
        .collect()
}

/// Nothing where there are none: such a floor's file has the bytes that it had before there were fingerprints.
fn fingerprint_tensors(fingerprints: &Fingerprints) -> Vec<Tensor> {
    let Fingerprints { places, starts, cells, rssi_dbm } = fingerprints;
    if places.is_empty() {
        return Vec::new();
    }
    let coordinates = places.iter().flat_map(|place| [place.x_m, place.y_m]);
    vec![
        Tensor::f32(FINGERPRINT_PLACES, vec![places.len(), 2], coordinates),
        Tensor::u32(FINGERPRINT_STARTS, starts.iter().copied()),
        Tensor::u32(FINGERPRINT_CELLS, cells.iter().copied()),
        Tensor::f32(FINGERPRINT_RSSI, vec![rssi_dbm.len()], rssi_dbm.iter().map(|&dbm| f64::from(dbm))),
    ]
}

fn transmitter_names(transmitters: &[Transmitter]) -> Result<Vec<String>, FormatError> {
    let name = |transmitter: &Transmitter| {
        transmitter_id::to_text(&transmitter.id)
            .ok_or_else(|| unfit(format!("no spelling for transmitter {:?}", transmitter.id)))
    };
    transmitters.iter().map(name).collect()
}

fn points(coordinates: &[f64]) -> Vec<Point2> {
    let (pairs, _) = coordinates.as_chunks();
    pairs.iter().map(|&[x_m, y_m]| Point2::new(x_m, y_m)).collect()
}

/// Where the digest's 64 digits begin in a file's header.
fn digest_position(header: &[u8]) -> Option<usize> {
    let key = header.windows(DIGEST_KEY.len()).position(|window| window == DIGEST_KEY)?;
    let at = key + DIGEST_KEY.len();
    (at + NO_DIGEST.len() <= header.len()).then_some(at)
}

fn no_digest() -> FormatError {
    FormatError::malformed(
        "not a floor map: no SHA-256 in its metadata",
        "give a map that Fieldwalk exported",
    )
}
