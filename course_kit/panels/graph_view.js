// Shows the ROS graph as Python has drawn it, lets one zoom, and brings out what is connected.

const ZOOM_STEP = 1.25;
const LEAST_ZOOM = 0.1;
const MOST_ZOOM = 2.5;
const READABLE = 0.75; // below this its smallest text is under 9 pixels; a wider picture is cut off
const READABLE_DOCKED = 0.64; // beside a notebook, and in one beside a panel, there is less room: 8 pixels
const NARROW_CELL = 640;
const AROUND = 230; // pixels that a docked picture leaves to what stands above and below it

function render({ model, el }) {
  const picture = make("div", { class: "ck-picture", tabindex: "0", role: "group", "aria-label": "The picture" });
  const plumbing = make("input", { type: "checkbox" });
  const text = make("pre", { tabindex: "0", "aria-label": "The graph as text" });
  const news = make("span", { class: "ck-quiet", role: "status", "aria-live": "polite" });
  const scale = make("span", { class: "ck-quiet ck-scale" });
  const legend = make("div", { class: "ck-quiet" },
    "Dashed arrow: the node listens, calls or sends goals. Solid: it publishes, answers or runs the action. " +
      "lab: this notebook, with what it has used since this picture began.");
  const button = (label, name, act) => {
    const made = make("button", { type: "button", "aria-label": name, title: name }, label);
    made.addEventListener("click", act);
    return made;
  };
  const panel = make("section",
    { class: "ck-panel ck-graph", "aria-label": "The ROS graph", "data-lm-suppress-shortcuts": "true" });
  const docking = dockable(panel, "ROS graph");
  panel.append(
    make("div", { class: "ck-title" }, make("strong", {}, "The ROS graph"), news),
    make("div", { class: "ck-buttons" },
      button("−", "Smaller", () => zoomTo(zoom / ZOOM_STEP)), scale,
      button("+", "Larger", () => zoomTo(zoom * ZOOM_STEP)),
      button("Fit", "Fit all of it into the frame", () => zoomTo(fitting(true))), docking.button),
    picture,
    legend,
    make("label", { class: "ck-plumbing" }, plumbing,
      make("span", {}, "Show ROS's own plumbing too (parameter services, /rosout, parts of actions)")),
    make("details", {}, make("summary", {}, "The same in words"), text),
  );
  el.replaceChildren(panel);

  let drawing = null;
  let zoom = 1;
  let own = false; // whether the reader has chosen the zoom
  const cross = traffic(picture);

  function draw() {
    const focused = document.activeElement?.closest?.("[data-node], [data-channel]");
    const again = focused && picture.contains(focused) ? focused.dataset : null;
    picture.innerHTML = model.get("svg"); // rendered by the kit's own template, which escapes all names
    drawing = picture.querySelector("svg");
    if (!drawing) picture.append(make("p", { class: "ck-quiet" }, "No node is on the graph."));
    for (const box of picture.querySelectorAll(".ck-box")) listen(box);
    mark(null); // what was pointed at may be gone; the browser says anew where the pointer is
    legend.hidden = !picture.querySelector(".ck-uses");
    text.textContent = model.get("text");
    if (own) zoomTo(zoom);
    else fit();
    if (again) find(again)?.focus({ preventScroll: true });
  }

  function find({ node, channel, kind }) {
    const [name, value] = node ? ["node", node] : ["channel", channel];
    return picture.querySelector(`[data-${name}="${CSS.escape(value)}"][data-kind="${CSS.escape(kind)}"]`);
  }

  // Pointing at something, or reaching it with Tab, brings out what it is connected to.
  function listen(box) {
    box.addEventListener("pointerenter", () => mark(box));
    box.addEventListener("pointerleave", () => mark(null));
    box.addEventListener("focus", () => mark(box));
    box.addEventListener("blur", () => mark(null));
  }

  function mark(box) {
    panel.classList.toggle("ck-marking", Boolean(box));
    for (const use of picture.querySelectorAll(".ck-use")) {
      const of = box?.dataset.node === use.dataset.of && box.dataset.kind === "node";
      const on = box?.dataset.channel === use.dataset.on && box.dataset.kind === use.dataset.kind;
      use.classList.toggle("ck-on", Boolean(box) && (of || on));
    }
  }

  function fitting(whole) {
    const { width, height } = drawing.viewBox.baseVal;
    const wide = (picture.clientWidth - 2) / width;
    const isNarrow = picture.closest(".jp-LinkedOutputView") || picture.clientWidth < NARROW_CELL;
    const least = isNarrow ? READABLE_DOCKED : READABLE;
    return whole ? Math.min(1, wide, frameHeight() / height) : Math.max(least, Math.min(1, wide));
  }

  const frameHeight = () => parseFloat(getComputedStyle(picture).maxHeight) || window.innerHeight - AROUND;

  function fit() {
    if (!drawing || !picture.clientWidth) return;
    apply(fitting(false));
  }

  function zoomTo(value) {
    if (!drawing) return;
    own = true;
    apply(value);
  }

  function apply(value) {
    zoom = Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, value));
    drawing.setAttribute("width", drawing.viewBox.baseVal.width * zoom);
    drawing.setAttribute("height", Math.floor(drawing.viewBox.baseVal.height * zoom));
    scale.textContent = `${Math.round(100 * zoom)} %`;
  }

  const showNews = () => {
    news.textContent = model.get("ended") ? "This picture has ended. Run its cell again to go on." : model.get("news");
  };
  const showChoices = () => {
    plumbing.checked = model.get("plumbing");
  };
  const showCrossed = () => cross(model.get("crossed").hops ?? []);
  plumbing.addEventListener("change", () => {
    model.set("plumbing", plumbing.checked);
    model.save_changes();
  });
  const resized = new ResizeObserver(() => own || fit());
  resized.observe(picture);
  const told = [["change:svg change:text", draw], ["change:crossed", showCrossed],
    ["change:news change:ended", showNews], ["change:plumbing", showChoices]];
  for (const [events, act] of told) model.on(events, act);
  draw();
  showNews();
  showChoices();
  return () => {
    resized.disconnect();
    docking.close();
    for (const [events, act] of told) model.off(events, act);
  };
}

export default { render };
