"""Has `pytest --nbval` run the notebooks as `./course test` does."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pytest


def pytest_configure(config: pytest.Config) -> None:
    """With `--nbval`, set what the course's notebooks need."""
    if not config.getoption("nbval", default=False):
        return
    from course_kit.dev import nbval_plugin

    config.pluginmanager.register(nbval_plugin)
    config.option.nbval_current_env = True
    config.option.nbval_cell_timeout = nbval_plugin.CELL_TIMEOUT_S
    config.option.nbval_sanitize_with = str(Path(__file__).with_name("tests") / "nbval_sanitize.cfg")
