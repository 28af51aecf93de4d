"""The copies that a class sees."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from ipykernel.ipkernel import IPythonKernel

from course_kit.presentation import preparing
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path


def test_jupyterlab_has_nothing_to_add_to_a_copy_and_calls_none_unsaved(tmp_path: Path) -> None:
    demo = "notebooks/demos/01_deadlock.ipynb"
    preparing.prepare_folder(REPOSITORY, tmp_path, REPOSITORY / demo)
    copied = json.loads((tmp_path / preparing.FILES / demo).read_text())
    assert copied["metadata"]["language_info"] == IPythonKernel.language_info
