"""Exports by nbconvert: answers stay folded, panels are pictures, and whoever exports in JupyterLab gets the same."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import bs4
import pytest
from nbconvert import HTMLExporter, SlidesExporter
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from traitlets.config import Config

from course_kit.integrations import server_extension
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from nbformat import NotebookNode

SETTINGS = REPOSITORY / "course_kit/jupyter_config/jupyter_nbconvert_config.json"
WIDGET = "application/vnd.jupyter.widget-view+json"
ANSWER = """Before.

<details><summary>Check: what is <code>x</code>?</summary>

It is `1`:

```python
x = 1

print(x)
```
</details>

<details><summary>And now?</summary>

The same. </details>

After.
"""


def exported(exporter: type[HTMLExporter], *cells: NotebookNode) -> bs4.BeautifulSoup:
    config = Config(json.loads(SETTINGS.read_text(encoding="utf-8")))
    html, _ = exporter(config=config).from_notebook_node(new_notebook(cells=list(cells)))
    return bs4.BeautifulSoup(html, "html.parser")


@pytest.mark.parametrize("exporter", [HTMLExporter, SlidesExporter])
def test_an_answer_stays_folded(exporter: type[HTMLExporter]) -> None:
    page = exported(exporter, new_markdown_cell(ANSWER))
    first, second = page.find_all("details")
    assert first.summary.code.get_text() == "x"
    assert "x = 1\n\nprint(x)" in first.pre.get_text()
    assert "The same." in second.get_text()
    outside = "".join(one.get_text() for one in page.find_all("p") if not one.find_parent("details"))
    assert (outside.count("Before."), outside.count("After."), outside.count("The same.")) == (1, 1, 0)


def test_a_panel_is_its_picture_and_another_widget_is_left() -> None:
    view = {"model_id": "m", "version_major": 2, "version_minor": 0}
    both = new_output("display_data", {WIDGET: view, "text/html": "<b>a picture</b>", "text/plain": "words"})
    alone = new_output("display_data", {WIDGET: view, "text/plain": "words of another"})
    page = exported(HTMLExporter, new_code_cell("panel", outputs=[both]), new_code_cell("other", outputs=[alone]))
    assert page.find("b").get_text() == "a picture"
    assert "words of another" in page.get_text()
    assert alone.data[WIDGET] == view


def test_jupyter_server_exports_with_the_same_settings_unless_the_user_has_others() -> None:
    config = Config({"HTMLExporter": {"embed_images": False}, "ServerApp": {"port": 8888}})
    server_extension.set_exports(config)
    assert config.HTMLExporter.preprocessors == ["course_kit.integrations.export.StillAndFolded"]
    assert (config.HTMLExporter.embed_images, config.ServerApp.port) == (False, 8888)


def test_each_picture_of_a_lesson_is_in_its_export() -> None:
    path = REPOSITORY / "notebooks/02_actions.ipynb"
    config = Config(json.loads(SETTINGS.read_text(encoding="utf-8")))
    html, _ = HTMLExporter(config=config).from_filename(str(path))
    pictures = bs4.BeautifulSoup(html, "html.parser").main.find_all("img")
    assert len(pictures) >= 2
    assert {one["src"].partition(",")[0] for one in pictures} == {"data:image/svg+xml;base64"}
    assert all(len(one["alt"]) > 40 for one in pictures)
    assert not list(Path(path.parent).glob("*.html"))
