// Draws the parameters of a node: native inputs with labels, so that keyboards and screen readers know what they are.

let panels = 0;

// A number as short as it can be written, without the noise of binary fractions.
function tidy(number, type) {
  if (type === "integer") return String(Math.round(number));
  const text = String(Number(number.toPrecision(12)));
  return /[.e]/.test(text) ? text : `${text}.0`;
}

function render({ model, el }) {
  const id = `ck-params-${++panels}`;
  const rows = new Map();
  const list = make("div", { class: "ck-params-list" });
  const ended = make("p", { class: "ck-params-ended", hidden: true });
  const panel = make(
    "section",
    { class: "ck-params", "aria-label": `Parameters of ${model.get("node")}` },
    make("header", {}, make("strong", {}, model.get("node")), make("span", {}, "parameters, set while the node runs")),
    list,
    ended,
  );
  // JupyterLab's one-letter shortcuts are not meant for someone who types a value.
  panel.setAttribute("data-lm-suppress-shortcuts", "true");
  el.replaceChildren(panel);
  let token = 0;

  // One wish at a time for each parameter; whatever was moved meanwhile is sent when the answer is there.
  function wish(row, value) {
    row.wanted = { value };
    send(row);
  }

  function send(row) {
    if (row.sent || !row.wanted) return;
    row.sent = token = Math.max(token + 1, Date.now()); // grows over all views of this widget
    row.status.dataset.state = "waiting";
    const { value } = row.wanted;
    row.wanted = null;
    model.send({ name: row.entry.name, value, token: row.sent });
  }

  function makeRow(entry, number) {
    const key = `${id}-${number}`;
    const row = { entry, sent: 0, wanted: null };
    const off = entry.note !== "";
    const about = `${key}-about ${key}-status`;
    const common = { "aria-describedby": about, disabled: off, "data-parameter": entry.name };
    row.inputs = [];
    const place = make("div", { class: "ck-params-place" });
    if (entry.kind === "slider") {
      const { lowest: min, highest: max, step } = entry;
      const slider = make("input", { id: key, type: "range", min, max, step, ...common });
      slider.addEventListener("input", () => {
        const text = tidy(slider.valueAsNumber, entry.type);
        row.box.value = text;
        slider.setAttribute("aria-valuetext", text);
        wish(row, text);
      });
      row.slider = slider;
      place.append(slider);
    }
    if (entry.kind === "flag") {
      row.flag = make("input", { id: key, type: "checkbox", ...common });
      row.flag.addEventListener("change", () => wish(row, row.flag.checked));
      row.word = make("span", { class: "ck-params-word", "aria-hidden": "true" });
      place.append(row.flag, row.word);
    } else {
      const numeric = entry.kind !== "text";
      const boxKey = row.slider ? `${key}-box` : key;
      const label = row.slider ? `${entry.name}, typed` : undefined;
      const kind = numeric ? { class: "ck-params-number", inputmode: "decimal" } : { class: "ck-params-text" };
      row.box = make("input", { id: boxKey, type: "text", spellcheck: "false", "aria-label": label, ...kind, ...common });
      // Enter does not end an input's change inside JupyterLab, so both ways to be done with it are listened to.
      const done = () => {
        if (row.box.value !== row.shown && row.box.value !== row.asked) {
          row.asked = row.box.value;
          wish(row, row.asked);
        }
      };
      row.box.addEventListener("change", done);
      row.box.addEventListener("keydown", (event) => {
        if (event.key === "Enter") done();
        if (event.key === "Escape") row.box.value = row.shown;
      });
      place.append(row.box);
    }
    const facts = [entry.type, entry.limits].filter(Boolean).join(", ");
    row.status = make("span", { id: `${key}-status`, class: "ck-params-status", role: "status", "aria-live": "polite" });
    place.append(row.status);
    const about2 = make("div", { id: `${key}-about`, class: "ck-params-about" }, make("span", {}, facts));
    if (entry.description) about2.append(make("span", {}, entry.description));
    if (off) about2.append(make("em", {}, entry.note));
    row.element = make(
      "div",
      { class: "ck-params-row", "data-name": entry.name },
      make("label", { for: key }, entry.name),
      place,
      about2,
    );
    return row;
  }

  function drawEntries() {
    rows.clear();
    list.replaceChildren();
    model.get("entries").forEach((entry, number) => {
      const row = makeRow(entry, number);
      rows.set(entry.name, row);
      list.append(row.element);
    });
    if (!rows.size) list.append(make("p", {}, "This node has declared no parameters of its own."));
  }

  function put(row, value) {
    if (row.flag) {
      row.flag.checked = value === true;
      row.word.textContent = value === true ? "true" : "false";
      return;
    }
    const types = document.activeElement === row.box && ![row.shown, row.asked].includes(row.box.value);
    if (!types) row.box.value = value; // what is being typed stays
    row.shown = value;
    if (row.slider) {
      row.slider.value = value;
      row.slider.setAttribute("aria-valuetext", value);
    }
  }

  function words(outcome, value) {
    if (outcome.state === "refused") return `✗ refused: ${outcome.text.replace(/\.$/, "")}. It stays ${value}.`;
    if (outcome.state === "failed") return `✗ not set: ${outcome.text}`;
    if (outcome.state === "set") return "✓ set";
    return outcome.state === "elsewhere" ? "↻ changed elsewhere" : "";
  }

  function refresh() {
    const values = model.get("values");
    const outcomes = model.get("outcomes");
    for (const [name, row] of rows) {
      const outcome = outcomes[name] ?? { state: "", text: "", token: 0 };
      if (row.sent && outcome.token < row.sent) continue; // its answer is still to come
      row.sent = 0;
      if (row.wanted) {
        send(row);
        continue;
      }
      put(row, values[name]);
      row.asked = undefined;
      row.status.dataset.state = outcome.state;
      const text = words(outcome, values[name] === "" ? "empty" : String(values[name]));
      if (row.status.textContent !== text) row.status.textContent = text;
    }
  }

  function refreshEnd() {
    ended.textContent = model.get("ended");
    ended.hidden = !model.get("ended");
    panel.querySelectorAll("input").forEach((input) => {
      if (model.get("ended")) input.disabled = true;
    });
  }

  function drawAll() {
    drawEntries();
    refresh();
    refreshEnd();
  }

  drawAll();
  const listeners = { "change:entries": drawAll, "change:values": refresh, "change:outcomes": refresh };
  listeners["change:ended"] = refreshEnd;
  for (const [event, listener] of Object.entries(listeners)) model.on(event, listener);
  return () => {
    for (const [event, listener] of Object.entries(listeners)) model.off(event, listener);
  };
}

export default { render };
