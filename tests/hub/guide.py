"""The administrator's guide, whose commands and configuration are tried as they stand."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from pathlib import Path

GUIDE = environment.PACKAGE / "guides" / "jupyterhub.md"
COURSE, TOOLS = "/opt/ros2-course", "/opt/jupyterhub"  # where it installs to


def block(heading: str, language: str) -> str:
    """The first block of a language below a heading that has these words."""
    section = re.split(r"^## ", GUIDE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    below = next(text for text in section if heading in text.partition("\n")[0])
    return re.findall(rf"^```{language}\n(.*?)^```$", below, re.MULTILINE | re.DOTALL)[0]


def moved(text: str, folder: Path) -> str:
    """The same with `/opt` in another folder."""
    return text.replace("/opt/", f"{folder}/opt/")
