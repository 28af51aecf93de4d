// The robot in its corridor. The picture comes from the model whole; a button only asks.

const MARKS = { running: "▶", good: "✔", bad: "✖", stopped: "■" };

// Put a new picture in place, with the robot driving there from where it was.
function redraw(frame, picture) {
  const before = frame.querySelector(".ck-robot")?.style.transform;
  frame.innerHTML = picture;
  const robot = frame.querySelector(".ck-robot");
  if (!robot || !before) return;
  const there = robot.style.transform;
  robot.style.transform = before;
  robot.getBoundingClientRect(); // else the browser sees only the second of the two
  robot.style.transform = there;
}

function render({ model, el }) {
  const frame = make("div");
  const rooms = make("div", { class: "ck-buttons", role: "group", "aria-label": "Deliver to" });
  const cancel = make("button", { type: "button" }, "Cancel goal");
  const outcome = make("p", { class: "ck-outcome" });
  const said = make("p", { class: "ck-said", role: "status" }); // for screen readers: not ten times a second
  const box = make("div", { class: "ck-panel" }, frame, rooms, outcome, said);
  box.setAttribute("data-lm-suppress-shortcuts", "true"); // JupyterLab's one-letter shortcuts
  el.replaceChildren(box);

  const drawRooms = () => {
    const buttons = model.get("rooms").map((room) => {
      const button = make("button", { type: "button" }, room);
      button.addEventListener("click", () => model.send({ do: "go", room }));
      return button;
    });
    rooms.replaceChildren("Deliver to ", ...buttons, cancel);
  };
  cancel.addEventListener("click", () => model.send({ do: "cancel" }));
  const update = () => {
    const view = model.get("view");
    redraw(frame, view.picture);
    outcome.textContent = MARKS[view.tone] ? `${MARKS[view.tone]} ${view.line}` : view.line;
    outcome.dataset.tone = view.tone;
    if (said.textContent !== view.said) said.textContent = view.said;
    for (const button of rooms.querySelectorAll("button")) button.disabled = view.ended;
    cancel.disabled = !view.running;
  };
  const both = () => {
    drawRooms();
    update();
  };
  model.on("change:rooms", both);
  model.on("change:view", update);
  both();
  return () => {
    model.off("change:rooms", both);
    model.off("change:view", update);
  };
}

export default { render };
