// Questions of a lesson as forms of the browser's own parts, so that keyboard and screen reader work as everywhere.
// The arrow keys only move between the choices; the button, or Enter, makes one of them the guess. What is right is
// known to the kernel only, until then. Several questions come one after the other, so that a page is never tall at once.

let forms = 0;

function marked(text) {
  return text.split("`").map((part, place) => (place % 2 ? make("code", {}, part) : part));
}

function verdictOf(answer, choices) {
  const right = answer.chosen === answer.right;
  const verdict = make("p", {}, make("strong", {}, right ? "✓ Right. " : "✗ Not quite. "), ...marked(answer.why));
  const parts = [verdict];
  if (!right && answer.right >= 0) {
    const text = choices[answer.right];
    parts.push(make("p", {}, make("strong", {}, "The answer: "), ...marked(text), /[.?!`]$/.test(text) ? " " : ". "));
    parts[1].append(...marked(answer.why_right));
  }
  return parts;
}

function markOf(answer, place, yours) {
  if (!answer) return "";
  if (place === answer.right) return place === answer.chosen ? `✓ ${yours}, right` : "✓ right";
  return place === answer.chosen ? `✗ ${yours}` : "";
}

function formOf(model, question, number, count) {
  const prefix = `course-kit-guess-${(forms += 1)}`;
  const title = count > 1 ? `${number} of ${count}` : question.title;
  const suppressed = { "data-lm-suppress-shortcuts": true }; // or the notebook takes the arrow keys and Enter
  const rows = question.choices.map((text, place) => {
    const radio = make("input", { type: "radio", name: prefix, value: place, ...suppressed });
    const mark = make("span", { class: "ck-guess-mark" });
    const label = make("label", {}, radio, make("span", {}, ...marked(text)), mark);
    radio.addEventListener("change", () => {
      send.disabled = false;
    });
    return { radio, mark, label, place };
  });
  const send = make("button", { type: "submit", class: "ck-guess-send", ...suppressed }, count > 1 ? "Check" : "This is my guess");
  const again = make("button", { type: "button", class: "ck-guess-again", ...suppressed }, "Try again");
  const verdict = make("div", { class: "ck-guess-verdict", role: "status", tabindex: "-1", ...suppressed });
  const form = make(
    "form",
    suppressed,
    make(
      "fieldset",
      {},
      make("legend", {}, make("span", { class: "ck-guess-title" }, title), make("span", {}, ...marked(question.text))),
      ...rows.map(({ label }) => label),
    ),
    make("div", { class: "ck-guess-buttons" }, send),
    verdict,
    again,
  );
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const chosen = rows.find(({ radio }) => radio.checked);
    if (chosen && !send.hidden) {
      moved = true;
      taken = false;
      model.send({ name: question.name, place: chosen.place });
      if (chosen.place === model.get("answers")[question.name]?.chosen) refresh();
    }
  });
  again.addEventListener("click", () => {
    moved = taken = true;
    refresh();
  });

  let moved = false; // whether this form's own button was used, so that the focus goes on from there
  let taken = false; // whether the answer is hidden here, to try once more; what was chosen first still counts
  let shown = null;
  function refresh() {
    const answer = taken ? undefined : model.get("answers")[question.name];
    const words = JSON.stringify(answer ?? null);
    if (words === shown) return;
    shown = words;
    for (const { radio, mark, label, place } of rows) {
      const said = markOf(answer, place, count > 1 ? "your answer" : "your guess");
      radio.checked = answer ? place === answer.chosen : false;
      radio.disabled = Boolean(answer);
      mark.textContent = said;
      label.dataset.mark = said ? said[0] : "";
    }
    send.hidden = Boolean(answer);
    send.disabled = true;
    again.hidden = !answer;
    verdict.hidden = !answer;
    verdict.dataset.right = Boolean(answer) && answer.chosen === answer.right;
    verdict.replaceChildren(...(answer ? verdictOf(answer, question.choices) : []));
    if (moved) (answer ? verdict : rows[0].radio).focus();
    moved = false;
  }
  return { form, refresh };
}

function render({ model, el }) {
  const questions = model.get("questions");
  const all = questions.map((question, place) => formOf(model, question, place + 1, questions.length));
  const summary = make("p", { role: "status", class: "ck-guess-summary" });
  const name = questions.length > 1 ? "Check yourself" : questions[0].title;
  el.append(make("section", { class: "ck-panel ck-guess", "aria-label": name }, ...all.map(({ form }) => form), summary));
  function refresh() {
    const done = Object.keys(model.get("answers")).length;
    all.forEach(({ form, refresh: show }, place) => {
      show();
      form.hidden = place > done;
    });
    summary.textContent = model.get("summary");
    summary.hidden = !summary.textContent;
  }
  refresh();
  model.on("change:answers", refresh);
  model.on("change:summary", refresh);
  return () => model.off(null, refresh);
}

export default { render };
