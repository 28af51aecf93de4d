// Takes a panel out of its cell in one click. In a JupyterLab that the course has started it becomes a view of its own
// beside the notebook, by JupyterLab's own "Create New View for Cell Output". Where there is none, in Notebook 7 for
// example, the panel floats over the page and goes back with a second click.

const NARROW = 1600; // pixels of a window in which the list of files leaves too little for both
const READING = 0.55;

function dockable(panel, name) {
  const button = make("button", { type: "button", class: "ck-dock" });
  const place = make("div", { class: "ck-quiet", hidden: true }, `${name} floats over this page.`);
  let floating = null;
  let docked = null;

  const app = () => window.jupyterapp;
  const hosts = () => [...app().shell.widgets("main")];
  const notebook = () => notebookAround(panel);

  function show() {
    if (floating) button.textContent = "Put back into the notebook";
    else button.textContent = notebook() ? "Dock beside the notebook" : "Float over the page";
    button.hidden = Boolean(panel.closest(".jp-LinkedOutputView")); // docked it is already
  }

  async function dock(host) {
    const own = host.content.widgets.findIndex((cell) => cell.node.contains(panel));
    docked = hosts().find((one) => one.content?._cell === host.content.widgets[own]); // also of a run before
    if (docked) {
      app().shell.activateById(docked.id); // one is enough
      return;
    }
    const before = new Set(hosts());
    const beside = hosts().find((one) => one.content?._cell); // of another notebook: two columns are enough
    host.content.activeCellIndex = own;
    await app().commands.execute("notebook:create-output-view");
    const view = hosts().find((one) => !before.has(one));
    if (!view) return;
    const place = beside ? { ref: beside.id, mode: "tab-after" } : { ref: host.id, mode: "split-right" };
    app().shell.add(view, "main", place);
    docked = view;
    requestAnimationFrame(() => leaveRoom(host, view));
  }

  // The notebook keeps most of the width: its text is what one reads.
  function leaveRoom(host, view) {
    if (window.innerWidth < NARROW) app().shell.collapseLeft();
    const { layout } = view.parent;
    requestAnimationFrame(() => {
      const left = host.node.offsetLeft;
      const right = view.node.offsetLeft + view.node.offsetWidth;
      const between = [...layout.handles()].find(({ offsetLeft }) => Math.abs(offsetLeft - view.node.offsetLeft) < 20);
      if (between) layout.moveHandle(between, left + (right - left) * READING, 0);
    });
  }

  function float() {
    panel.before(place);
    place.hidden = false;
    floating = make("div", { class: "ck-floating", "data-lm-suppress-shortcuts": "true" }, panel);
    document.body.append(floating);
  }

  function back() {
    place.before(panel);
    place.remove();
    floating.remove();
    floating = null;
  }

  button.addEventListener("click", async () => {
    const host = notebook();
    if (floating) back();
    else if (host) await dock(host);
    else float();
    show();
    if (host && docked) goOn(panel); // else Shift+Enter would press the button again
    else button.focus();
  });
  // Whether it is docked shows only when it is on the page.
  const seen = new IntersectionObserver(show);
  seen.observe(panel);
  show();
  return {
    button,
    close() {
      seen.disconnect();
      floating?.remove();
    },
  };
}
