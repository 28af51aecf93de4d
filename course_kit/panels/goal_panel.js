// A goal's form, its progress and what became of it. Everything it shows comes from the model.

const MARKS = { running: "▶", good: "✔", bad: "✖", stopped: "■" };

function row([name, text]) {
  return make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, make("code", {}, text)));
}

function render({ model, el }) {
  const { name: action, type } = model.get("title");
  const ask = (what) => model.send({ values: model.get("values"), ...what });
  const form = messageForm(model, "Goal");
  const send = make("button", { type: "submit", class: "ck-main" }, "Send goal");
  const cancel = make("button", { type: "button", disabled: true }, "Cancel goal");
  const bar = make("progress", { max: 1, value: 0, "aria-label": `Progress of the goal for ${action}` });
  const share = make("span", { class: "ck-quiet" });
  const state = make("div", { class: "ck-state", role: "status" });
  const rows = make("table");
  const outcome = make("div", { class: "ck-outcome" }, state, rows);
  const box = make(
    "form",
    { class: "ck-panel ck-action", novalidate: true, autocomplete: "off", "aria-label": `Send goals to ${action}` },
    make("div", { class: "ck-title" }, make("strong", {}, action), make("code", {}, type)),
    form.fields,
    make("div", { class: "ck-buttons" }, send, cancel),
    make("div", { class: "ck-buttons ck-progress" }, bar, share),
    outcome,
  );
  // JupyterLab's one-letter shortcuts are not meant for someone who fills in a form.
  box.setAttribute("data-lm-suppress-shortcuts", "true");
  el.replaceChildren(box);

  let shownErrors = "";
  function update() {
    const view = model.get("view");
    if (view.share === null) bar.removeAttribute("value");
    else bar.value = view.share;
    share.textContent = view.progress;
    const mark = MARKS[view.tone];
    const words = mark ? `${mark} ${view.status}` : view.status;
    if (state.textContent !== words) state.textContent = words; // a screen reader reads what changes
    rows.replaceChildren(...view.rows.map(row));
    outcome.dataset.tone = view.tone;
    if (!view.running && cancel === document.activeElement) send.focus();
    cancel.disabled = !view.running;
    send.disabled = form.fields.disabled = view.ended;
    const wrong = Object.keys(view.errors).join();
    if (wrong || shownErrors) form.showErrors(view.errors, wrong !== shownErrors && box.contains(document.activeElement));
    shownErrors = wrong;
  }

  box.addEventListener("submit", (event) => {
    event.preventDefault();
    ask({ do: "send" });
  });
  cancel.addEventListener("click", () => ask({ do: "cancel" }));
  model.on("change:view", update);
  update();
  return () => {
    model.off("change:view", update);
    form.end();
  };
}

export default { render };
