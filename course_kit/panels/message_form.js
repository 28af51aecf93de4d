// Draws the form of a message: native inputs with labels, so that keyboards and screen readers know what they are.

let messageForms = 0;

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// A fieldset that follows the model's `entries` and `values`; `ask` sends what a list's buttons want.
function messageForm(model, legend, ask) {
  const id = `ck-message-${++messageForms}`;
  const idOf = (path) => `${id}-${path}`;
  const fields = make("fieldset", { class: "ck-fields" });
  const values = () => model.get("values");
  const put = (path, value) => {
    model.set("values", { ...values(), [path]: value });
    model.save_changes();
  };

  function input({ path, kind }) {
    const place = make("input", {
      id: idOf(path),
      "data-path": path,
      type: kind === "flag" ? "checkbox" : "text",
      spellcheck: "false",
      "aria-describedby": `${idOf(path)}-hint ${idOf(path)}-error`,
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

  function line(entry) {
    const hint = entry.kind === "flag" ? entry.type : `${entry.type}: ${entry.hint}`;
    return make(
      "div",
      { class: "ck-row" },
      make("label", { for: idOf(entry.path) }, entry.name),
      make(
        "div",
        { class: "ck-value" },
        input(entry),
        make("span", { class: "ck-quiet", id: `${idOf(entry.path)}-hint` }, hint),
        ...entry.choices.map((one) => choice(entry, one)),
        make("span", { class: "ck-error", id: `${idOf(entry.path)}-error` }),
      ),
    );
  }

  function choice({ path }, { name, value }) {
    const button = make("button", { type: "button", class: "ck-choice" }, `${name} = ${value}`);
    button.addEventListener("click", () => put(path, value));
    return button;
  }

  function group(entry) {
    const title = make("legend", {}, entry.name, make("span", { class: "ck-quiet" }, ` ${entry.type}`));
    const box = make("fieldset", {}, title, ...entry.fields.map(draw));
    if (entry.kind === "list" && entry.grows) box.append(growing(entry));
    return box;
  }

  function growing(entry) {
    const count = entry.fields.length;
    const button = (what, words, disabled) => {
      const made = make("button", { type: "button", disabled, "data-list": `${what} ${entry.path}` }, words);
      made.setAttribute("aria-label", `${words} ${entry.name}`);
      made.addEventListener("click", () => ask({ do: what, path: entry.path }));
      return made;
    };
    return make(
      "div",
      { class: "ck-buttons" },
      button("add", "Add one to", Boolean(entry.most) && count >= entry.most),
      button("remove", "Remove the last of", count === 0),
      make("span", { class: "ck-quiet" }, count === 0 ? "no element yet" : `${count} in the list`),
    );
  }

  function draw(entry) {
    return entry.fields ? group(entry) : line(entry);
  }

  function drawAll() {
    const entries = model.get("entries");
    const focused = document.activeElement?.getAttribute("data-list");
    const drawn = entries.length ? entries.map(draw) : [make("p", { class: "ck-quiet" }, "It has no fields.")];
    fields.replaceChildren(make("legend", {}, legend), ...drawn);
    if (focused) fields.querySelector(`[data-list="${CSS.escape(focused)}"]`)?.focus();
  }

  function takeValues() {
    for (const place of fields.querySelectorAll("[data-path]")) {
      const value = values()[place.dataset.path];
      if (place.type === "checkbox") place.checked = Boolean(value);
      else if (value !== undefined && place.value !== String(value)) place.value = value;
    }
  }

  function showErrors(errors) {
    let first = null;
    for (const place of fields.querySelectorAll("[data-path]")) {
      const reason = errors[place.dataset.path] ?? "";
      fields.querySelector(`#${CSS.escape(place.id)}-error`).textContent = reason && `✖ ${reason}`;
      if (reason) place.setAttribute("aria-invalid", "true");
      else place.removeAttribute("aria-invalid");
      if (reason && !first) first = place;
    }
    if (first && fields.closest("form")?.contains(document.activeElement)) first.focus();
  }

  model.on("change:entries", drawAll);
  model.on("change:values", takeValues);
  drawAll();
  return {
    fields,
    showErrors,
    end() {
      model.off("change:entries", drawAll);
      model.off("change:values", takeValues);
    },
  };
}
