// The quiz as a form of the browser's own parts, so that keyboard and screen reader work as everywhere: fieldsets,
// radio buttons, buttons, and regions that are read out when they change. What is right is known to the kernel only.

const HALVES = ["pattern", "reason"];
const QUESTIONS = { pattern: "Which pattern fits best?", reason: "Which reason decides?" };
let panels = 0;

function made(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  // Or the notebook takes the arrow keys and Enter; it asks the element that has the focus, so each one has to say so.
  element.setAttribute("data-lm-suppress-shortcuts", "true");
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role") element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children);
  return element;
}

function pairOf(model, id) {
  return model.get("choices")[id] ?? ["", ""];
}

function choose(model, id, half, value) {
  const pair = [...pairOf(model, id)];
  pair[HALVES.indexOf(half)] = value;
  model.set("choices", { ...model.get("choices"), [id]: pair });
  model.save_changes();
}

function radios(model, prefix, question, half, options) {
  const chosen = pairOf(model, question.id)[HALVES.indexOf(half)];
  const labels = options.map(([value, text]) => {
    const radio = made("input", { type: "radio", name: `${prefix}-${half}`, value, checked: value === chosen });
    radio.addEventListener("change", () => choose(model, question.id, half, value));
    return made("label", {}, radio, made("span", {}, text));
  });
  const places = made("div", { className: half === "pattern" ? "in-a-row" : "" }, ...labels);
  return made("fieldset", {}, made("legend", {}, QUESTIONS[half]), places);
}

function stateOf(model, id) {
  const marks = model.get("marks")[id];
  if (marks) {
    const right = HALVES.filter((half) => marks[half].right).length;
    return [["✗", "wrong"], ["½", "half right"], ["✓", "right"]][right];
  }
  return pairOf(model, id).every(Boolean) ? ["●", "answered"] : ["", "open"];
}

function markOf(half, mark) {
  const verdict = `${half === "pattern" ? "Pattern" : "Reason"}: ${mark.right ? "✓ right" : "✗ not right"}.`;
  const sort = mark.right ? "right" : "wrong";
  return made("p", { className: `mark ${sort}` }, made("strong", {}, verdict), ` ${mark.explanation}`);
}

function marksOf(marks) {
  if (!marks) return [];
  const { pattern, reason } = marks;
  if (pattern.right === reason.right && pattern.explanation === reason.explanation) {
    const both = { ...pattern };
    const shown = markOf("pattern", both);
    shown.firstChild.textContent = `Pattern and reason: ${both.right ? "✓ right" : "✗ not right"}.`;
    return [shown];
  }
  return HALVES.map((half) => markOf(half, marks[half]));
}

function button(text, act, properties = {}) {
  const element = made("button", { type: "button", textContent: text, ...properties });
  element.addEventListener("click", act);
  return element;
}

function render({ model, el }) {
  const prefix = `course-kit-quiz-${(panels += 1)}`;
  const questions = model.get("questions");
  let place = 0;

  const progress = made("p", { role: "status", "aria-live": "polite", className: "progress-text" });
  const bar = made("progress", { max: questions.length, "aria-label": "Scenarios answered" });
  const steps = questions.map((_, index) => button("", () => go(index)));
  const nav = made("nav", { className: "row", "aria-label": "Scenarios" }, ...steps);
  const card = made("div", { className: "scenario" });
  const marks = made("div", { role: "status", "aria-live": "polite", className: "marks" });
  const back = button("Previous", () => go(place - 1));
  const next = button("Next", () => go(place + 1));
  const again = button("Start again", () => {
    if (window.confirm("Clear all your choices?")) model.send({ do: "reset" });
  });
  const name = made("input", { type: "text", spellcheck: false, "aria-label": "Name of the file" });
  name.addEventListener("change", () => {
    model.set("file_name", name.value);
    model.save_changes();
  });
  const write = button("Write my answers to a file", () => model.send({ do: "write", name: name.value }));
  const said = made("p", { role: "status", "aria-live": "polite", className: "said" });

  function go(index) {
    place = index;
    drawCard();
    refresh();
    card.querySelector("h3").focus();
  }

  function drawCard() {
    const question = questions[place];
    const title = `Scenario ${place + 1} of ${questions.length}: ${question.title}`;
    card.replaceChildren(
      made("h3", { tabIndex: -1, textContent: title }),
      made("p", { textContent: question.text }),
      radios(model, prefix, question, "pattern", model.get("patterns").map((pattern) => [pattern, pattern])),
      radios(model, prefix, question, "reason", question.reasons),
    );
  }

  function refreshChecks() {
    const pair = pairOf(model, questions[place].id);
    for (const radio of card.querySelectorAll("input")) {
      radio.checked = radio.value === pair[radio.name.endsWith("-pattern") ? 0 : 1];
    }
  }

  function refresh() {
    steps.forEach((step, index) => {
      const [sign, word] = stateOf(model, questions[index].id);
      step.textContent = `${index + 1}${sign && ` ${sign}`}`;
      step.setAttribute("aria-label", `Scenario ${index + 1}, ${word}`);
      if (index === place) step.setAttribute("aria-current", "step");
      else step.removeAttribute("aria-current");
    });
    back.disabled = place === 0;
    next.disabled = place === questions.length - 1;
    bar.value = questions.filter(({ id }) => pairOf(model, id).every(Boolean)).length;
    if (progress.textContent !== model.get("summary")) progress.textContent = model.get("summary");
    marks.replaceChildren(...marksOf(model.get("marks")[questions[place].id]));
    if (name !== document.activeElement) name.value = model.get("file_name");
    if (said.textContent !== model.get("said")) said.textContent = model.get("said");
  }

  function changed() {
    refreshChecks();
    refresh();
  }

  el.append(
    made(
      "section",
      {
        className: "course-kit-quiz-panel",
        "aria-label": "Quiz: which communication pattern fits?",
      },
      progress,
      bar,
      nav,
      card,
      marks,
      made("div", { className: "row" }, back, next, again),
      made("div", { className: "row" }, made("label", {}, "File: ", name), write),
      said,
    ),
  );
  drawCard();
  refresh();
  for (const trait of ["choices", "marks", "summary", "file_name", "said"]) {
    model.on(`change:${trait}`, changed);
  }
  return () => model.off(null, changed);
}

export default { render };
