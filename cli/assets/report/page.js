// The page: what is chosen, and what follows from every choice.

const state = {
  walk: 0,
  isChosen: false,
  time: 0,
  isPlaying: false,
  speed: 4,
  layer: "Strength",
  lastLayer: "Strength",
  systems: SYSTEMS.map(() => true),
  shows: Object.fromEntries(SHOWS.map(([id, , , isOn]) => [id, isOn])),
  probe: null,
  hover: null,
};

const walkNow = () => openWalk(state.walk);
const floorNow = () => report.floors[walkNow().floor];
const layerNow = () => floorNow().layers.find((layer) => layer.name === state.layer) ?? null;
const announce = (text) => {
  byId("status").textContent = text;
};

let isDrawAsked = false;

/** Draws at the next frame, once however often it is asked for. */
function redraw() {
  if (isDrawAsked) return;
  isDrawAsked = true;
  requestAnimationFrame(() => {
    isDrawAsked = false;
    draw();
  });
}

function draw() {
  if (!report.walks.length) return;
  const walk = walkNow();
  const primary = walk.tracks[report.primary];
  if (state.shows.follow) {
    const at = placeAt(walk.truth, state.time) ?? (primary && fixAt(primary, state.time));
    if (at) [view.x, view.y] = [at.x, at.y];
  }
  drawMap(walk, floorNow(), layerNow(), state);
  drawTimeline(walk, state);
  sayNow(walk);
}

/** Numbers beside the drawings: the clock, each system's error, what is under the pointer. */
function sayNow(walk) {
  const slider = byId("time");
  slider.value = String(state.time);
  const clock = `${clockText(state.time)} of ${clockText(walk.duration_s)}`;
  byId("clock").textContent = clock;
  slider.setAttribute("aria-valuetext", clock);
  for (const { index } of SYSTEMS) {
    const fix = fixAt(walk.tracks[index], state.time);
    const error = fix && Number.isFinite(fix.error) ? `${fix.error.toFixed(1)} m off` : "";
    byId(`now-${index}`).textContent = fix ? [error, `± ${fix.radius68.toFixed(1)} m`].filter(Boolean).join(" · ") : "no fix";
  }
  const layer = layerNow();
  const parts = bandsAt(walk, state.time);
  if (state.hover) {
    const [x, y] = toPlace(...state.hover);
    parts.push(`${x.toFixed(1)}, ${y.toFixed(1)} m`);
    const value = layer && layerAt(layer, x, y);
    if (layer) parts.push(value === null ? "not surveyed" : say(value, layer.unit, 1));
  }
  byId("readout").textContent = parts.join("   ");
}

function seek(time) {
  state.time = Math.max(0, Math.min(time, walkNow().duration_s));
  redraw();
}

function play(isPlaying) {
  if (isPlaying && state.time >= walkNow().duration_s - 0.01) state.time = 0;
  state.isPlaying = isPlaying;
  byId("play").setAttribute("aria-pressed", String(isPlaying));
  byId("play").setAttribute("aria-label", isPlaying ? "Pause" : "Play");
  if (!isPlaying) return;
  let last = performance.now();
  const tick = (now) => {
    if (!state.isPlaying) return;
    state.time += (state.speed * Math.min(now - last, 250)) / 1000;
    last = now;
    if (state.time >= walkNow().duration_s) {
      state.time = walkNow().duration_s;
      play(false);
    }
    draw();
    if (state.isPlaying) requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

function chooseWalk(index) {
  const floorBefore = state.isChosen ? floorNow() : null;
  state.walk = Math.max(0, Math.min(index, report.walks.length - 1));
  state.isChosen = true;
  state.time = 0;
  const walk = walkNow();
  byId("time").max = String(walk.duration_s);
  for (const button of document.querySelectorAll(".walk")) {
    const isChosen = Number(button.dataset.walk) === state.walk;
    if (isChosen) button.setAttribute("aria-current", "true");
    else button.removeAttribute("aria-current");
    if (isChosen) button.scrollIntoView({ block: "nearest", inline: "nearest" });
  }
  fitView(walkExtent(walk, floorNow()));
  if (floorNow() !== floorBefore) {
    fillLayers(floorNow(), state.layer);
    drawLegend(layerNow());
  }
  byId("truth-kind").textContent = {
    continuous: "Truth", waypoints: "Waypoints, and the way between them by steps", none: "Truth: not known",
  }[walk.truth.kind];
  byId("truth-line").setAttribute("stroke-dasharray", walk.truth.kind === "waypoints" ? "6 4" : "none");
  const errors = SYSTEMS.flatMap(({ name, index: k }) =>
    walk.errors[k] ? [`${name} ${say(walk.errors[k].mean_m, "m")} mean error`] : []);
  timelineCanvas.setAttribute("aria-label", `Error over time of ${walk.name}: ${errors.join(", ") || "truth unknown"}`);
  mapCanvas.setAttribute("aria-label", `Floor ${floorNow().name} with walk ${walk.name}`);
  announce(`Walk ${walk.name}`);
  redraw();
}

function chooseLayer(name) {
  state.layer = name;
  if (name) state.lastLayer = name;
  byId("layer").value = name;
  drawLegend(layerNow());
  announce(name ? `Layer ${name}` : "No layer");
  redraw();
}

function cycleLayer(by) {
  const names = ["", ...floorNow().layers.map((layer) => layer.name)];
  chooseLayer(names[(names.indexOf(state.layer) + by + names.length) % names.length]);
}

function toggleSystem(index, isOn) {
  state.systems[index] = isOn;
  byId(`system-${index}`).checked = isOn;
  announce(`${SYSTEMS[index].name} ${isOn ? "on" : "off"}`);
  drawCurves(state);
  redraw();
}

function toggleShow(id, isOn) {
  state.shows[id] = isOn;
  byId(`show-${id}`).checked = isOn;
  if (id === "follow" && isOn && view.fittedTo) zoomAt(3, mapCanvas.clientWidth / 2, mapCanvas.clientHeight / 2);
  redraw();
}

function chooseTheme(isDark) {
  document.documentElement.dataset.theme = isDark ? "dark" : "light";
  byId("theme").setAttribute("aria-pressed", String(isDark));
  readTheme();
  drawLegend(layerNow());
  drawCurves(state);
  redraw();
}

const isDarkNow = () => document.documentElement.dataset.theme === "dark";

function zoomMiddle(factor) {
  zoomAt(factor, mapCanvas.clientWidth / 2, mapCanvas.clientHeight / 2);
  redraw();
}

/** Shows the whole floor or, where that is shown, the walk. */
function fitAgain() {
  if (state.shows.follow) toggleShow("follow", false);
  const whole = floorExtent(floorNow());
  const isWhole = view.fittedTo !== null && view.fittedTo.join() === whole.join();
  fitView(isWhole ? walkExtent(walkNow(), floorNow()) : whole);
  redraw();
}

/** What a key does; true when it does something. */
function press(key, isShifted) {
  const step = isShifted ? 10 : 1;
  const show = SHOWS.find(([, , letter]) => letter === key.toUpperCase());
  if (key === " ") play(!state.isPlaying);
  else if (key === "ArrowLeft") seek(state.time - step);
  else if (key === "ArrowRight") seek(state.time + step);
  else if (key === "Home") seek(0);
  else if (key === "End") seek(walkNow().duration_s);
  else if (key === "[") chooseWalk(state.walk - 1);
  else if (key === "]") chooseWalk(state.walk + 1);
  else if (key >= "1" && key <= "9" && SYSTEMS[Number(key) - 1]) toggleSystem(Number(key) - 1, !state.systems[Number(key) - 1]);
  else if (key === "l" || key === "L") cycleLayer(isShifted ? -1 : 1);
  else if (key === "n" || key === "N") chooseLayer(state.layer ? "" : state.lastLayer);
  else if (key === "+" || key === "=") zoomMiddle(1.4);
  else if (key === "-" || key === "−") zoomMiddle(1 / 1.4);
  else if (key === "0") fitAgain();
  else if (key === "d" || key === "D") chooseTheme(!isDarkNow());
  else if (key === "?") byId("help").showModal();
  else if (show) toggleShow(show[0], !state.shows[show[0]]);
  else return false;
  return true;
}

function listen() {
  byId("play").addEventListener("click", () => play(!state.isPlaying));
  byId("time").addEventListener("input", (event) => seek(Number(event.target.value)));
  byId("speed").addEventListener("change", (event) => {
    state.speed = Number(event.target.value);
  });
  byId("layer").addEventListener("change", (event) => chooseLayer(event.target.value));
  byId("theme").addEventListener("click", () => chooseTheme(!isDarkNow()));
  byId("help-open").addEventListener("click", () => byId("help").showModal());
  byId("zoom-in").addEventListener("click", () => zoomMiddle(1.4));
  byId("zoom-out").addEventListener("click", () => zoomMiddle(1 / 1.4));
  byId("zoom-fit").addEventListener("click", fitAgain);
  document.addEventListener("keydown", (event) => {
    const { target } = event;
    const isPressable = target.matches("button, select, input[type=checkbox], summary");
    // Menus read letters and arrows themselves, and a button or box in focus is pressed with Space.
    if (event.ctrlKey || event.metaKey || event.altKey || byId("help").open || target.matches("select")) return;
    if (event.key === " " && isPressable) return;
    if (press(event.key, event.shiftKey)) event.preventDefault();
  });
  watchMap(mapCanvas, {
    drag(left, top) {
      if (state.shows.follow) toggleShow("follow", false);
      moveView(left, top);
      redraw();
    },
    zoom(factor, left, top) {
      zoomAt(factor, left, top);
      redraw();
    },
    hover(left, top) {
      state.hover = [left, top];
      redraw();
    },
    leave() {
      state.hover = null;
      redraw();
    },
  });
  watchLine(timelineCanvas, (left) => seek(timeAt(left, walkNow().duration_s)));
  curvesCanvas.addEventListener("pointermove", (event) => probe(event.offsetX));
  curvesCanvas.addEventListener("pointerleave", () => probe(null));
  new ResizeObserver(() => {
    if (view.fittedTo) fitView(view.fittedTo);
    drawLegend(layerNow());
    drawCurves(state);
    redraw();
  }).observe(byId("map-frame"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", (event) => chooseTheme(event.matches));
}

/** Reads the error curves below a distance. */
function probe(left) {
  const width = curvesCanvas.clientWidth - CHART.left - 14;
  state.probe = left === null ? null : Math.max(0, ((left - CHART.left) / width) * curvesReach(report.curves));
  drawCurves(state);
  const shares = report.curves.map((curve) => `${curve.system} ${(100 * shareBelow(curve, state.probe ?? 0)).toFixed(0)} %`);
  byId("curves-caption").textContent = left === null ? curvesCaption() : `within ${say(state.probe, "m")}: ${shares.join(", ")}`;
}

function curvesCaption() {
  const points = report.curves[0] ? POINTS[report.curves[0].points] : "";
  const walks = report.n_walks === 1 ? "one walk" : `${report.n_walks} walks`;
  return `Share of errors below each distance, ${points}, on ${walks}`;
}

function begin() {
  byId("title").textContent = report.title;
  byId("about").textContent = report.about;
  byId("made").textContent = `Made by ${report.software}. Everything is in this file; it fetches nothing.`;
  makeHelp();
  makeWalks(chooseWalk);
  makeSystems(toggleSystem);
  makeShows(toggleShow);
  byId("errors").hidden = report.curves.length === 0;
  document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  readTheme();
  chooseWalk(0);
  chooseTheme(isDarkNow());
  listen();
  if (report.curves.length === 0) return;
  makeRows();
  byId("curves-caption").textContent = curvesCaption();
  const medians = report.curves.map((curve) => `${curve.system} ${(curve.quantiles_cm[100] / 100).toFixed(2)} m`);
  curvesCanvas.setAttribute("aria-label", `${curvesCaption()}; medians: ${medians.join(", ")}`);
}

if (report.walks.length) {
  begin();
} else {
  byId("main").replaceChildren(element("p", { class: "notice" }, "This report holds no walk."));
}
