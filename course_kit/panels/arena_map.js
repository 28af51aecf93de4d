// A map of the robot's arena. Everything it draws comes from the model; a click only asks.
const SVG = "http://www.w3.org/2000/svg";
const MARKS = { running: "▶", good: "✔", bad: "✖", stopped: "■" };
const MARGIN = 1; // metres around the arena that can be clicked as well: the server says no to them

function svg(name, attributes, parent) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent?.append(element);
  return element;
}

function html(name, properties, parent) {
  const element = Object.assign(document.createElement(name), properties);
  parent?.append(element);
  return element;
}

function drawArena(picture, size) {
  // y grows upwards on a map, downwards in a picture: everything inside this group is turned over.
  const ground = svg("g", { transform: `translate(0 ${size}) scale(1 -1)` }, picture);
  svg("rect", { class: "floor", x: 0, y: 0, width: size, height: size }, ground);
  for (let metre = 1; metre < size; metre++) {
    svg("path", { class: "grid", d: `M${metre} 0V${size}M0 ${metre}H${size}` }, ground);
  }
  svg("rect", { class: "wall", x: 0, y: 0, width: size, height: size }, ground);
  for (let metre = 0; metre <= size; metre += 2) {
    svg("text", { x: metre, y: size + 0.55, "text-anchor": "middle" }, picture).textContent = metre;
    svg("text", { x: -0.2, y: size - metre + 0.13, "text-anchor": "end" }, picture).textContent = metre;
  }
  svg("text", { x: size / 2, y: size + 0.95, "text-anchor": "middle" }, picture).textContent = "x (m)";
  svg("text", { x: -0.2, y: -0.35, "text-anchor": "middle" }, picture).textContent = "y (m)";
  return ground;
}

function drawThings(ground) {
  const track = svg("polyline", { class: "track" }, ground);
  const target = svg("g", { class: "target" }, ground);
  svg("circle", { r: 0.32 }, target);
  svg("path", { d: "M-0.5 0H0.5M0 -0.5V0.5" }, target);
  const robot = svg("g", { class: "robot" }, ground);
  const body = svg("g", {}, robot);
  svg("rect", { x: -0.2, y: -0.36, width: 0.36, height: 0.12, rx: 0.04 }, body);
  svg("rect", { x: -0.2, y: 0.24, width: 0.36, height: 0.12, rx: 0.04 }, body);
  svg("circle", { r: 0.28 }, body);
  svg("path", { class: "nose", d: "M0.2 0L-0.08 0.15V-0.15Z" }, body);
  return { track, target, robot, body };
}

function place(element, [x, y] = []) {
  element.style.display = x === undefined ? "none" : "";
  if (x !== undefined) element.style.transform = `translate(${x}px, ${y}px)`;
}

function heading(corners) {
  const [before, here] = corners.slice(-2);
  return here ? (Math.atan2(here[1] - before[1], here[0] - before[0]) * 180) / Math.PI : 0;
}

function coordinateInput(form, name, value = 2) {
  const label = html("label", { textContent: `${name} (m) ` }, form);
  return html("input", { type: "number", step: "any", required: true, value, name }, label);
}

function render({ model, el }) {
  const size = model.get("size");
  const box = html("div", { className: "ck-panel ck-map" }, el);
  box.setAttribute("data-lm-suppress-shortcuts", "true"); // JupyterLab's one-letter shortcuts
  const picture = svg("svg", { viewBox: `${-MARGIN} ${-MARGIN} ${size + 2 * MARGIN} ${size + 2 * MARGIN}` }, box);
  picture.setAttribute("role", "img");
  const things = drawThings(drawArena(picture, size));

  const form = html("form", { className: "ck-buttons" }, box);
  const [lastX, lastY] = model.get("view").target; // of a page that has been loaded again
  const x = coordinateInput(form, "x", lastX);
  const y = coordinateInput(form, "y", lastY);
  const go = html("button", { type: "submit", textContent: "Go", className: "ck-main" }, form);
  const cancel = html("button", { type: "button", textContent: "Cancel goal" }, form);
  const outcome = html("p", { className: "ck-outcome" }, box);
  const said = html("p", { className: "ck-said" }, box); // for screen readers: not ten times a second
  said.setAttribute("role", "status");

  const drive = (toX, toY) => model.send({ do: "go", x: toX, y: toY });
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    drive(x.valueAsNumber, y.valueAsNumber);
  });
  // A notebook keeps Enter from submitting a form, which a browser would do by itself.
  form.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.target.tagName !== "INPUT") return;
    event.preventDefault();
    form.requestSubmit();
  });
  cancel.addEventListener("click", () => model.send({ do: "cancel" }));
  picture.addEventListener("click", (event) => {
    const inverse = picture.getScreenCTM().inverse();
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(inverse);
    const [toX, toY] = [point.x, size - point.y].map((value) => Math.round(value * 10) / 10);
    x.value = toX;
    y.value = toY;
    drive(toX, toY);
  });
  const update = () => {
    const view = model.get("view");
    things.track.setAttribute("points", view.track.map((corner) => corner.join(",")).join(" "));
    place(things.target, view.target);
    place(things.robot, view.track.at(-1));
    if (view.track.length > 1) things.body.setAttribute("transform", `rotate(${heading(view.track)})`);
    outcome.textContent = MARKS[view.tone] ? `${MARKS[view.tone]} ${view.line}` : view.line;
    if (said.textContent !== view.said) said.textContent = view.said;
    picture.setAttribute("aria-label", `Map of the arena. ${view.said}`);
    cancel.disabled = !view.running;
    go.disabled = x.disabled = y.disabled = view.ended;
    outcome.dataset.tone = view.tone;
  };
  model.on("change:view", update);
  update();
  return () => model.off("change:view", update);
}

export default { render };
