// Follows the projected page, which is in the same browser, and can tell it what to do. It sends nothing anywhere else.
"use strict";
const channel = new BroadcastChannel("course-kit-presentation");
const by = (id) => document.getElementById(id);
const cells = [...document.querySelectorAll(".notes")];
const openers = [...document.querySelectorAll(".open")];
const SILENT_MS = 4000;
let state = null;
let heard = 0;

const send = (type, more) => channel.postMessage({ type, ...more });

function clock(milliseconds) {
  const seconds = Math.max(0, Math.floor(milliseconds / 1000));
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, "0")}`;
}

function label(element, cell, otherwise) {
  element.textContent = cell ? cell.dataset.label : otherwise;
  element.classList.toggle("code", Boolean(cell) && cell.dataset.kind !== "markdown");
}

// What is said of a cell, or of the last one before it that has notes. Once the repair is in place it is what is spoken of.
function notesAt(mine, position) {
  const repair = mine.findIndex((cell) => cell.dataset.kind === "repair");
  const upTo = mine.slice(0, Math.max(position, state.repaired ? repair : -1) + 1);
  const told = upTo.filter((cell) => state.repaired || cell.dataset.kind !== "repair");
  return told.reverse().find((cell) => cell.textContent.trim()) ?? null;
}

function show() {
  const mine = cells.filter((cell) => cell.dataset.path === state.path);
  const opener = openers.find((one) => one.dataset.path === state.path);
  const position = mine.findIndex((cell) => cell.dataset.cell === state.here);
  const repair = mine.find((cell) => cell.dataset.kind === "repair");
  const next = mine.find((cell) => cell.dataset.cell === state.next);
  const spoken = notesAt(mine, position);
  by("title").textContent = opener ? opener.dataset.title : state.path;
  document.title = `Notes: ${by("title").textContent}`;
  label(by("now"), mine[position], "");
  cells.forEach((cell) => {
    cell.hidden = cell !== spoken;
  });
  const after = openers[openers.indexOf(opener) + 1];
  if (next) {
    label(by("next"), next, "");
    by("step").textContent = state.isRun ? "Show it" : "Run it";
  } else if (repair && !state.repaired) {
    label(by("next"), null, "Put the repair in place, and run it.");
    by("step").textContent = "Repair";
  } else {
    label(by("next"), null, after ? `The end. Then: ${after.dataset.title}` : "The end.");
  }
  by("step").hidden = !next && !(repair && !state.repaired);
  by("step").disabled = state.busy;
  by("repair").hidden = !repair || !state.repaired;
  by("repair").textContent = "Undo the repair";
  by("repair").disabled = !state.canRepair;
  openers.forEach((one) => {
    if (one === opener) {
      one.setAttribute("aria-current", "page");
    } else {
      one.removeAttribute("aria-current");
    }
  });
  by("planned").textContent = Number(opener?.dataset.minutes) ? `of ${opener.dataset.minutes}:00` : "";
  tick();
}

function tick() {
  const now = new Date();
  by("clock").textContent = now.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  const isThere = state !== null && Date.now() - heard < SILENT_MS;
  by("lost").hidden = isThere;
  for (const id of ["step", "repair", "time", "again"]) {
    by(id).disabled = !isThere || (by(id).disabled && id !== "time" && id !== "again");
  }
  openers.forEach((one) => {
    one.disabled = !isThere;
  });
  if (isThere) {
    const passed = Date.now() - state.began;
    const planned = Number(openers.find((one) => one.dataset.path === state.path)?.dataset.minutes) * 60_000;
    by("elapsed").textContent = clock(passed);
    document.body.classList.toggle("over", Boolean(planned) && passed > planned);
  }
}

channel.onmessage = ({ data }) => {
  if (data.type === "state") {
    state = data;
    heard = Date.now();
    show();
  } else if (data.type === "gone") {
    heard = 0;
    tick();
  }
};
by("step").addEventListener("click", () => send("step"));
by("repair").addEventListener("click", () => send("repair"));
by("time").addEventListener("click", () => send("time"));
by("again").addEventListener("click", () => send("open", { path: state.path }));
openers.forEach((one) => one.addEventListener("click", () => send("open", { path: one.dataset.path })));
setInterval(() => {
  send("hello");
  tick();
}, 1000);
send("hello");
tick();
