// What the scripts of panels share; it is put in front of them.

function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

// The notebook widget around a panel, where JupyterLab lets scripts reach it: in one that the course has started.
function notebookAround(panel) {
  const widgets = window.jupyterapp ? [...window.jupyterapp.shell.widgets("main")] : [];
  return widgets.find((one) => one.context && one.content?.widgets && one.node.contains(panel));
}

// Leave a panel for the cell below its own, as after running that: the next Shift+Enter goes on in the notebook.
function goOn(panel) {
  const host = notebookAround(panel);
  if (!host) {
    const next = panel.closest(".jp-Cell")?.nextElementSibling?.querySelector(".jp-InputArea-prompt, .jp-Cell-inputWrapper");
    for (const kind of ["mousedown", "mouseup"]) next?.dispatchEvent(new MouseEvent(kind, { bubbles: true, button: 0 }));
    return;
  }
  const { content } = host;
  const own = content.widgets.findIndex((cell) => cell.node.contains(panel));
  window.jupyterapp.shell.activateById(host.id);
  content.mode = "command";
  content.activeCellIndex = Math.min(own + 1, content.widgets.length - 1);
  content.node.focus();
}

// A panel's parts keep the keys that they need from the notebook. Shift+Enter they do not need, and it is the key that
// every learner knows. One listener for all panels of the page; before the notebook's own, which is on the document.
function leaveByShiftEnter(event) {
  if (event.key !== "Enter" || !event.shiftKey || event.ctrlKey || event.altKey || event.metaKey) return;
  const panel = event.target.closest?.(".ck-panel, [data-lm-suppress-shortcuts]");
  if (!panel?.closest(".jp-Notebook")) return;
  event.preventDefault();
  event.stopImmediatePropagation();
  goOn(panel);
}

if (!window.courseKitLeavesPanels) {
  window.courseKitLeavesPanels = true;
  window.addEventListener("keydown", leaveByShiftEnter, true);
}
