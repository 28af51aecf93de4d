// The robot in its corridor. The picture comes from the model whole.

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
  const line = make("p", { class: "ck-outcome" });
  el.replaceChildren(make("div", { class: "ck-panel" }, frame, line));
  const update = () => {
    redraw(frame, model.get("picture"));
    line.textContent = model.get("line");
  };
  model.on("change:picture", update);
  update();
  return () => model.off("change:picture", update);
}

export default { render };
