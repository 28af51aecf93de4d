// Draws numbers against time as SVG. The same in words: the latest value beside the drawing, a summary of what is
// shown, and each point for whoever walks along the line with the arrow keys.

const NS = "http://www.w3.org/2000/svg";
const SIZE = { width: 640, height: 240, left: 58, right: 14, top: 12, bottom: 40 };
const SAME = 1e-5; // of a number: what differs by less is drawn as one; its marks would be too long to read
const QUIET = 2000; // milliseconds without a message after which that is said

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

function draw(tag, attributes = {}, text = "") {
  const element = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  if (text) element.textContent = text;
  return element;
}

// Round numbers that cover a stretch in about `count` steps.
function ticks(low, high, count) {
  const exact = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(exact));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= exact * 0.999);
  const first = Math.floor(low / step + 1e-9);
  const last = Math.ceil(high / step - 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

function short(number) {
  if (!Number.isFinite(number)) return String(number);
  const size = Math.abs(number);
  if (size !== 0 && (size >= 1e6 || size < 1e-3)) return number.toExponential(2);
  return String(Number(number.toPrecision(4)));
}

function pairs(view) {
  const bytes = new Uint8Array(view.buffer, view.byteOffset, view.byteLength).slice();
  const numbers = new Float64Array(bytes.buffer);
  const found = [];
  for (let index = 0; index + 1 < numbers.length; index += 2) found.push([numbers[index], numbers[index + 1]]);
  return found;
}

// A time between two messages that is much longer than usual: nothing was known then, so no line is drawn.
function longestStep(samples) {
  const steps = samples.slice(1).map(([time], index) => time - samples[index][0]);
  steps.sort((one, other) => one - other);
  return Math.max(0.5, 8 * (steps[Math.floor(steps.length / 2)] ?? 0));
}

function render({ model, el }) {
  const topic = model.get("topic");
  const field = model.get("field");
  const span = model.get("span");
  const latest = make("output", { class: "ck-plot-latest", "aria-live": "off" });
  const note = make("span", { class: "ck-plot-note" });
  const svg = draw("svg", {
    viewBox: `0 0 ${SIZE.width} ${SIZE.height}`,
    role: "img",
    tabindex: "0",
    "aria-roledescription": "plot; the left and right arrow keys walk along the line",
  });
  const axes = draw("g", { class: "ck-plot-axes" });
  const line = draw("path", { class: "ck-plot-line" });
  const dot = draw("circle", { class: "ck-plot-dot", r: 3.5, visibility: "hidden" });
  const cursor = draw("g", { class: "ck-plot-cursor", visibility: "hidden" });
  const cursorLine = draw("line", { y1: SIZE.top, y2: SIZE.height - SIZE.bottom });
  const cursorDot = draw("circle", { r: 5 });
  cursor.append(cursorLine, cursorDot);
  svg.append(axes, line, cursor, dot);
  const spoken = make("p", { class: "ck-plot-spoken", role: "status", "aria-live": "polite" });
  const words = make("p", {});
  const summary = make("details", {}, make("summary", {}, "The same in words"), words);
  const panel = make(
    "figure",
    { class: "ck-plot", "aria-label": `${field} of ${topic} against time` },
    make("figcaption", {}, make("strong", {}, `${topic}`), make("code", {}, field), latest, note),
    svg,
    spoken,
    summary,
  );
  el.replaceChildren(panel);

  let samples = [];
  let at = null; // the time of the sample the cursor is on
  let arrived = 0;
  let described = 0;
  let range = null;

  function verticalRange(values) {
    let low = Math.min(...values);
    let high = Math.max(...values);
    if (!(high - low > SAME * Math.max(Math.abs(low), Math.abs(high)))) {
      const room = Math.abs(low) > 0 ? Math.abs(low) * 0.2 : 1;
      [low, high] = [low - room, high + room];
    }
    const marks = ticks(low, high, 4);
    return { low: marks[0], high: marks[marks.length - 1], marks };
  }

  function drawAxes(toX, toY) {
    const bottom = SIZE.height - SIZE.bottom;
    axes.replaceChildren();
    const differ = new Set(range.marks.map(short)).size === range.marks.length;
    for (const mark of range.marks) {
      const y = toY(mark);
      axes.append(draw("line", { x1: SIZE.left, x2: SIZE.width - SIZE.right, y1: y, y2: y }));
      axes.append(draw("text", { x: SIZE.left - 8, y: y + 4, "text-anchor": "end" }, differ ? short(mark) : String(mark)));
    }
    for (const mark of ticks(-span, 0, 5).filter((one) => one >= -span - 1e-9)) {
      const x = toX(mark);
      axes.append(draw("line", { x1: x, x2: x, y1: bottom, y2: bottom + 5 }));
      axes.append(draw("text", { x, y: bottom + 18, "text-anchor": "middle" }, short(mark)));
    }
    const centre = (SIZE.left + SIZE.width - SIZE.right) / 2;
    axes.append(draw("text", { x: centre, y: SIZE.height - 5, "text-anchor": "middle" }, "time in s; 0 is the latest message"));
  }

  function redraw() {
    const finite = samples.filter(([, value]) => Number.isFinite(value));
    const now = samples.length ? samples[samples.length - 1][0] : 0;
    range = verticalRange(finite.length ? finite.map(([, value]) => value) : [0, 1]);
    const width = SIZE.width - SIZE.left - SIZE.right;
    const height = SIZE.height - SIZE.top - SIZE.bottom;
    const toX = (seconds) => SIZE.left + ((seconds + span) / span) * width;
    const toY = (value) => SIZE.top + ((range.high - value) / (range.high - range.low)) * height;
    drawAxes(toX, toY);
    const gap = longestStep(samples);
    let path = "";
    let before = null; // the time of the point the line goes on from
    for (const [time, value] of samples) {
      if (Number.isFinite(value)) {
        const pen = before !== null && time - before <= gap ? "L" : "M";
        path += `${pen}${toX(time - now).toFixed(1)},${toY(value).toFixed(1)}`;
      }
      before = Number.isFinite(value) ? time : null;
    }
    line.setAttribute("d", path);
    const last = finite[finite.length - 1];
    dot.setAttribute("visibility", last ? "visible" : "hidden");
    if (last) {
      dot.setAttribute("cx", toX(last[0] - now));
      dot.setAttribute("cy", toY(last[1]));
    }
    latest.textContent = samples.length ? `now ${short(samples[samples.length - 1][1])}` : "no message yet";
    drawCursor(now, toX, toY);
    if (Date.now() - described > 1000) describe(finite);
  }

  function describe(finite) {
    described = Date.now();
    const values = finite.map(([, value]) => value);
    const text = values.length
      ? `The latest value is ${short(values[values.length - 1])}. In the last ${short(span)} seconds: lowest ` +
        `${short(Math.min(...values))}, highest ${short(Math.max(...values))}. ${model.get("count")} messages so far.`
      : `No message has come on ${topic} yet.`;
    words.textContent = text;
    svg.setAttribute("aria-label", `${field} of ${topic} against time. ${text}`);
  }

  function drawCursor(now, toX, toY) {
    const point = at === null ? undefined : samples.find(([time]) => time >= at);
    cursor.setAttribute("visibility", point ? "visible" : "hidden");
    if (!point) return;
    const x = toX(point[0] - now);
    cursorLine.setAttribute("x1", x);
    cursorLine.setAttribute("x2", x);
    cursorDot.setAttribute("cx", x);
    cursorDot.setAttribute("cy", toY(Number.isFinite(point[1]) ? point[1] : range.low));
  }

  function walk(event) {
    const steps = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -Infinity, End: Infinity };
    if (event.key === "Escape") at = null;
    else if (!(event.key in steps) || !samples.length) return;
    else {
      const here = at === null ? samples.length - 1 : samples.findIndex(([time]) => time >= at);
      const next = at === null && event.key === "ArrowLeft" ? here : here + steps[event.key];
      const index = Math.min(samples.length - 1, Math.max(0, next));
      at = samples[index][0];
      const ago = samples[samples.length - 1][0] - at;
      spoken.textContent = `${short(samples[index][1])}, ${ago.toFixed(1)} s before the latest message`;
    }
    if (at === null) spoken.textContent = "";
    event.preventDefault();
    event.stopPropagation(); // the arrow keys move between a notebook's cells otherwise
    redraw();
  }

  function take() {
    samples = pairs(model.get("samples"));
    if (at !== null && samples.length && at < samples[0][0]) at = samples[0][0];
    arrived = Date.now();
    redraw();
    tell();
  }

  function tell() {
    const quiet = Date.now() - arrived;
    let text = "";
    if (model.get("ended")) text = model.get("ended");
    else if (samples.length && quiet > QUIET) text = `no message for ${Math.floor(quiet / 1000)} s`;
    if (note.textContent !== text) note.textContent = text;
  }

  svg.addEventListener("keydown", walk);
  svg.addEventListener("blur", () => {
    at = null;
    spoken.textContent = "";
    redraw();
  });
  model.on("change:samples", take);
  model.on("change:ended", tell);
  const clock = setInterval(tell, 500);
  take();
  return () => {
    clearInterval(clock);
    model.off("change:samples", take);
    model.off("change:ended", tell);
  };
}

export default { render };
