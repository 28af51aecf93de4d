// Draws the ROS graph: nodes on the left, channels on the right, a line for each thing a node does with a channel.
// The boxes are ordinary page elements; only the lines are SVG, laid out by where the boxes are.

const SVG = "http://www.w3.org/2000/svg";
let views = 0;

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

function render({ model, el }) {
  const id = `ck-graph-${++views}`;
  const lines = document.createElementNS(SVG, "svg");
  lines.setAttribute("aria-hidden", "true");
  const nodes = make("ul", { class: "ck-nodes", "aria-label": "Nodes" });
  const channels = make("ul", { class: "ck-channels", "aria-label": "Services, actions and topics" });
  const picture = make("div", { class: "ck-picture" }, lines, nodes, channels);
  const checkbox = make("input", { type: "checkbox", id: `${id}-plumbing` });
  const text = make("pre", { tabindex: "0", "aria-label": "The graph as text" });
  const news = make("span", { class: "ck-quiet", role: "status", "aria-live": "polite" });
  const panel = make(
    "section",
    { class: "ck-panel ck-graph", "aria-label": "The ROS graph", "data-lm-suppress-shortcuts": "true" },
    make("div", { class: "ck-title" }, make("strong", {}, "The ROS graph"), news),
    picture,
    make("div", { class: "ck-buttons" }, checkbox,
      make("label", { for: checkbox.id }, "Show ROS's own plumbing too (parameter services, /rosout, parts of actions)")),
    make("details", {}, make("summary", {}, "The same as text"), text),
  );
  el.replaceChildren(panel);

  let edges = [];
  let marked = "";

  function draw() {
    const known = model.get("channels");
    const all = model.get("nodes");
    const focused = document.activeElement?.closest?.("[data-node], [data-channel]");
    const again = focused && picture.contains(focused) ? focused.dataset : null;
    edges = [];
    nodes.replaceChildren(
      ...(all.length ? all.map((node) => box(node, known)) : [make("li", { class: "ck-quiet" }, "No node is on the graph.")]),
    );
    channels.replaceChildren(...known.map(pill));
    for (const edge of edges) edge.pill = channels.children[edge.channel];
    text.textContent = model.get("text");
    place();
    mark("");
    if (again) find(again)?.focus();
  }

  function find({ node, channel }) {
    const [name, value] = node ? ["node", node] : ["channel", channel];
    return picture.querySelector(`[data-${name}="${CSS.escape(value)}"]`);
  }

  function box(node, known) {
    const rows = make("ul");
    const card = make("li", { class: "ck-node", tabindex: "0", "data-node": node.name },
      make("div", { class: "ck-name" }, node.name, ...(node.note ? [make("span", { class: "ck-quiet" }, ` ${node.note}`)] : [])), rows);
    for (const use of node.uses) {
      const { kind, name } = known[use.channel];
      const row = make("li", {}, make("span", {}, use.verb), make("span", { class: "ck-unseen" }, ` ${name}, ${kind}`));
      rows.append(row);
      edges.push({ ...use, node: node.name, row, kind });
    }
    if (!node.uses.length) rows.append(make("li", { class: "ck-quiet" }, "nothing yet"));
    listen(card, `node ${node.name}`);
    return card;
  }

  function pill(channel, index) {
    const card = make("li", { class: `ck-channel ck-${channel.kind}`, tabindex: "0", "data-channel": channel.name },
      make("div", {}, make("span", { class: "ck-kind" }, channel.kind), " ", make("span", { class: "ck-name" }, channel.name)),
      make("div", { class: "ck-quiet" }, channel.types.join(", ")),
      ...channel.remarks.map((remark) => make("div", { class: "ck-remark" }, `⚠ ${remark}`)));
    listen(card, `channel ${index}`);
    return card;
  }

  // Pointing at something, or reaching it with Tab, brings out what it is connected to.
  function listen(card, key) {
    card.addEventListener("pointerenter", () => mark(key));
    card.addEventListener("pointerleave", () => mark(""));
    card.addEventListener("focus", () => mark(key));
    card.addEventListener("blur", () => mark(""));
  }

  function mark(key) {
    marked = key;
    const isOn = (edge) => key === `node ${edge.node}` || key === `channel ${edge.channel}`;
    for (const edge of edges) {
      for (const part of edge.drawn ?? []) part.classList.toggle("ck-on", Boolean(marked) && isOn(edge));
    }
    panel.classList.toggle("ck-marking", Boolean(marked));
  }

  function place() {
    const frame = picture.getBoundingClientRect();
    if (!frame.width) return;
    lines.setAttribute("width", frame.width);
    lines.setAttribute("height", frame.height);
    const seats = new Map(); // how many lines end at each channel, so that they end side by side
    for (const edge of edges) seats.set(edge.channel, [...(seats.get(edge.channel) ?? []), edge]);
    const parts = [];
    for (const edge of edges) {
      const from = edge.row.closest(".ck-node").getBoundingClientRect();
      const row = edge.row.getBoundingClientRect();
      const to = edge.pill.getBoundingClientRect();
      const mates = seats.get(edge.channel);
      const share = (mates.indexOf(edge) + 1) / (mates.length + 1);
      const ends = {
        x1: from.right - frame.left,
        y1: row.top + row.height / 2 - frame.top,
        x2: to.left - frame.left,
        y2: to.top + to.height * share - frame.top,
      };
      edge.drawn = connect(edge, ends);
      parts.push(...edge.drawn);
    }
    lines.replaceChildren(...parts);
    mark(marked);
  }

  function connect({ inward, offers, kind }, { x1, y1, x2, y2 }) {
    const bend = (x2 - x1) / 2;
    const curve = shape("path", {
      d: `M ${x1 + 7} ${y1} C ${x1 + bend} ${y1}, ${x2 - bend} ${y2}, ${x2 - 7} ${y2}`,
      class: `ck-line ck-${kind}${offers ? "" : " ck-uses"}`,
    });
    // The arrow shows where what begins an exchange goes: a request, a goal, a message.
    const [x, y, way] = inward ? [x1, y1, 1] : [x2, y2, -1];
    const head = shape("path", { d: `M ${x} ${y} l ${9 * way} -5 v 10 z`, class: `ck-head ck-${kind}` });
    return [curve, head];
  }

  function shape(tag, attributes) {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    return element;
  }

  const showNews = () => {
    news.textContent = model.get("ended") ? "This picture has ended. Run its cell again to go on." : model.get("news");
  };
  const showPlumbing = () => {
    checkbox.checked = model.get("plumbing");
  };
  checkbox.addEventListener("change", () => {
    model.set("plumbing", checkbox.checked);
    model.save_changes();
  });
  const resized = new ResizeObserver(place);
  resized.observe(picture);
  model.on("change:text", draw);
  model.on("change:news change:ended", showNews);
  model.on("change:plumbing", showPlumbing);
  draw();
  showNews();
  showPlumbing();
  return () => {
    resized.disconnect();
    model.off("change:text", draw);
    model.off("change:news change:ended", showNews);
    model.off("change:plumbing", showPlumbing);
  };
}

export default { render };
