"""What all panels share: one at a time for each thing, updates at a rate a browser can follow, an end."""

from __future__ import annotations

import re
import threading
import weakref
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from course_kit import lab
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

    from IPython.display import JSON
    from ipywidgets import Widget


def still(words: str, picture: str = "", *style_sheets: str | Path, title: str = "") -> str:
    """The HTML of a still picture; where there is no title, the first line of its words says what it is."""
    sheets = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("still.css", *style_sheets))
    told = {"title": title, "lines": words.splitlines()}
    return str(render_template(_HERE / "still.html", css=_as_it_is(sheets), picture=picture, **told))


def draw(template: str, **values: object) -> str:
    """A picture out of a template of this folder."""
    return render_template(_HERE / template, **values)


def form(widget: Any, part: str, *buttons: str, said: Sequence[str] = ()) -> str:
    """A form that sends a message, as a picture, and what came back; its style sheet is `still_panels.css`."""
    stands = {"entries": widget.entries, "values": widget.values, "buttons": buttons, "said": said}
    return draw("still_form.html", **widget.title, part=part, **stands)


def _as_it_is(sheet: str) -> str:
    from markupsafe import Markup

    short = " ".join(re.sub(r"/\*.*?\*/", "", sheet, flags=re.DOTALL).split())  # it is stored with each picture
    return Markup(short)  # noqa: S704 - files of ours


_HERE = Path(__file__).parent
_VIEW = "application/vnd.jupyter.widget-view+json"
RATE = 10.0  # updates a second; above 1,000 the Jupyter server drops some for good
_JOIN = 2.0  # seconds an update is given to end

T = TypeVar("T")


def of_files(*names: str | Path) -> str:
    """The JavaScript of a panel's page as one module, or its style sheet: files, most of them of this folder."""
    return "\n".join((_HERE / name).read_text(encoding="utf-8") for name in names)


class WordedWidget:
    """A widget that has words, too."""

    widget: Widget

    def describe(self) -> str:
        """The panel in a sentence or two, for where no widget can be shown."""
        raise NotImplementedError

    def still(self) -> str:
        """The panel as HTML that does not move, for exports of the notebook: a picture, or its words."""
        return still(self.describe())

    def _repr_mimebundle_(self, **options: Any) -> dict[str, Any]:
        data = self.widget._repr_mimebundle_(**options) or {}
        bundle: dict[str, Any] = dict(data[0] if isinstance(data, tuple) else data)  # anywidget adds metadata
        bundle["text/plain"] = self.describe()
        bundle["text/html"] = self.still()
        return bundle

    def __repr__(self) -> str:
        return self.describe()


_LIVE: weakref.WeakValueDictionary[str, Panel] = weakref.WeakValueDictionary()  # by what a page calls their widgets


class Panel(WordedWidget):
    """A widget for one thing on the ROS graph, which ends with the lab."""

    def __init__(self, *subject: Hashable) -> None:
        self._closing: list[Callable[[], None]] = []
        lab.current().attach_panel((type(self).__name__, *subject), self.close)

    def at_close(self, function: Callable[[], None]) -> None:
        """Have a function called when the panel ends; the last one first."""
        self._closing.append(function)

    def _repr_mimebundle_(self, **options: Any) -> dict[str, Any]:
        bundle = super()._repr_mimebundle_(**options)
        _LIVE[bundle[_VIEW]["model_id"]] = self
        return bundle

    def close(self) -> None:
        """End it: nothing of it is left on the ROS graph. What it displays stays. Safe to call twice."""
        for name in [name for name, panel in _LIVE.items() if panel is self]:
            del _LIVE[name]
        while self._closing:
            self._closing.pop()()


def stills() -> JSON:
    """What the live panels look like now, by their widgets: a page keeps it in the notebook (see labextension)."""
    from IPython.display import JSON

    return JSON({name: panel.still() for name, panel in list(_LIVE.items())})


class LatestValue(Generic[T]):
    """Hands the latest value to `show` on its own thread, at most `RATE` times a second."""

    def __init__(self, show: Callable[[T], None]) -> None:
        self._show = show
        self._values: list[T] = []
        self._changed = threading.Condition()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="panel-updates", daemon=True)
        self._thread.start()

    def put(self, value: T) -> None:
        """Show this soon, unless another value comes first; returns at once."""
        with self._changed:
            self._values[:] = [value]
            self._changed.notify()

    def close(self) -> None:
        """Show what is left and end the thread."""
        with self._changed:
            self._ended.set()
            self._changed.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join(_JOIN)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._values or self._ended.is_set())
                values, self._values = self._values, []
            if not values:
                return
            self._show(values[0])
            self._ended.wait(1.0 / RATE)
