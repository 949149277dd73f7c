// What the report holds, unpacked when it is needed.

const report = JSON.parse(document.getElementById("figures").textContent);

const NO_LENGTH = 65535;
const DASHES = [[], [9, 4], [2, 4], [10, 3, 2, 3], [5, 3], [1, 3]];
const N_COLOURS = 6;
const SYSTEMS = report.systems.map((name, index) => {
  // The last system is the one that the report is about: it has the first colour.
  const place = report.systems.length - 1 - index;
  const slot = place % N_COLOURS;
  // From the seventh on the colours come again, each with other dashes.
  return { name, index, slot, dash: DASHES[(slot + Math.floor(place / N_COLOURS)) % DASHES.length] };
});

/** The numbers of a packed array; every machine that runs a browser is little-endian. */
function unpack(text, Type) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) bytes[i] = raw.charCodeAt(i);
  return new Type(bytes.buffer);
}

const scaled = (numbers, unit) => Float64Array.from(numbers, (n) => n * unit);
const seconds = (text) => scaled(unpack(text, Uint32Array), 0.001);
const metres = (text) => scaled(unpack(text, Int32Array), 0.01);
const lengths = (text) =>
  Float64Array.from(unpack(text, Uint16Array), (n) => (n === NO_LENGTH ? NaN : n * 0.01));

function unpackTrack(track) {
  return {
    time: seconds(track.time),
    place: metres(track.place),
    heading: scaled(unpack(track.heading, Uint8Array), Math.PI / 128),
    radius68: lengths(track.radius_68),
    radius95: lengths(track.radius_95),
    error: lengths(track.error),
    cloudTime: seconds(track.cloud_time),
    cloudPlace: metres(track.cloud_place),
    cloudUnit: scaled(unpack(track.cloud_unit, Uint16Array), 0.001),
    nParticles: track.n_particles,
    particles: unpack(track.particles, Uint8Array),
    scoredTime: seconds(track.scored_time),
    scoredError: lengths(track.scored_error),
  };
}

const unpacked = new Map();

/** Walk number `index`, ready to be drawn. */
function openWalk(index) {
  if (!unpacked.has(index)) {
    const walk = report.walks[index];
    unpacked.set(index, {
      ...walk,
      truth: {
        kind: walk.truth.kind,
        time: seconds(walk.truth.time),
        place: metres(walk.truth.place),
        markTime: seconds(walk.truth.mark_time),
        markPlace: metres(walk.truth.mark_place),
      },
      tracks: walk.tracks.map(unpackTrack),
    });
  }
  return unpacked.get(index);
}

/** Index of the last of the rising `times` that is not after `t`; −1 before the first. */
function lastBefore(times, t) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Where a line of places is at time `t`; null outside its time. */
function placeAt(line, t) {
  const k = lastBefore(line.time, t);
  if (k < 0 || (k === line.time.length - 1 && t > line.time[k] + 0.05)) return null;
  const next = Math.min(k + 1, line.time.length - 1);
  const span = line.time[next] - line.time[k];
  const share = span > 0 ? (t - line.time[k]) / span : 0;
  const at = (c) => line.place[2 * k + c] + share * (line.place[2 * next + c] - line.place[2 * k + c]);
  return { x: at(0), y: at(1), k, share };
}

/** A system's fix at time `t`, smoothly between the fixes that it gave; null before the first. */
function fixAt(track, t) {
  const last = track.time.length - 1;
  if (last < 0) return null;
  const at = placeAt(track, Math.min(t, track.time[last]));
  if (!at) return null;
  const next = Math.min(at.k + 1, last);
  const between = (values) => values[at.k] + at.share * (values[next] - values[at.k]);
  const turn = Math.atan2(
    Math.sin(track.heading[next] - track.heading[at.k]),
    Math.cos(track.heading[next] - track.heading[at.k]),
  );
  return {
    x: at.x,
    y: at.y,
    heading: track.heading[at.k] + at.share * turn,
    radius68: between(track.radius68),
    radius95: between(track.radius95),
    error: between(track.error),
  };
}

/** The particles of the cloud at time `t`, as x and y in turn; null before the first. */
function cloudAt(track, t) {
  const k = lastBefore(track.cloudTime, t);
  if (k < 0 || track.nParticles === 0) return null;
  const places = new Float64Array(2 * track.nParticles);
  const from = 2 * track.nParticles * k;
  for (let i = 0; i < places.length; i++) {
    places[i] = track.cloudPlace[2 * k + (i & 1)] + track.cloudUnit[k] * (track.particles[from + i] - 128);
  }
  return places;
}

const layerBytes = new Map();

/** A layer's bytes. */
function openLayer(layer) {
  if (!layerBytes.has(layer)) layerBytes.set(layer, unpack(layer.values, Uint8Array));
  return layerBytes.get(layer);
}

/** A layer's value at a place; null where it has none. */
function layerAt(layer, x, y) {
  const i = Math.round((x - layer.x_m) / layer.cell_m);
  const j = Math.round((y - layer.y_m) / layer.cell_m);
  if (i < 0 || j < 0 || i >= layer.nx || j >= layer.ny) return null;
  const byte = openLayer(layer)[j * layer.nx + i];
  return byte === 255 ? null : layer.low + (byte / 254) * (layer.high - layer.low);
}

/** `value` with as many digits as `unit` deserves. */
function say(value, unit, digits = 2) {
  return Number.isFinite(value) ? `${value.toFixed(digits)} ${unit}` : "–";
}
