// Draws the form of a message: native inputs with labels, so that keyboards and screen readers know what they are.

let messageForms = 0;

// A notebook keeps Enter from submitting a form, which a browser would do by itself.
function submitOnEnter(fields) {
  fields.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || event.target.tagName !== "INPUT" || event.isComposing) return;
    event.preventDefault();
    event.target.form.requestSubmit();
  });
}

// A fieldset with the model's `entries`, which follows its `values`.
function messageForm(model, title) {
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
    const expected = entry.kind === "flag" ? entry.type : `${entry.type}: ${entry.hint}`;
    const hint = entry.comment ? `${expected} · ${entry.comment}` : expected;
    const value = make(
      "div",
      { class: "ck-value" },
      input(entry),
      make("span", { class: "ck-quiet", id: `${idOf(entry.path)}-hint` }, hint),
    );
    if (entry.choices.length) value.append(choices(entry));
    value.append(make("span", { class: "ck-error", id: `${idOf(entry.path)}-error` }));
    return make("div", { class: "ck-row" }, make("label", { for: idOf(entry.path) }, entry.name), value);
  }

  function choices(entry) {
    const group = make("div", { class: "ck-choices", role: "group", "aria-label": `Constants for ${entry.name}` });
    for (const { name, value } of entry.choices) {
      const attributes = { type: "button", class: "ck-choice", "data-for": entry.path, "data-value": value };
      const button = make("button", attributes, `${name} = ${value}`);
      button.addEventListener("click", () => put(entry.path, value));
      group.append(button);
    }
    return group;
  }

  function group(entry) {
    const about = entry.comment ? ` ${entry.type} · ${entry.comment}` : ` ${entry.type}`;
    const legend = make("legend", {}, entry.name, make("span", { class: "ck-quiet" }, about));
    return make("fieldset", {}, legend, ...entry.fields.map(draw));
  }

  function draw(entry) {
    return entry.fields ? group(entry) : line(entry);
  }

  function drawAll() {
    const entries = model.get("entries");
    const nothing = make("p", { class: "ck-quiet" }, `This ${title.toLowerCase()} has no fields.`);
    fields.replaceChildren(make("legend", {}, title), ...(entries.length ? entries.map(draw) : [nothing]));
    markChoices();
  }

  function markChoices() {
    for (const button of fields.querySelectorAll(".ck-choice")) {
      button.setAttribute("aria-pressed", String(values()[button.dataset.for] === button.dataset.value));
    }
  }

  function takeValues() {
    for (const place of fields.querySelectorAll("[data-path]")) {
      const value = values()[place.dataset.path];
      if (place.type === "checkbox") place.checked = Boolean(value);
      else if (value !== undefined && place.value !== String(value)) place.value = value;
    }
    markChoices();
  }

  // Puts the reasons beside their fields; `move` takes the focus to the first.
  function showErrors(errors, move) {
    let first = null;
    for (const place of fields.querySelectorAll("[data-path]")) {
      const reason = errors[place.dataset.path] ?? "";
      fields.querySelector(`#${CSS.escape(place.id)}-error`).textContent = reason && `✖ ${reason}`;
      if (reason) place.setAttribute("aria-invalid", "true");
      else place.removeAttribute("aria-invalid");
      if (reason && !first) first = place;
    }
    if (move) first?.focus();
  }

  submitOnEnter(fields);
  model.on("change:values", takeValues);
  drawAll();
  return {
    fields,
    showErrors,
    end() {
      model.off("change:values", takeValues);
    },
  };
}
