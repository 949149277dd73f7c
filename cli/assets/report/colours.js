// Colours: perceptual scales for layers, and the theme's own for all else.

// Viridis (van der Walt and Smith 2015, CC0) at tenths; told apart with any colour vision, and in grey.
const SEQUENTIAL = [
  [68, 1, 84], [72, 40, 120], [62, 73, 137], [49, 104, 142], [38, 130, 142],
  [31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37],
];
// Blue to orange through near white: both signs are told apart with any colour vision.
const SIGNED = [
  [5, 65, 120], [52, 120, 170], [130, 178, 210], [205, 222, 234], [242, 240, 236],
  [244, 221, 190], [233, 174, 107], [200, 112, 38], [135, 62, 8],
];

/** The colour of the share 0 to 1 of a scale. */
function scaleColour(scale, share) {
  const at = Math.max(0, Math.min(1, share)) * (scale.length - 1);
  const k = Math.min(Math.floor(at), scale.length - 2);
  return [0, 1, 2].map((c) => Math.round(scale[k][c] + (at - k) * (scale[k + 1][c] - scale[k][c])));
}

const scaleOf = (layer) => (layer.is_signed ? SIGNED : SEQUENTIAL);

let theme = {};

/** Reads the theme's colours from the style sheet, after it has changed. */
function readTheme() {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  theme = {
    paper: colour("paper"),
    raised: colour("raised"),
    ink: colour("ink"),
    soft: colour("soft"),
    line: colour("line"),
    room: colour("room"),
    corridor: colour("corridor"),
    wall: colour("wall"),
    accent: colour("accent"),
    bands: [0, 1, 2, 3, 4].map((k) => colour(`band-${k}`)),
    systems: SYSTEMS.map((system) => colour(`system-${system.slot}`)),
    heat: Number(colour("heat")) || 0.8,
  };
}

/** A canvas fitted to its box on the page and to the screen's pixels: its context, width and height in CSS pixels. */
function fitCanvas(canvas) {
  const ratio = Math.min(window.devicePixelRatio || 1, 3);
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return { context, width, height, ratio };
}
