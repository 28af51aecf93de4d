// Draws the form of a service: native inputs with labels, so that keyboards and screen readers know what they are.

let forms = 0;

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

function render({ model, el }) {
  const id = `ck-form-${++forms}`;
  const idOf = (path) => `${id}-${path}`;
  const { service, type } = model.get("title");
  const fields = make("fieldset", { class: "ck-fields" });
  const send = make("button", { type: "submit", class: "ck-main" }, "Send request");
  const ended = make("p", { class: "ck-note", hidden: true });
  const outcome = make("div", { class: "ck-outcome", role: "status", "aria-live": "polite" });
  const form = make(
    "form",
    { class: "ck-panel ck-form", novalidate: true, autocomplete: "off", "aria-label": `Call ${service}` },
    make("div", { class: "ck-title" }, make("strong", {}, service), make("code", {}, type)),
    fields,
    make("div", { class: "ck-buttons" }, send, make("span", { class: "ck-quiet" }, "or press Enter in a field")),
    ended,
    outcome,
  );
  // JupyterLab's one-letter shortcuts are not meant for someone who fills in a form.
  form.setAttribute("data-lm-suppress-shortcuts", "true");
  el.replaceChildren(form);

  const values = () => model.get("values");
  const put = (path, value) => {
    model.set("values", { ...values(), [path]: value });
    model.save_changes();
  };
  const ask = (what) => model.send({ values: values(), ...what });

  function describedBy(path) {
    return `${idOf(path)}-hint ${idOf(path)}-error`;
  }

  function input(entry) {
    const { path, kind } = entry;
    const place = make("input", {
      id: idOf(path),
      "data-path": path,
      type: kind === "flag" ? "checkbox" : "text",
      spellcheck: "false",
      "aria-describedby": describedBy(path),
    });
    if (kind === "flag") {
      place.checked = Boolean(values()[path]);
      place.addEventListener("change", () => put(path, place.checked));
    } else {
      place.value = values()[path] ?? "";
      place.addEventListener("input", () => put(path, place.value));
    }
    return place;
  }

  function choice(entry, { name, value }) {
    const button = make(
      "button",
      { type: "button", class: "ck-choice", "data-for": entry.path, "data-value": value },
      `${name} = ${value}`,
    );
    button.addEventListener("click", () => {
      form.querySelector(`[data-path="${CSS.escape(entry.path)}"]`).value = value;
      put(entry.path, value);
      markChoices();
    });
    return button;
  }

  function line(entry) {
    const row = make(
      "div",
      { class: "ck-row" },
      make("label", { for: idOf(entry.path) }, entry.name),
      make(
        "div",
        { class: "ck-value" },
        input(entry),
        make("span", { class: "ck-quiet", id: `${idOf(entry.path)}-hint` }, hint(entry)),
      ),
    );
    if (entry.choices.length) {
      const offered = make("div", { class: "ck-choices", role: "group", "aria-label": `Constants for ${entry.name}` });
      offered.append(...entry.choices.map((one) => choice(entry, one)));
      row.lastChild.append(offered);
    }
    row.lastChild.append(make("span", { class: "ck-error", id: `${idOf(entry.path)}-error` }));
    return row;
  }

  function hint(entry) {
    return entry.kind === "flag" ? entry.type : `${entry.type}: ${entry.hint}`;
  }

  function group(entry) {
    const box = make("fieldset", {}, make("legend", {}, entry.name, make("span", { class: "ck-quiet" }, ` ${entry.type}`)));
    box.append(...entry.fields.map(draw));
    if (entry.kind === "list" && entry.grows) {
      const button = (what, short, words, off) => {
        const made = make(
          "button",
          { type: "button", disabled: off, "data-list": `${what} ${entry.path}`, "aria-label": `${words} ${entry.name}` },
          short,
        );
        made.addEventListener("click", () => ask({ do: what, path: entry.path }));
        return made;
      };
      const count = entry.fields.length;
      box.append(
        make("div", { class: "ck-buttons" },
          button("add", "Add", "Add one to", Boolean(entry.most) && count >= entry.most),
          button("remove", "Remove last", "Remove the last of", count === 0),
          make("span", { class: "ck-quiet" }, count === 0 ? "no element yet" : `${count} in the list`)),
      );
    }
    return box;
  }

  function draw(entry) {
    return entry.fields ? group(entry) : line(entry);
  }

  function drawFields() {
    const entries = model.get("entries");
    const focused = document.activeElement?.getAttribute("data-list");
    fields.replaceChildren(
      make("legend", {}, "Request"),
      ...(entries.length ? entries.map(draw) : [make("p", { class: "ck-quiet" }, "This request has no fields.")]),
    );
    markChoices();
    if (focused) fields.querySelector(`[data-list="${CSS.escape(focused)}"]`)?.focus();
  }

  function markChoices() {
    for (const button of form.querySelectorAll(".ck-choice")) {
      button.setAttribute("aria-pressed", String(values()[button.dataset.for] === button.dataset.value));
    }
  }

  function takeValues() {
    for (const place of form.querySelectorAll("[data-path]")) {
      const value = values()[place.dataset.path];
      if (place.type === "checkbox") place.checked = Boolean(value);
      else if (value !== undefined && place.value !== String(value)) place.value = value;
    }
    markChoices();
  }

  function showErrors(errors, move) {
    let first = null;
    for (const place of form.querySelectorAll("[data-path]")) {
      const reason = errors[place.dataset.path] ?? "";
      document.getElementById(`${place.id}-error`).textContent = reason && `✖ ${reason}`;
      if (reason) place.setAttribute("aria-invalid", "true");
      else place.removeAttribute("aria-invalid");
      if (reason && !first) first = place;
    }
    if (move) first?.focus();
  }

  const WORDS = {
    waiting: "… Waiting",
    answered: "✔ Response",
    failed: "✖ No response",
    invalid: "✖ Not sent",
  };

  function showOutcome(move) {
    const { state, text, rows = [], errors = {}, printed = "", exchange = "" } = model.get("outcome");
    const parts = [];
    if (WORDS[state]) parts.push(make("div", { class: "ck-state" }, WORDS[state]));
    if (text && state !== "waiting") parts.push(make("p", {}, text));
    if (rows.length) {
      const table = make("table", { "aria-label": "Response" });
      for (const [name, value] of rows) {
        table.append(make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, make("code", {}, value))));
      }
      parts.push(table);
    }
    if (printed) {
      parts.push(make("div", { class: "ck-quiet" }, "Printed meanwhile:"), make("pre", {}, printed));
    }
    if (exchange) {
      parts.push(make("div", { class: "ck-quiet" }, "What crossed between the nodes:"), make("pre", {}, exchange));
    }
    outcome.dataset.state = state;
    outcome.replaceChildren(...parts);
    showErrors(errors, move);
  }

  function showEnd() {
    const why = model.get("ended");
    ended.hidden = !why;
    ended.textContent = why;
    fields.disabled = send.disabled = Boolean(why);
  }

  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (!model.get("ended")) ask({ do: "send" });
  });
  // Notebooks keep a browser from doing this by itself.
  fields.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.target.tagName !== "INPUT" || event.isComposing) return;
    event.preventDefault();
    form.requestSubmit(send);
  });
  const whenAnswered = () => showOutcome(form.contains(document.activeElement));
  model.on("change:entries", drawFields);
  model.on("change:values", takeValues);
  model.on("change:outcome", whenAnswered);
  model.on("change:ended", showEnd);
  drawFields();
  showOutcome(false);
  showEnd();
  return () => {
    model.off("change:entries", drawFields);
    model.off("change:values", takeValues);
    model.off("change:outcome", whenAnswered);
    model.off("change:ended", showEnd);
  };
}

export default { render };
