"""Nodes of other notebooks on the graph, apart from the notebook's own, each with a button that stops them."""

from __future__ import annotations

import html
import threading
from functools import partial
from typing import TYPE_CHECKING

from ipywidgets import HTML, Button, Layout, VBox

from course_kit import lab

if TYPE_CHECKING:
    from course_kit.lab.runtime.neighbours import OtherNotebook


class OtherNotebooks:
    """A line for each notebook; nothing where there is none."""

    def __init__(self) -> None:
        self.widget = VBox([])
        self._shown: list[OtherNotebook] = []
        self.widget.add_class("ck-others")

    def show(self, others: list[OtherNotebook]) -> None:
        """Show these; a line that has not changed stays as it is."""
        if others == self._shown:
            return
        lines = dict(zip(self._shown, self.widget.children, strict=True))
        self._shown = others
        self.widget.children = tuple(lines[one] if one in lines else _line(one) for one in others)

    def describe(self) -> str:
        """The same as text."""
        return "\n".join(f"In another notebook, {one}" for one in self._shown)


def _line(other: OtherNotebook) -> VBox:
    text = HTML(f'<span role="status">In another notebook, {html.escape(str(other))}</span>')
    button = Button(description=f"Stop what {other.title} runs", layout=Layout(width="auto"))
    button.on_click(partial(_stop, other.title, text))
    return VBox([text, button], layout=Layout(align_items="flex-start"))


def _stop(title: str, text: HTML, button: Button) -> None:
    """The other one is given seconds to stop, in which this notebook goes on."""
    button.disabled = True

    def stop() -> None:
        try:
            lab.stop_others(title)
        except lab.LabError as problem:
            text.value = f'<span role="status">{html.escape(str(problem))}</span>'
            button.disabled = False

    threading.Thread(target=stop, name="stop-others", daemon=True).start()
