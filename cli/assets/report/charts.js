// Charts: error over time with its bands, and the share of errors below each distance.

const timelineCanvas = document.getElementById("timeline");
const curvesCanvas = document.getElementById("curves");
const CHART = { left: 40, right: 12, top: 10, axis: 20, band: 18 };
const FONT = "11px system-ui, sans-serif";

/** About `n` round numbers from 0 to `most`, and the distance between them. */
function ticks(most, n) {
  const raw = Math.max(most, 1e-6) / n;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * decade).find((s) => s >= raw * 0.999);
  return Array.from({ length: Math.floor(most / step + 1e-9) + 1 }, (_, k) => Number((k * step).toPrecision(6)));
}

const clockText = (s) => {
  const whole = Math.max(0, s);
  return whole < 60 ? `${whole.toFixed(1)} s` : `${Math.floor(whole / 60)}:${(whole % 60).toFixed(1).padStart(4, "0")}`;
};

/** The time at the screen's `left` in the time line. */
function timeAt(left, duration) {
  const width = timelineCanvas.clientWidth - CHART.left - CHART.right;
  return Math.max(0, Math.min(1, (left - CHART.left) / width)) * duration;
}

/** The largest error that the chart must show: of the systems shown. */
function largestError(walk, state) {
  let most = 0;
  for (const { index } of SYSTEMS) {
    if (!state.systems[index]) continue;
    for (const list of [walk.tracks[index].error, walk.tracks[index].scoredError]) {
      for (const error of list) if (error > most) most = error;
    }
  }
  return Math.max(most * 1.06, 1);
}

function drawTimeline(walk, state) {
  const { context, width, height } = fitCanvas(timelineCanvas);
  const duration = Math.max(walk.duration_s, 0.1);
  const bottom = height - CHART.axis - CHART.band * walk.bands.length - (walk.bands.length ? 6 : 0);
  const right = width - CHART.right;
  const x = (s) => CHART.left + ((right - CHART.left) * s) / duration;
  const most = largestError(walk, state);
  const y = (m) => bottom - ((bottom - CHART.top) * m) / most;
  context.clearRect(0, 0, width, height);
  context.font = FONT;
  drawErrorAxis(context, ticks(most, 3), y, right);
  if (walk.truth.time.length === 0 && !walk.tracks.some((track) => track.scoredError.length)) {
    context.textAlign = "center";
    context.fillText("Nobody knows where this walker truly was: no error.", (CHART.left + right) / 2, (CHART.top + bottom) / 2);
  }
  context.save();
  context.beginPath();
  context.rect(CHART.left, 0, right - CHART.left, bottom + 1);
  context.clip();
  for (const system of SYSTEMS) if (state.systems[system.index]) drawErrorLine(context, walk, system, x, y, bottom);
  context.restore();
  drawTimeAxis(context, duration, x, bottom);
  walk.bands.forEach((band, k) => {
    drawBand(context, band, x, bottom + CHART.axis + 4 + k * CHART.band, state.time, k * 2);
  });
  context.strokeStyle = theme.ink;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(x(state.time), 2);
  context.lineTo(x(state.time), height);
  context.stroke();
  context.fillStyle = theme.ink;
  context.beginPath();
  context.arc(x(state.time), 4, 4, 0, 2 * Math.PI);
  context.fill();
}

function drawErrorAxis(context, values, y, right) {
  context.textAlign = "right";
  context.textBaseline = "middle";
  context.lineWidth = 1;
  for (const value of values) {
    context.strokeStyle = theme.line;
    context.beginPath();
    context.moveTo(CHART.left, Math.round(y(value)) + 0.5);
    context.lineTo(right, Math.round(y(value)) + 0.5);
    context.stroke();
    context.fillStyle = theme.soft;
    context.fillText(`${value} m`, CHART.left - 6, y(value));
  }
}

function drawTimeAxis(context, duration, x, bottom) {
  context.textBaseline = "top";
  context.fillStyle = theme.soft;
  const values = ticks(duration, Math.max(2, Math.min(9, (x(duration) - x(0)) / 90)));
  values.forEach((value, k) => {
    context.textAlign = k === 0 ? "left" : x(value) > x(duration) - 14 ? "right" : "center";
    const text = duration < 120 ? `${value} s` : `${Math.floor(value / 60)}:${String(Math.round(value % 60)).padStart(2, "0")}`;
    context.fillText(text, x(value), bottom + 5);
  });
}

function drawErrorLine(context, walk, { index, dash }, x, y, bottom) {
  const track = walk.tracks[index];
  const colour = theme.systems[index];
  if (index === report.primary && track.error.some(Number.isFinite)) {
    context.beginPath();
    track.time.forEach((s, k) => (k ? context.lineTo(x(s), y(track.radius68[k])) : context.moveTo(x(s), y(track.radius68[k]))));
    context.lineTo(x(track.time[track.time.length - 1]), bottom);
    context.lineTo(x(track.time[0]), bottom);
    context.closePath();
    context.globalAlpha = 0.13;
    context.fillStyle = colour;
    context.fill();
    context.globalAlpha = 1;
  }
  context.beginPath();
  let isOpen = false;
  track.error.forEach((error, k) => {
    if (!Number.isFinite(error)) isOpen = false;
    else if (isOpen) context.lineTo(x(track.time[k]), y(error));
    else {
      context.moveTo(x(track.time[k]), y(error));
      isOpen = true;
    }
  });
  context.strokeStyle = colour;
  context.lineWidth = 1.8;
  context.lineJoin = "round";
  context.setLineDash(dash);
  context.stroke();
  context.setLineDash([]);
  context.fillStyle = colour;
  context.strokeStyle = theme.raised;
  context.lineWidth = 1.5;
  track.scoredError.forEach((error, k) => {
    context.beginPath();
    context.arc(x(track.scoredTime[k]), y(error), 3.6, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  });
}

function drawBand(context, band, x, top, time, firstColour) {
  const labels = [...new Set(band.spans.map((span) => span.label))];
  context.textBaseline = "middle";
  context.textAlign = "right";
  context.fillStyle = theme.soft;
  context.fillText(band.name, CHART.left - 6, top + 7.5);
  context.textAlign = "left";
  for (const span of band.spans) {
    const [from, to] = [x(span.from_s), x(span.to_s)];
    context.globalAlpha = time >= span.from_s && time < span.to_s ? 1 : 0.72;
    context.fillStyle = theme.bands[(firstColour + labels.indexOf(span.label)) % theme.bands.length];
    context.beginPath();
    context.roundRect(from, top, Math.max(to - from - 1, 1), 15, 3);
    context.fill();
    context.globalAlpha = 1;
    if (context.measureText(span.label).width + 10 < to - from) {
      context.fillStyle = theme.ink;
      context.fillText(span.label, from + 6, top + 8);
    }
  }
}

/** What the bands say at a time. */
function bandsAt(walk, time) {
  return walk.bands.flatMap((band) => {
    const span = band.spans.find((s) => time >= s.from_s && time < s.to_s);
    return span ? [`${band.name}: ${span.label}`] : [];
  });
}

/** The share of a system's errors that are at most `distance`. */
function shareBelow(curve, distance) {
  const cm = 100 * distance;
  const values = curve.quantiles_cm;
  const k = lastBefore(values, cm);
  if (k < 0) return 0;
  if (k === values.length - 1) return 1;
  return (k + (cm - values[k]) / (values[k + 1] - values[k])) / (values.length - 1);
}

/** Up to where errors are drawn: nine tenths of the worst system, all but a fiftieth of the best. */
function curvesReach(curves) {
  const at = (curve, share) => curve.quantiles_cm[Math.round(share * (curve.quantiles_cm.length - 1))] / 100;
  const worst = Math.max(...curves.map((curve) => at(curve, 0.9)));
  const best = Math.max(...curves.slice(-1).map((curve) => at(curve, 0.98)));
  return Math.max(worst, best, 0.5) * 1.04;
}

function drawCurves(state) {
  const { context, width, height } = fitCanvas(curvesCanvas);
  const curves = report.curves;
  if (!curves.length || width === 0) return;
  const [left, right, top, bottom] = [CHART.left, width - 14, 12, height - 34];
  const reach = curvesReach(curves);
  const x = (m) => left + ((right - left) * m) / reach;
  const y = (share) => bottom - (bottom - top) * share;
  context.clearRect(0, 0, width, height);
  context.font = FONT;
  context.lineWidth = 1;
  for (const percent of [0, 25, 50, 75, 100]) {
    context.strokeStyle = theme.line;
    context.beginPath();
    context.moveTo(left, Math.round(y(percent / 100)) + 0.5);
    context.lineTo(right, Math.round(y(percent / 100)) + 0.5);
    context.stroke();
    context.fillStyle = theme.soft;
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.fillText(`${percent} %`, left - 6, y(percent / 100));
  }
  context.textBaseline = "top";
  ticks(reach, Math.min(8, (right - left) / 60)).forEach((value, k) => {
    context.textAlign = k ? "center" : "left";
    context.fillText(`${value} m`, x(value), bottom + 6);
  });
  context.textAlign = "right";
  context.fillText("error", right, bottom + 20);
  for (const system of SYSTEMS) {
    const curve = curves.find((candidate) => candidate.system === system.name);
    if (!curve || !state.systems[system.index]) continue;
    context.beginPath();
    let last = null;
    curve.quantiles_cm.forEach((cm, k) => {
      const at = [Math.min(x(cm / 100), right), y(k / (curve.quantiles_cm.length - 1))];
      if (last && last[0] >= right) return;
      if (last) context.lineTo(...at);
      else context.moveTo(...at);
      last = at;
    });
    context.strokeStyle = theme.systems[system.index];
    context.lineWidth = 2.2;
    context.setLineDash(system.dash);
    context.stroke();
    context.setLineDash([]);
  }
  if (state.probe !== null) drawProbe(context, curves, state, { x, y, left, right, top, bottom, reach });
}

function drawProbe(context, curves, state, { x, y, left, right, top, bottom, reach }) {
  const distance = Math.min(state.probe, reach);
  context.strokeStyle = theme.ink;
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(x(distance), top);
  context.lineTo(x(distance), bottom);
  context.stroke();
  for (const system of SYSTEMS) {
    const curve = curves.find((candidate) => candidate.system === system.name);
    if (!curve || !state.systems[system.index]) continue;
    context.beginPath();
    context.arc(x(distance), y(shareBelow(curve, distance)), 4, 0, 2 * Math.PI);
    context.fillStyle = theme.systems[system.index];
    context.strokeStyle = theme.raised;
    context.fill();
    context.stroke();
  }
}
