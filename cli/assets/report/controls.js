// Controls: lists, switches, the legend and the table, made from the report.

const SHOWS = [
  ["truth", "Truth", "T", true],
  ["radius68", "68 % radius", "R", true],
  ["radius95", "95 % radius", "E", false],
  ["particles", "Particles", "P", true],
  ["whole", "Whole way", "W", true],
  ["routes", "Survey lines", "S", false],
  ["follow", "Follow", "F", false],
];

const KEYS = [
  ["Space", "play or pause"],
  ["← →", "a second back or on; with Shift, ten"],
  ["Home, End", "to the beginning, to the end"],
  ["[ ]", "previous or next walk"],
  ["1 – 9", "switch a system on or off"],
  ["L", "next map layer; with Shift, the previous"],
  ["N", "no map layer, or the last one"],
  ["T R E P W S F", "truth, 68 % and 95 % radius, particles, whole way, survey lines, follow"],
  ["+ − 0", "zoom in, out, show the whole floor or the walk"],
  ["D", "light or dark"],
  ["?", "this help"],
];

const element = (name, attributes = {}, ...children) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "class") made.className = value;
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
};

const byId = (id) => document.getElementById(id);

/** A short line in a system's colour and dashes. */
function swatch({ slot, dash }) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  svg.setAttribute("viewBox", "0 0 26 8");
  svg.setAttribute("class", `swatch slot-${slot}`);
  svg.setAttribute("aria-hidden", "true");
  path.setAttribute("d", "M1 4h24");
  path.setAttribute("stroke-dasharray", dash.map((n) => n * 0.8).join(" "));
  svg.append(path);
  return svg;
}

function makeWalks(choose) {
  const means = report.walks.map((walk) => walk.errors[report.primary]?.mean_m);
  const largest = Math.max(...means.filter(Number.isFinite), 0);
  report.walks.forEach((walk, index) => {
    const mean = means[index];
    const bar = element("meter", { min: 0, max: largest || 1, value: mean ?? 0, "aria-hidden": "true" });
    const error = Number.isFinite(mean) ? `mean error ${say(mean, "m", 1)}` : "truth unknown";
    const isSeedTold = walk.seed.length < 5 && report.walks.some((other) => other.seed !== walk.seed);
    const floor = report.floors.length > 1 ? `${report.floors[walk.floor].name} · ` : "";
    // Names from a collection often differ at their ends alone.
    const name = walk.name.length > 18 ? `${walk.name.slice(0, 8)}…${walk.name.slice(-4)}` : walk.name;
    const button = element(
      "button",
      { type: "button", class: "walk", "data-walk": index },
      element("span", { class: "walk-name", title: walk.name }, name),
      element("span", { class: "walk-floor" }, `${floor}${Math.round(walk.duration_s)} s`),
      element("span", { class: "walk-error" }, isSeedTold ? `${error}, seed ${walk.seed}` : error),
      bar,
    );
    button.addEventListener("click", () => choose(index));
    byId("walks").append(element("li", {}, button));
  });
}

function makeSystems(toggle) {
  for (const system of SYSTEMS) {
    const { name, index } = system;
    const box = element("input", { type: "checkbox", id: `system-${index}`, "data-system": index, checked: true });
    box.addEventListener("change", () => toggle(index, box.checked));
    const row = element(
      "label",
      { class: "system", for: `system-${index}` },
      box,
      swatch(system),
      element("span", { class: "system-name" }, name),
      // No key is left for a tenth.
      ...(index < 9 ? [element("kbd", { "aria-hidden": "true" }, String(index + 1))] : []),
      element("output", { class: "system-now", id: `now-${index}` }),
    );
    byId("systems").append(row);
  }
}

function makeShows(toggle) {
  for (const [id, label, key, isOn] of SHOWS) {
    const box = element("input", { type: "checkbox", id: `show-${id}`, "data-show": id, checked: isOn });
    box.addEventListener("change", () => toggle(id, box.checked));
    byId("shows").append(
      element("label", { class: "chip", for: `show-${id}`, title: `key ${key}` }, box, element("span", {}, label)),
    );
  }
}

function fillLayers(floor, chosen) {
  const options = floor.layers.map((layer) => element("option", { value: layer.name }, `${layer.name}, ${layer.unit}`));
  byId("layer").replaceChildren(element("option", { value: "" }, "None"), ...options);
  byId("layer").value = chosen;
}

/** The layer's scale with its unit, in the very colours of the map. */
function drawLegend(layer) {
  byId("legend").hidden = !layer;
  if (!layer) return;
  const { context, width, height } = fitCanvas(byId("legend-bar"));
  context.fillStyle = theme.room;
  context.fillRect(0, 0, width, height);
  context.globalAlpha = theme.heat;
  for (let left = 0; left < width; left++) {
    const [r, g, b] = scaleColour(scaleOf(layer), left / Math.max(width - 1, 1));
    context.fillStyle = `rgb(${r} ${g} ${b})`;
    context.fillRect(left, 0, 1.5, height);
  }
  context.globalAlpha = 1;
  const digits = layer.high - layer.low < 10 ? 1 : 0;
  const value = (number) => number.toFixed(digits).replace("-", "−");
  byId("legend-low").textContent = `≤ ${value(layer.low)}`;
  byId("legend-high").textContent = `≥ ${value(layer.high)}`;
  byId("legend-unit").textContent = layer.unit;
}

const POINTS = {
  waypoint: "at waypoints", midpoint: "midway between waypoints", cut_off: "at cut-offs", truth: "once a second",
};

const SHORT_POINTS = { waypoint: "waypoints", midpoint: "midway", cut_off: "cut-offs", truth: "each second" };

/** The table, floor by floor; systems stand side by side where they are scored at the same kind of point. */
function makeRows() {
  const several = new Set(report.rows.map((row) => row.floor)).size > 1;
  const kinds = new Set(report.rows.map((row) => row.points)).size > 1;
  const heads = [
    ...(several ? ["floor"] : []), "system", ...(kinds ? ["where"] : []), "points", "median", "mean", "80 %", "90 %",
    "in 68 %", "in 95 %",
  ];
  const head = element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)));
  const number = (value, digits) => (value === null ? "–" : value.toFixed(digits));
  const floors = [...new Set(report.rows.map((row) => row.floor))];
  const order = (row) => 10 * floors.indexOf(row.floor) + Object.keys(SHORT_POINTS).indexOf(row.points);
  const rows = [...report.rows].sort((a, b) => order(a) - order(b)).map((row) => {
    const system = SYSTEMS.find((candidate) => candidate.name === row.system);
    const name = element("th", { scope: "row" }, ...(system ? [swatch(system)] : []), row.system);
    const cells = [
      number(row.n_points, 0), number(row.median_m, 2), number(row.mean_m, 2), number(row.p80_m, 2), number(row.p90_m, 2),
      row.inside_68 === null ? "–" : `${(100 * row.inside_68).toFixed(0)} %`,
      row.inside_95 === null ? "–" : `${(100 * row.inside_95).toFixed(0)} %`,
    ];
    return element(
      "tr",
      {},
      ...(several ? [element("td", { class: "text" }, row.floor)] : []),
      name,
      ...(kinds ? [element("td", { class: "text" }, SHORT_POINTS[row.points])] : []),
      ...cells.map((text) => element("td", {}, text)),
    );
  });
  byId("rows").append(
    element("caption", {}, "Errors in metres; how many of a hundred truths lie within the stated radii"),
    element("thead", {}, head),
    element("tbody", {}, ...rows),
  );
}

function makeHelp() {
  for (const [keys, meaning] of KEYS) {
    byId("keys").append(element("dt", {}, element("kbd", {}, keys)), element("dd", {}, meaning));
  }
}
