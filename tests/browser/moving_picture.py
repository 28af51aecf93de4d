"""Films lesson 0 for README and the site: a robot is sent across its map, then a battery meets a dashboard.

`uvx nox --sessions picture` runs it. It needs Pillow, which no test does.
"""

from __future__ import annotations

import base64
import io
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image
from playwright.sync_api import Page, expect

from course_kit import environment
from course_kit.integrations.jupyter import FIRST_LESSON
from tests.browser.learner import JupyterLab, chromium, page, started_server

if TYPE_CHECKING:
    from playwright.sync_api import Locator

WHERE = environment.PACKAGE / "guides" / "pictures" / "lesson0.gif"
WINDOW, SHOWN = (1280, 800), (880, 550)
WHOLE_S, MOST_BYTES = 20.0, 1_000_000
EVERY_S = 0.25  # the least from one picture to the next


class Film:
    """Pictures of a page, each with how long it is shown."""

    def __init__(self, page: Page) -> None:
        self.page, self.chromium = page, page.context.new_cdp_session(page)
        self.frames: list[tuple[Image.Image, float]] = []

    def show(self, shown_s: float) -> None:
        """One picture, which stands for some time."""
        taken = self.chromium.send("Page.captureScreenshot", {"format": "png"})  # Playwright's own takes longer
        picture = Image.open(io.BytesIO(base64.b64decode(taken["data"]))).convert("RGB")
        self.frames.append((picture.resize(SHOWN, Image.Resampling.LANCZOS), shown_s))

    def watch(self, end: Locator | None, most_s: float) -> None:
        """What moves, as fast as it does: for so long, or until something is there."""
        begun = last = time.monotonic()
        while last - begun < most_s and not (end and end.count()):
            self.page.wait_for_timeout(max(0.0, last + EVERY_S - time.monotonic()) * 1000)
            self.show(0.0)
            now = time.monotonic()
            self.frames[-1] = (self.frames[-1][0], now - last)
            last = now

    def save(self, path: Path) -> None:
        """Write it. It lasts as long as it is meant to: what a slow machine took longer for is shown faster."""
        share = WHOLE_S * 1000 / sum(shown for _, shown in self.frames)
        pictures, durations = zip(*self.frames, strict=True)
        colours = pictures[-1].quantize(128)
        first, *others = [one.quantize(palette=colours, dither=Image.Dither.NONE) for one in pictures]
        first.save(
            path,
            save_all=True,
            append_images=others,
            duration=[round(one * share) for one in durations],
            loop=0,
            optimize=True,
        )
        assert path.stat().st_size <= MOST_BYTES, f"{path.stat().st_size} bytes"


def film_lesson_0(lab: JupyterLab) -> Film:
    """What a learner does in the first ten minutes."""
    film = Film(lab.page)
    lab.page.set_viewport_size({"width": WINDOW[0], "height": WINDOW[1]})
    lab.open(FIRST_LESSON)
    lab.page.keyboard.press("Control+B")  # without the list of files
    film.show(1.5)
    lab.run_cell_that_begins("%load_ext course_kit")
    lab.run_cell_that_begins("from course_kit.panels.demo_robot import DemoRobot")
    robot = lab.scroll_to(lab.page.locator(".ck-map"))
    robot.evaluate("map => map.scrollIntoView({block: 'center'})")
    film.show(1.0)
    drive_across(film, robot)
    lab.run_cell_that_begins("graph = panels.graph()")
    graph = lab.scroll_to(lab.page.locator(".ck-graph"))
    graph.get_by_role("button", name="Dock beside the notebook").click()
    for cell in ("from rclpy.node import Node", "class Dashboard(Node)"):
        lab.run_cell_that_begins(cell)
        film.watch(None, 4.0)
    return film


def drive_across(film: Film, robot: Locator) -> None:
    """Click on the map, and watch the robot until it is there."""
    picture = robot.get_by_role("img")
    box = picture.bounding_box()
    assert box is not None
    picture.click(position={"x": box["width"] * 0.42, "y": box["height"] * 0.66})
    expect(robot).to_contain_text("(EXECUTING)")
    film.watch(robot.get_by_text("(SUCCEEDED)"), 8.0)
    film.show(1.0)


def main() -> None:
    """Film it, and put it where README and the site have it."""
    where = Path(sys.argv[1]) if len(sys.argv) > 1 else WHERE
    with (
        tempfile.TemporaryDirectory() as folder,
        started_server(Path(folder)) as server,
        chromium() as started,
        page(started) as opened,
    ):
        film_lesson_0(JupyterLab(opened, server.root, server.api.address, server.api.token)).save(where)


if __name__ == "__main__":
    main()
