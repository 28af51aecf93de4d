// An extension of JupyterLab and Notebook 7, written in the form both load without a build: a module of webpack's
// module federation. A link to a heading of another notebook lands there at the first click. JupyterLab opens the
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

  window._JUPYTERLAB = window._JUPYTERLAB || {};
  window._JUPYTERLAB['ros2-course-kit'] = {
    init: () => undefined,
    get: () => Promise.resolve(() => ({ __esModule: true, default: plugin }))
  };
})();
