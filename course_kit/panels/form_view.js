// A form that calls a service. Everything it shows comes from the model; needs message_form.js in front of it.

const WORDS = {
  waiting: "… Waiting",
  answered: "✔ Response",
  failed: "✖ No response",
  invalid: "✖ Not sent",
};

function responseTable(rows, comments) {
  const table = make("table", { "aria-label": "Response" });
  for (const [name, value] of rows) {
    const said = make("td", {}, make("code", {}, value));
    if (comments[name]) said.append(make("span", { class: "ck-quiet" }, ` · ${comments[name]}`));
    table.append(make("tr", {}, make("th", { scope: "row" }, name), said));
  }
  return table;
}

function render({ model, el }) {
  const { name: service, type } = model.get("title");
  const ask = (what) => model.send({ values: model.get("values"), ...what });
  const request = messageForm(model, "Request");
  const send = make("button", { type: "submit", class: "ck-main" }, "Send request");
  const ended = make("p", { class: "ck-note", hidden: true });
  const outcome = make("div", { class: "ck-outcome", role: "status", "aria-live": "polite" });
  const form = make(
    "form",
    { class: "ck-panel ck-form", novalidate: true, autocomplete: "off", "aria-label": `Call ${service}` },
    make("div", { class: "ck-title" }, make("strong", {}, service), make("code", {}, type)),
    request.fields,
    make("div", { class: "ck-buttons" }, send, make("span", { class: "ck-quiet" }, "or press Enter in a field")),
    ended,
    outcome,
  );
  // JupyterLab's one-letter shortcuts are not meant for someone who fills in a form.
  form.setAttribute("data-lm-suppress-shortcuts", "true");
  el.replaceChildren(form);

  function showOutcome(move) {
    const { state, text, rows = [], comments = {}, errors = {}, printed = "" } = model.get("outcome");
    const parts = [];
    if (WORDS[state]) parts.push(make("div", { class: "ck-state" }, WORDS[state]));
    if (text && state !== "waiting") parts.push(make("p", {}, text));
    if (rows.length) parts.push(responseTable(rows, comments));
    if (printed) {
      parts.push(make("div", { class: "ck-quiet" }, "Printed meanwhile:"), make("pre", {}, printed));
    }
    outcome.dataset.state = state;
    outcome.replaceChildren(...parts);
    request.showErrors(errors, move);
  }

  function showEnd() {
    const why = model.get("ended");
    ended.hidden = !why;
    ended.textContent = why;
    request.fields.disabled = send.disabled = Boolean(why);
  }

  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (model.get("ended")) return;
    // A kernel that runs a cell takes the wish only then; what stands here is about another request.
    outcome.dataset.state = "waiting";
    outcome.replaceChildren(make("div", { class: "ck-state" }, WORDS.waiting));
    ask({ do: "send" });
  });
  const whenAnswered = () => showOutcome(form.contains(document.activeElement));
  model.on("change:outcome", whenAnswered);
  model.on("change:ended", showEnd);
  showOutcome(false);
  showEnd();
  return () => {
    request.end();
    model.off("change:outcome", whenAnswered);
    model.off("change:ended", showEnd);
  };
}

export default { render };
