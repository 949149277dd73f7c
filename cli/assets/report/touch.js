// Pointers: drag and pinch the map, drag along the time line, point at the error curves.

/** Calls `drag(dx, dy)`, `zoom(factor, left, top)` and `hover(left, top)`, with fingers or a mouse. */
function watchMap(canvas, { drag, zoom, hover, leave }) {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return { size: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2 };
  };
  canvas.addEventListener("pointerdown", (event) => {
    fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
    try {
      canvas.setPointerCapture(event.pointerId);
    } catch {
      // A pointer that has gone already needs no capture.
    }
  });
  canvas.addEventListener("pointermove", (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger) {
      hover(event.offsetX, event.offsetY);
      return;
    }
    const before = fingers.size === 2 ? spread() : null;
    const [dx, dy] = [event.offsetX - finger.x, event.offsetY - finger.y];
    finger.x = event.offsetX;
    finger.y = event.offsetY;
    if (before) {
      const after = spread();
      drag(after.x - before.x, after.y - before.y);
      if (before.size > 0) zoom(after.size / before.size, after.x, after.y);
    } else if (fingers.size === 1) {
      drag(dx, dy);
    }
  });
  for (const ended of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(ended, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("pointerleave", leave);
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event.offsetX, event.offsetY);
    },
    { passive: false },
  );
  canvas.addEventListener("dblclick", (event) => zoom(2, event.offsetX, event.offsetY));
}

/** Calls `seek(left)` while a pointer is down on `canvas`. */
function watchLine(canvas, seek) {
  let isDown = false;
  canvas.addEventListener("pointerdown", (event) => {
    isDown = true;
    try {
      canvas.setPointerCapture(event.pointerId);
    } catch {
      // As above.
    }
    seek(event.offsetX);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (isDown) seek(event.offsetX);
  });
  for (const ended of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(ended, () => {
      isDown = false;
    });
  }
}
