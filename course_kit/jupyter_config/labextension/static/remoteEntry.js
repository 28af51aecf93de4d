// An extension of JupyterLab and Notebook 7, written in the form both load without a build: a module of webpack's
// module federation. A panel whose kernel has ended shows its last picture, and how to wake it. A link to a heading of another notebook lands there at the first click. JupyterLab opens the
// notebook and scrolls before its cells have their height; Notebook 7 opens it in another tab and forgets the heading.
(() => {
  const LOOK_MS = 100;
  const AT_MOST_MS = 20000;
  const CALM = 8; // looks in a row at which the heading stays where it is
  let landings = 0; // a later click, or the reader's own scrolling, ends the landing before

  const idOf = text => text.trim().replace(/[`*_]/g, '').replace(/ /g, '-');

  /** The index of the cell with a heading, by its text: a cell far away may not be drawn yet. */
  function cellOf(notebook, id) {
    return notebook.widgets.findIndex(
      cell =>
        cell.model.type === 'markdown' &&
        cell.model.sharedModel.getSource().split('\n').some(line => /^#+\s/.test(line) && idOf(line.replace(/^#+/, '')) === id)
    );
  }

  function headingIn(panel, id) {
    const name = CSS.escape(id);
    return panel.node.querySelector(`[data-jupyter-id="${name}"], [id="${name}"]`);
  }

  /** Scroll to a heading as soon as its notebook is there, and again while cells above it still grow. */
  async function land(app, path, id) {
    const mine = ++landings;
    const end = Date.now() + AT_MOST_MS;
    for (let calm = 0; calm < CALM && Date.now() < end && mine === landings; ) {
      await new Promise(done => setTimeout(done, LOOK_MS));
      const panel = app.shell.currentWidget;
      if (!panel?.context?.isReady || !panel.context.path.endsWith(path) || !panel.content?.widgets) {
        continue;
      }
      const heading = headingIn(panel, id);
      if (!heading) {
        const index = cellOf(panel.content, id);
        if (index >= 0) {
          await panel.content.scrollToItem(index, 'start');
        }
        continue;
      }
      const before = heading.getBoundingClientRect().top;
      heading.scrollIntoView({ block: 'start' });
      calm = Math.abs(heading.getBoundingClientRect().top - before) < 2 ? calm + 1 : 0;
    }
  }

  const plugin = {
    id: 'ros2-course-kit:links',
    autoStart: true,
    activate(app) {
      const alone = app.name !== 'JupyterLab'; // Notebook 7: one notebook a tab
      const stop = () => landings++;
      window.addEventListener('wheel', stop, { capture: true, passive: true });
      window.addEventListener('keydown', stop, true);
      document.addEventListener(
        'click',
        event => {
          const link = event.target instanceof Element && event.target.closest('a[href]');
          if (!link || event.button !== 0 || event.ctrlKey || event.metaKey) {
            return;
          }
          const url = new URL(link.href, location.href);
          const [, base, path] = /^(.*?)\/files\/(.+\.ipynb)$/.exec(url.pathname) ?? [];
          if (!path || url.origin !== location.origin) {
            return;
          }
          const id = decodeURIComponent(url.hash.slice(1));
          if (alone) {
            event.preventDefault();
            event.stopPropagation();
            window.open(`${base}/notebooks/${path}${url.hash}`, '_blank');
          } else if (id) {
            void land(app, decodeURIComponent(path), id);
          }
        },
        true
      );
      if (alone && location.hash) {
        void app.restored.then(() => land(app, '', decodeURIComponent(location.hash.slice(1))));
      }
    }
  };

  // --- panels whose kernel is gone

  const WIDGET = 'application/vnd.jupyter.widget-view+json';
  const OURS = /class="ck-(?:still|guess-still)"/;
  const REDRAW_MS = 200;

  const STYLE = `
    .ck-asleep > .ck-asleep-bar { display: flex; flex-wrap: wrap; gap: .5em 1em; align-items: center; padding: .4em .6em;
      border-left: 4px solid var(--jp-warn-color1); background: var(--jp-layout-color2); color: var(--jp-ui-font-color1); }
    .ck-asleep-bar button { font: inherit; cursor: pointer; padding: .2em .8em; border-radius: 3px; color: var(--jp-ui-font-color1);
      border: 1px solid var(--jp-border-color1); background: var(--jp-layout-color1); }
    .ck-asleep > [inert] { opacity: .6; }
    .ck-asleep .ck-still figcaption { display: none; }
    .ck-asleep-chosen { font-weight: bold; }`;

  /** Keeps watch over the panels of one notebook: which of them the kernel no longer knows. */
  class Sleepers {
    constructor(app, panel) {
      Object.assign(this, { app, panel, asleep: new WeakSet(), judged: new WeakSet(), fresh: false, alive: null });
      const context = panel.sessionContext;
      context.statusChanged.connect((_, status) => /restarting|dead/.test(status) && this.allFallAsleep());
      context.kernelChanged.connect((_, { oldValue, newValue }) => {
        if (oldValue) this.allFallAsleep();
        if (newValue) void this.askKernel();
      });
      context.iopubMessage.connect((_, message) => {
        if (message.header.msg_type === 'execute_input') this.fresh = false;
      });
      new MutationObserver(() => this.drawSoon()).observe(panel.node, { childList: true, subtree: true });
      void context.ready.then(() => this.askKernel());
    }

    /** The widgets' outputs: the model, the widget that shows it, and the cell. */
    *outputs() {
      for (const cell of this.panel.content.widgets) {
        const area = cell.model.type === 'code' && cell.outputArea;
        for (let place = 0; area && place < area.model.length; place++) {
          const model = area.model.get(place);
          if (model.data[WIDGET] && OURS.test(model.data['text/html'] ?? '')) {
            yield { model, cell, node: area.widgets[place]?.node };
          }
        }
      }
    }

    /** Which widgets a kernel knows decides what is alive of an opened notebook; a new kernel knows none. */
    async askKernel() {
      const kernel = this.panel.sessionContext.session?.kernel;
      const before = [...this.outputs()].filter(({ model }) => !this.judged.has(model));
      const reply = before.length ? await kernel?.requestCommInfo({ target_name: 'jupyter.widget' }) : undefined;
      const known = reply?.content.comms;
      for (const { model } of known ? before : []) {
        this.judged.add(model);
        if (!(model.data[WIDGET].model_id in known)) this.asleep.add(model);
      }
      this.fresh = known !== undefined && Object.keys(known).length === 0;
      this.draw();
    }

    allFallAsleep() {
      for (const { model } of this.outputs()) {
        this.judged.add(model);
        this.asleep.add(model);
      }
      this.fresh = true;
      this.drawSoon();
    }

    drawSoon() {
      this.timer ??= setTimeout(() => {
        this.timer = undefined;
        this.draw();
      }, REDRAW_MS);
    }

    draw() {
      for (const { model, cell, node } of this.outputs()) {
        const shown = node?.querySelector('.jp-OutputArea-output');
        if (shown && this.asleep.has(model) && !node.querySelector('.ck-asleep')) void this.put(shown, model, cell);
      }
      for (const view of this.app.shell.widgets('main')) {
        const docked = view.content?._cell && view.node.querySelector('.jp-LinkedOutputView, .jp-OutputArea');
        const model = docked && view.content._cell.outputArea?.model.get(0);
        if (model && view.content._notebook === this.panel) docked.inert = this.asleep.has(model);
      }
    }

    /** Show a panel's last picture in its place: as it stands on the page, or as it is kept in the notebook. */
    async put(shown, model, cell) {
      const dead = /^(Loading widget|Error displaying widget)/.test(shown.textContent.trim());
      const frame = document.createElement('div');
      frame.className = 'ck-asleep';
      const bar = document.createElement('div');
      bar.className = 'ck-asleep-bar';
      const button = document.createElement('button');
      button.textContent = 'Run this cell to bring it to life';
      button.title = this.fresh ? 'Runs the cells above first: the kernel has just been started.' : '';
      button.addEventListener('click', () => void this.wake(cell));
      bar.append('This is the last picture of a panel: its kernel has ended.', button);
      frame.append(bar);
      shown.before(frame);
      if (dead) {
        const { rendermime } = this.panel.content;
        const data = { 'text/html': model.data['text/html'] };
        const picture = rendermime.createRenderer('text/html');
        await picture.renderModel(rendermime.createModel({ data, trusted: model.trusted }));
        frame.append(picture.node);
        shown.style.display = 'none';
        await markChoices(picture.node);
      } else {
        frame.append(shown);
        shown.inert = true;
      }
    }

    async wake(cell) {
      const { content } = this.panel;
      this.app.shell.activateById(this.panel.id);
      content.deselectAll();
      content.activeCellIndex = content.widgets.indexOf(cell);
      if (this.fresh) await this.app.commands.execute('notebook:run-all-above');
      content.activeCellIndex = content.widgets.indexOf(cell);
      await this.app.commands.execute('notebook:run-cell');
    }
  }

  /** What was chosen earlier, in the picture of a question; the server keeps it beside the learner's progress. */
  async function markChoices(node) {
    const questions = [...node.querySelectorAll('.ck-guess-still')];
    if (!questions.length) return;
    const base = JSON.parse(document.getElementById('jupyter-config-data').textContent).baseUrl;
    const answer = await fetch(`${base}course-kit/guesses`);
    const chosen = answer.ok ? await answer.json() : {};
    for (const question of questions) {
      const text = chosen[question.querySelector('strong').textContent];
      const choice = [...question.querySelectorAll('li')].find(one => one.textContent === text);
      choice?.classList.add('ck-asleep-chosen');
      choice?.append(' (your guess)');
    }
  }

  const sleepers = {
    id: 'ros2-course-kit:panels',
    autoStart: true,
    activate(app) {
      document.head.append(Object.assign(document.createElement('style'), { textContent: STYLE }));
      const watched = new WeakSet();
      const look = () => {
        for (const panel of app.shell.widgets('main')) {
          if (panel.sessionContext && panel.content?.rendermime && !watched.has(panel)) {
            watched.add(panel);
            void panel.context.ready.then(() => new Sleepers(app, panel));
          }
        }
      };
      app.shell.layoutModified?.connect(look);
      app.shell.currentChanged?.connect(look);
      void app.restored.then(look);
    }
  };

  window._JUPYTERLAB = window._JUPYTERLAB || {};
  window._JUPYTERLAB['ros2-course-kit'] = {
    init: () => undefined,
    get: () => Promise.resolve(() => ({ __esModule: true, default: [plugin, sleepers] }))
  };
})();
