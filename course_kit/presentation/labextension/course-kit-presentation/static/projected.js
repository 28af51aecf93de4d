// JupyterLab's extension for the page that a class sees. It is written by hand as a container of module federation,
// which is how JupyterLab loads extensions, so that it needs no build: `init` gets the modules JupyterLab shares, `get`
// hands out ours. Nothing is saved and nothing is sent to another host; the speaker's window, on the same address,
// listens on a BroadcastChannel.
(() => {
  "use strict";
  const NAME = "course-kit-presentation";
  const HERE = document.currentScript.src;
  const BAR = 60; // pixels, of the bar below the page
  const ABOVE = ["jp-header-panel", "jp-top-panel", "jp-menu-panel", "jp-title-panel"];
  let shared;

  async function load(name) {
    const versions = Object.values(shared[name] ?? {});
    if (!versions.length) {
      throw new Error(`${NAME}: this JupyterLab has no ${name}`);
    }
    const used = versions.find((one) => one.loaded) ?? versions[0];
    return (await used.get())();
  }

  // ---- a demo on the page ---------------------------------------------------------------------------------------
  class Demo {
    constructor(panel, modules, changed) {
      this.panel = panel;
      this.actions = modules.notebook.NotebookActions;
      this.changed = changed;
      this.busy = false;
      this.failing = null;
      const target = this.target();
      if (target) {
        this.failing = target.model.sharedModel.getSource();
        this.mark(target, modules);
      }
      panel.content.activeCellChanged.connect(changed);
      panel.content.model.cells.changed.connect(changed);
    }

    get cells() {
      return this.panel.content.widgets;
    }
    get code() {
      return this.cells.filter((cell) => cell.model.type === "code");
    }
    target() {
      return this.cells.find((cell) => repairOf(cell)) ?? null;
    }
    get repaired() {
      const target = this.target();
      return Boolean(target) && target.model.sharedModel.getSource() === repairOf(target);
    }
    get unrun() {
      return this.code.find((cell) => cell.model.executionCount === null) ?? null;
    }
    // What comes next: a cell to run; after the repair, what it has changed, and the end. Null: the repair, or nothing.
    get next() {
      if (this.unrun || (this.target() && !this.repaired)) {
        return this.unrun;
      }
      const below = this.cells.slice(this.panel.content.activeCellIndex + 1);
      return below.find((cell) => cell.model.type === "code") ?? below.at(-1) ?? null;
    }
    // The failure comes before the repair: everything has to be run once.
    get canRepair() {
      return Boolean(this.target()) && !this.busy && this.unrun === null;
    }

    mark(cell, { view }) {
      const before = new Set(this.failing.split("\n"));
      const fresh = new Set(repairOf(cell).split("\n").filter((line) => line.trim() && !before.has(line)));
      const marks = view.EditorView.decorations.compute(["doc"], (state) => {
        const found = [];
        for (let number = 1; number <= state.doc.lines; number++) {
          const line = state.doc.line(number);
          if (fresh.has(line.text)) {
            found.push(view.Decoration.line({ class: "ck-repaired" }).range(line.from));
          }
        }
        return view.Decoration.set(found);
      });
      cell.inViewportChanged.connect(() => attach());
      const attach = () => {
        if (cell.editor && cell.editor !== this.marked) {
          this.marked = cell.editor;
          cell.editor.injectExtension(marks);
        }
      };
      cell.ready.then(attach);
    }

    async run(cells) {
      if (this.busy) {
        return;
      }
      this.busy = true;
      this.changed();
      try {
        for (const cell of cells) {
          await this.show(cell);
          await this.actions.runCells(this.panel.content, [cell], this.panel.sessionContext);
          this.follow(cell);
          this.changed();
        }
      } finally {
        this.busy = false;
        this.changed();
      }
    }

    async show(cell, where = "nearest") {
      const notebook = this.panel.content;
      notebook.activeCellIndex = notebook.widgets.indexOf(cell);
      notebook.mode = "command";
      await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
      cell.node.scrollIntoView({ block: where });
    }

    // Outputs are drawn after their cell has run: keep them in sight while they grow, until the speaker goes on.
    follow(cell) {
      this.following?.disconnect();
      this.following = new ResizeObserver(() => {
        if (this.panel.content.activeCell === cell) {
          cell.node.scrollIntoView({ block: cell.node.offsetHeight > innerHeight - BAR ? "end" : "nearest" });
        }
      });
      this.following.observe(cell.node);
    }

    async step() {
      const next = this.next;
      if (!next) {
        await (this.repaired ? undefined : this.repair());
      } else if (next === this.unrun) {
        await this.run([next]);
      } else {
        await this.show(next);
        this.follow(next);
        this.changed();
      }
    }

    // Puts the repair into the failing cell, or takes it out again, and runs from there. Then the class sees that cell.
    async repair() {
      const target = this.target();
      if (!this.canRepair) {
        return;
      }
      target.model.sharedModel.setSource(this.repaired ? this.failing : repairOf(target));
      const from = this.cells.indexOf(target);
      await this.run(this.code.filter((cell) => this.cells.indexOf(cell) >= from));
      this.following?.disconnect();
      await this.show(target, "start");
      this.changed();
    }

    get here() {
      return this.panel.content.activeCell?.model.id ?? "";
    }
  }

  function repairOf(cell) {
    return cell.model.getMetadata?.("course_kit")?.repaired ?? "";
  }

  // ---- the bar below it -----------------------------------------------------------------------------------------
  class Bar {
    constructor({ widgets }, verbs) {
      this.widget = new widgets.Widget();
      this.widget.id = "ck-stage-bar";
      this.widget.addClass("ck-stage-bar");
      this.widget.node.setAttribute("role", "region");
      this.widget.node.setAttribute("aria-label", "Presentation");
      this.where = document.createElement("span");
      this.where.className = "ck-stage-where";
      this.where.setAttribute("role", "status");
      this.where.textContent = "Starting";
      this.speaker = this.button("Notes", "Open your notes in a second window (Alt+S)", verbs.speaker);
      this.step = this.button("Next", "", verbs.step);
      this.repair = this.button("Repair", "", verbs.repair);
      this.repair.classList.add("ck-stage-repair");
      this.step.disabled = this.repair.disabled = true; // until there is a demo
      this.widget.node.append(this.where, this.speaker, this.step, this.repair);
    }

    button(label, title, pressed) {
      const made = document.createElement("button");
      made.type = "button";
      made.textContent = label;
      made.title = title;
      made.addEventListener("click", pressed);
      return made;
    }

    show(demo, hasSpeaker) {
      const run = demo.code.filter((cell) => cell.model.executionCount !== null).length;
      const what = demo.busy ? "Running" : `${run} of ${demo.code.length} cells run`;
      this.where.textContent = `${what}${demo.repaired ? ", repaired" : ""}`;
      this.speaker.hidden = hasSpeaker;
      this.step.disabled = demo.busy || !demo.next;
      this.step.title = demo.unrun ? "Run the next cell (Alt+N)" : "Show the next cell (Alt+N)";
      this.repair.hidden = !demo.target();
      this.repair.disabled = !demo.canRepair;
      this.repair.textContent = demo.repaired ? "Undo the repair" : "Repair";
      this.repair.title = demo.canRepair ? "Alt+R" : "First run every cell: the failure comes before the repair.";
    }
  }

  // ---- the page, and the speaker's window -----------------------------------------------------------------------
  class Page {
    constructor(app, modules, base) {
      this.app = app;
      this.base = base;
      this.demo = null;
      this.heard = 0;
      this.channel = new BroadcastChannel(NAME);
      this.channel.onmessage = ({ data }) => this.hear(data);
      this.bar = new Bar(modules, {
        speaker: () => this.openSpeaker(),
        step: () => this.demo?.step(),
        repair: () => this.demo?.repair(),
      });
      addEventListener("pagehide", () => this.channel.postMessage({ type: "gone" }));
      setInterval(() => this.draw(), 1000);
    }

    get hasSpeaker() {
      return Date.now() - this.heard < 4000;
    }

    show(demo) {
      this.demo = demo;
      this.path = demo.panel.context.path;
      this.began = Number(sessionStorage.getItem(this.key)) || 0;
      if (!this.began) {
        this.begin();
      }
      this.tell();
    }

    get key() {
      return `${NAME}:${this.path}`;
    }

    begin() {
      this.began = Date.now();
      sessionStorage.setItem(this.key, String(this.began));
    }

    draw() {
      if (this.demo) {
        this.bar.show(this.demo, this.hasSpeaker);
      }
    }

    tell() {
      const demo = this.demo;
      if (!demo) {
        return;
      }
      this.draw();
      this.channel.postMessage({
        type: "state",
        path: this.path,
        here: demo.here,
        next: demo.next?.model.id ?? "",
        isRun: demo.unrun === null,
        busy: demo.busy,
        canRepair: demo.canRepair,
        repaired: demo.repaired,
        began: this.began,
      });
    }

    hear(message) {
      this.heard = Date.now();
      const verbs = {
        hello: () => {},
        step: () => this.demo?.step(),
        repair: () => this.demo?.repair(),
        time: () => this.begin(),
        open: () => this.open(message.path),
      };
      verbs[message.type]?.();
      this.tell();
    }

    openSpeaker() {
      open(`${this.base}course-kit/speaker`, `${NAME}-speaker`, "popup,width=900,height=760");
    }

    // Another demo, or this one afresh: its nodes end with its kernel.
    async open(path) {
      sessionStorage.removeItem(`${NAME}:${path}`);
      await this.demo?.panel.sessionContext.shutdown();
      location.assign(`${this.base}doc/tree/${path.split("/").map(encodeURIComponent).join("/")}?reset`);
    }
  }

  function clear(app) {
    const shell = app.shell;
    document.body.classList.add("ck-projected");
    shell.mode = "single-document";
    shell.collapseLeft();
    shell.collapseRight();
    for (const side of ["left", "right"]) {
      if (shell.isSideTabBarVisible(side)) {
        shell.toggleSideTabBarVisibility(side);
      }
    }
    if (shell.isTopInSimpleModeVisible()) {
      shell.toggleTopInSimpleModeVisibility();
    }
    for (const panel of shell.layout.widgets) {
      if (ABOVE.includes(panel.id)) {
        panel.hide();
      }
    }
  }

  // A node of another demo, or of this one before the page was loaded again, would answer in this one.
  async function startAfresh(app, panel) {
    await panel.sessionContext.ready;
    const sessions = app.serviceManager.sessions;
    await sessions.refreshRunning();
    const others = [...sessions.running()].filter((session) => session.path !== panel.sessionContext.path);
    await Promise.all(others.map((session) => sessions.shutdown(session.id)));
    const kernel = panel.sessionContext.session?.kernel;
    await kernel?.info; // one that does not answer yet would lose what is run
    const range = { output: false, raw: true, hist_access_type: "range", session: 0, start: 1, stop: 2 };
    const { content } = (await kernel?.requestHistory(range)) ?? {};
    if (content?.history?.length) {
      await panel.sessionContext.restartKernel();
      await panel.sessionContext.session?.kernel?.info;
    }
  }

  async function activate(app, tracker) {
    const [notebook, widgets, view, coreutils] = await Promise.all(
      ["@jupyterlab/notebook", "@lumino/widgets", "@codemirror/view", "@jupyterlab/coreutils"].map(load),
    );
    const modules = { notebook, widgets, view };
    const page = new Page(app, modules, coreutils.PageConfig.getBaseUrl());
    const verbs = { step: ["Run the next cell", "N"], repair: ["Put the repair in place, or take it out", "R"] };
    for (const [verb, [label, key]] of Object.entries(verbs)) {
      app.commands.addCommand(`${NAME}:${verb}`, { label, execute: () => page.demo?.[verb]() });
      app.commands.addKeyBinding({ command: `${NAME}:${verb}`, keys: [`Alt ${key}`], selector: "body" });
    }
    app.commands.addCommand(`${NAME}:speaker`, { label: "Open the notes", execute: () => page.openSpeaker() });
    app.commands.addKeyBinding({ command: `${NAME}:speaker`, keys: ["Alt S"], selector: "body" });
    // Copies are not saved, so closing the page asks nothing: JupyterLab looks here, in a listener that is before ours.
    Object.defineProperty(app.status, "isDirty", { get: () => false });
    notebook.NotebookActions.executed.connect(() => page.tell());
    app.restored.then(() => {
      app.shell.add(page.bar.widget, "bottom", { rank: 0 });
      clear(app);
    });
    const present = async (_, panel) => {
      if (!panel) {
        return;
      }
      await panel.context.ready;
      await panel.revealed;
      panel.toolbar.hide();
      await startAfresh(app, panel);
      page.show(new Demo(panel, modules, () => page.tell()));
    };
    tracker.widgetAdded.connect(present);
    if (tracker.currentWidget) {
      await present(null, tracker.currentWidget);
    }
  }

  const exposed = {
    "./extension": async () => {
      const { INotebookTracker } = await load("@jupyterlab/notebook");
      const plugin = { id: `${NAME}:plugin`, autoStart: true, requires: [INotebookTracker], activate };
      return { __esModule: true, default: plugin };
    },
    "./style": async () => {
      const link = document.createElement("link");
      link.rel = "stylesheet";
      link.href = new URL("projected.css", HERE).href;
      document.head.append(link);
      return {};
    },
  };
  window._JUPYTERLAB = window._JUPYTERLAB ?? {};
  window._JUPYTERLAB[NAME] = {
    init: (scope) => {
      shared = scope;
    },
    get: async (name) => {
      const made = await exposed[name]();
      return () => made;
    },
  };
})();
