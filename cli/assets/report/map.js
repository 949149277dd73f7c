// The map: plan, layer, truth, fixes, radii and particles, as the view shows them.

const mapCanvas = document.getElementById("map");
/** Screen = (place − centre) · scale + middle of the canvas, y up. */
const view = { x: 0, y: 0, scale: 1, fittedTo: null };
/** Plan and layer change seldom: they are drawn once for each view. */
const ground = { canvas: document.createElement("canvas"), key: "" };
const heatImages = new Map();

/** Shows the box from (low x, low y) to (high x, high y). */
function fitView(extent) {
  const margin = 14;
  const width = Math.max(mapCanvas.clientWidth - 2 * margin, 40);
  const height = Math.max(mapCanvas.clientHeight - 2 * margin, 40);
  const [left, bottom, right, top] = extent;
  view.scale = Math.min(width / Math.max(right - left, 1), height / Math.max(top - bottom, 1));
  view.x = (left + right) / 2;
  view.y = (bottom + top) / 2;
  view.fittedTo = extent;
}

const floorExtent = (floor) => [0, 0, floor.width_m, floor.height_m];

/** A walk with its surroundings, not less than 30 m; the whole floor when that is hardly more. */
function walkExtent(walk, floor) {
  const lines = [walk.truth.place, walk.truth.markPlace, ...walk.tracks.map((track) => track.place)];
  const extent = [Infinity, Infinity, -Infinity, -Infinity];
  for (const line of lines) {
    for (let k = 0; k < line.length; k++) {
      extent[k % 2] = Math.min(extent[k % 2], line[k]);
      extent[2 + (k % 2)] = Math.max(extent[2 + (k % 2)], line[k]);
    }
  }
  if (!Number.isFinite(extent[0])) return floorExtent(floor);
  for (const axis of [0, 1]) {
    const aside = Math.max(6, (30 - (extent[2 + axis] - extent[axis])) / 2);
    extent[axis] -= aside;
    extent[2 + axis] += aside;
  }
  const isMost = extent[2] - extent[0] > 0.7 * floor.width_m || extent[3] - extent[1] > 0.7 * floor.height_m;
  return isMost ? floorExtent(floor) : extent;
}

const toScreen = (x, y) => [
  (x - view.x) * view.scale + mapCanvas.clientWidth / 2,
  (view.y - y) * view.scale + mapCanvas.clientHeight / 2,
];

const toPlace = (left, top) => [
  (left - mapCanvas.clientWidth / 2) / view.scale + view.x,
  view.y - (top - mapCanvas.clientHeight / 2) / view.scale,
];

/** Zooms by `factor`, keeping what is under (left, top). */
function zoomAt(factor, left, top) {
  const [x, y] = toPlace(left, top);
  view.scale = Math.max(0.5, Math.min(400, view.scale * factor));
  view.x = x - (left - mapCanvas.clientWidth / 2) / view.scale;
  view.y = y + (top - mapCanvas.clientHeight / 2) / view.scale;
  view.fittedTo = null;
}

function moveView(left, top) {
  view.x -= left / view.scale;
  view.y += top / view.scale;
  view.fittedTo = null;
}

/** A layer as an image of one pixel a node. */
function heatImage(layer) {
  if (heatImages.has(layer)) return heatImages.get(layer);
  const canvas = document.createElement("canvas");
  canvas.width = layer.nx;
  canvas.height = layer.ny;
  const context = canvas.getContext("2d");
  const image = context.createImageData(layer.nx, layer.ny);
  const bytes = openLayer(layer);
  const colours = Array.from({ length: 255 }, (_, byte) => scaleColour(scaleOf(layer), byte / 254));
  for (let j = 0; j < layer.ny; j++) {
    for (let i = 0; i < layer.nx; i++) {
      const byte = bytes[j * layer.nx + i];
      if (byte === 255) continue;
      const at = 4 * ((layer.ny - 1 - j) * layer.nx + i);
      image.data.set(colours[byte], at);
      image.data[at + 3] = 255;
    }
  }
  context.putImageData(image, 0, 0);
  heatImages.set(layer, canvas);
  return canvas;
}

function traceRing(context, ring, isClosed) {
  for (let k = 0; k + 1 < ring.length; k += 2) {
    const [left, top] = toScreen(ring[k] / 100, ring[k + 1] / 100);
    if (k === 0) context.moveTo(left, top);
    else context.lineTo(left, top);
  }
  if (isClosed) context.closePath();
}

function drawPlan(context, floor, layer) {
  context.beginPath();
  const outline = floor.outline.length ? floor.outline : [[box(floor)]];
  for (const rings of outline) for (const ring of rings) traceRing(context, ring, true);
  context.fillStyle = theme.corridor;
  context.fill("evenodd");
  for (const isWalkable of [false, true]) {
    context.beginPath();
    for (const unit of floor.units) {
      if (unit.walkable === isWalkable) for (const ring of unit.rings) traceRing(context, ring, true);
    }
    context.fillStyle = isWalkable ? theme.corridor : theme.room;
    context.fill("evenodd");
  }
  if (layer) drawHeat(context, layer, outline);
  context.strokeStyle = theme.wall;
  context.lineJoin = "round";
  context.lineWidth = Math.max(0.6, Math.min(1.4, view.scale / 12));
  context.beginPath();
  for (const unit of floor.units) {
    if (!unit.walkable) for (const ring of unit.rings) traceRing(context, ring, true);
  }
  for (const wall of floor.walls) traceRing(context, wall, false);
  context.stroke();
  context.lineWidth *= 1.6;
  context.beginPath();
  for (const rings of outline) for (const ring of rings) traceRing(context, ring, true);
  context.stroke();
}

const box = (floor) => {
  const [right, top] = [100 * floor.width_m, 100 * floor.height_m];
  return [0, 0, right, 0, right, top, 0, top];
};

function drawHeat(context, layer, outline) {
  const half = layer.cell_m / 2;
  const [left, top] = toScreen(layer.x_m - half, layer.y_m + layer.ny * layer.cell_m - half);
  context.save();
  context.beginPath();
  for (const rings of outline) for (const ring of rings) traceRing(context, ring, true);
  context.clip("evenodd");
  context.globalAlpha = theme.heat;
  context.imageSmoothingEnabled = true;
  context.imageSmoothingQuality = "high";
  const cell = layer.cell_m * view.scale;
  context.drawImage(heatImage(layer), left, top, layer.nx * cell, layer.ny * cell);
  context.restore();
}

/** Names of rooms that are wide enough on the screen. */
function drawNames(context, floor) {
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  for (const unit of floor.units) {
    if (!unit.name || unit.walkable || !unit.rings.length) continue;
    const [xs, ys] = [0, 1].map((c) => unit.rings[0].filter((_, k) => k % 2 === c));
    const [low, high] = [Math.min(...xs) / 100, Math.max(...xs) / 100];
    const [bottom, top] = [Math.min(...ys) / 100, Math.max(...ys) / 100];
    const name = unit.name.length > 24 ? `${unit.name.slice(0, 23)}…` : unit.name;
    const room = (high - low) * view.scale;
    if (room < 52 || (top - bottom) * view.scale < 16 || context.measureText(name).width > room - 6) continue;
    const [at, height] = toScreen((low + high) / 2, (bottom + top) / 2);
    context.strokeStyle = theme.raised;
    context.lineWidth = 3;
    context.globalAlpha = 0.7;
    context.strokeText(name, at, height);
    context.globalAlpha = 1;
    context.fillStyle = theme.soft;
    context.fillText(name, at, height);
  }
}

function drawGround(floor, layer, fit, state) {
  const { width, height, ratio } = fit;
  const key = [report.floors.indexOf(floor), layer?.name, width, height, ratio, view.x, view.y, view.scale,
    state.shows.routes, theme.paper].join();
  if (ground.key === key) return;
  ground.key = key;
  ground.canvas.width = Math.round(width * ratio);
  ground.canvas.height = Math.round(height * ratio);
  const context = ground.canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  drawPlan(context, floor, layer);
  if (state.shows.routes) {
    context.beginPath();
    for (const route of floor.routes) traceRing(context, route, false);
    context.strokeStyle = theme.soft;
    context.globalAlpha = 0.55;
    context.lineWidth = 1;
    context.stroke();
    context.globalAlpha = 1;
  }
  drawNames(context, floor);
}

/** The part of a line of places between two times, as a path. */
function traceLine(context, line, from, to) {
  let isOpen = false;
  const start = Math.max(lastBefore(line.time, from), 0);
  for (let k = start; k < line.time.length && line.time[k] <= to; k++) {
    const [left, top] = toScreen(line.place[2 * k], line.place[2 * k + 1]);
    if (isOpen) context.lineTo(left, top);
    else context.moveTo(left, top);
    isOpen = true;
  }
  const end = placeAt(line, to);
  if (isOpen && end) context.lineTo(...toScreen(end.x, end.y));
}

function strokeWithHalo(context, colour, width, alpha, dash) {
  context.lineCap = "round";
  context.lineJoin = "round";
  context.setLineDash([]);
  context.globalAlpha = 0.75 * alpha;
  context.strokeStyle = theme.raised;
  context.lineWidth = width + 2.4;
  context.stroke();
  context.globalAlpha = alpha;
  context.setLineDash(dash);
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke();
  context.setLineDash([]);
  context.globalAlpha = 1;
}

function drawLine(context, line, colour, time, isWhole, dash) {
  if (isWhole) {
    context.beginPath();
    traceLine(context, line, -1, Infinity);
    context.globalAlpha = 0.5;
    context.strokeStyle = colour;
    context.lineWidth = 1.3;
    context.setLineDash(dash);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }
  context.beginPath();
  traceLine(context, line, -1, time);
  strokeWithHalo(context, colour, 2.4, 1, dash);
}

function drawCircle(context, fix, radius, colour, dash, fill) {
  context.beginPath();
  const [left, top] = toScreen(fix.x, fix.y);
  context.arc(left, top, Math.max(radius * view.scale, 1), 0, 2 * Math.PI);
  if (fill) {
    context.globalAlpha = 0.16;
    context.fillStyle = colour;
    context.fill();
  }
  strokeWithHalo(context, colour, 1.4, 0.9, dash);
}

/** A dot that points where the system says that the walker goes. */
function drawMarker(context, fix, colour) {
  const [left, top] = toScreen(fix.x, fix.y);
  context.save();
  context.translate(left, top);
  context.rotate(fix.heading);
  context.beginPath();
  context.moveTo(0, -13);
  context.lineTo(6.4, -3);
  context.arc(0, 0, 7, -0.44, Math.PI + 0.44);
  context.closePath();
  context.fillStyle = colour;
  context.strokeStyle = theme.raised;
  context.lineWidth = 2;
  context.fill();
  context.stroke();
  context.restore();
}

function drawTruth(context, walk, state) {
  const { truth } = walk;
  drawLine(context, truth, theme.ink, state.time, state.shows.whole, truth.kind === "waypoints" ? [6, 4] : []);
  for (let k = 0; k < truth.markTime.length; k++) {
    const [left, top] = toScreen(truth.markPlace[2 * k], truth.markPlace[2 * k + 1]);
    const reach = truth.markTime[k] <= state.time ? 5 : 4;
    context.beginPath();
    context.moveTo(left, top - reach);
    context.lineTo(left + reach, top);
    context.lineTo(left, top + reach);
    context.lineTo(left - reach, top);
    context.closePath();
    context.fillStyle = truth.markTime[k] <= state.time ? theme.ink : theme.raised;
    context.strokeStyle = truth.markTime[k] <= state.time ? theme.raised : theme.ink;
    context.lineWidth = 1.5;
    context.fill();
    context.stroke();
  }
  const at = placeAt(truth, state.time);
  if (!at) return;
  context.beginPath();
  context.arc(...toScreen(at.x, at.y), 6, 0, 2 * Math.PI);
  context.fillStyle = theme.ink;
  context.strokeStyle = theme.raised;
  context.lineWidth = 2.5;
  context.fill();
  context.stroke();
}

/** A bar that says how long so many metres are. */
function drawScale(context, height) {
  const wanted = 90 / view.scale;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  const length = [5, 2, 1].map((n) => n * decade).find((m) => m <= wanted) ?? decade;
  const [left, top] = [14, height - 14];
  context.beginPath();
  context.moveTo(left, top - 5);
  context.lineTo(left, top);
  context.lineTo(left + length * view.scale, top);
  context.lineTo(left + length * view.scale, top - 5);
  strokeWithHalo(context, theme.ink, 1.5, 1, []);
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.strokeStyle = theme.raised;
  context.lineWidth = 3;
  context.strokeText(`${length} m`, left + 5, top - 3);
  context.fillStyle = theme.ink;
  context.fillText(`${length} m`, left + 5, top - 3);
}

function drawMap(walk, floor, layer, state) {
  const fit = fitCanvas(mapCanvas);
  const { context, width, height } = fit;
  if (width === 0 || height === 0) return;
  drawGround(floor, layer, fit, state);
  context.clearRect(0, 0, width, height);
  context.drawImage(ground.canvas, 0, 0, width, height);
  if (state.shows.truth) drawTruth(context, walk, state);
  const shown = SYSTEMS.filter((system) => state.systems[system.index]);
  for (const { index, dash } of shown) {
    drawLine(context, walk.tracks[index], theme.systems[index], state.time, state.shows.whole, dash);
  }
  for (const { index } of shown) {
    const [track, colour] = [walk.tracks[index], theme.systems[index]];
    const cloud = state.shows.particles ? cloudAt(track, state.time) : null;
    if (cloud) {
      context.globalAlpha = 0.6;
      context.fillStyle = colour;
      for (let k = 0; k < cloud.length; k += 2) {
        const [left, top] = toScreen(cloud[k], cloud[k + 1]);
        context.fillRect(left - 1.3, top - 1.3, 2.6, 2.6);
      }
      context.globalAlpha = 1;
    }
    const fix = fixAt(track, state.time);
    if (!fix) continue;
    if (state.shows.radius95) drawCircle(context, fix, fix.radius95, colour, [4, 5], false);
    if (state.shows.radius68) drawCircle(context, fix, fix.radius68, colour, [], true);
  }
  for (const { index } of shown) {
    const fix = fixAt(walk.tracks[index], state.time);
    if (fix) drawMarker(context, fix, theme.systems[index]);
  }
  drawScale(context, height);
}
