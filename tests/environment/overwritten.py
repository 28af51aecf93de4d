"""A package that has lost a file to another."""

from __future__ import annotations

import base64
import hashlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

INIT = '__version__ = "1.3.1"\n'


def install_lark(folder: Path) -> Path:
    """Put a package `lark` 1.3.1 of one file into the folder as an installer would; returns its file."""
    digest = base64.urlsafe_b64encode(hashlib.sha256(INIT.encode()).digest()).rstrip(b"=").decode()
    files = {
        "lark/__init__.py": INIT,
        "lark-1.3.1.dist-info/METADATA": "Metadata-Version: 2.1\nName: lark\nVersion: 1.3.1\n",
        "lark-1.3.1.dist-info/RECORD": f"lark/__init__.py,sha256={digest},{len(INIT)}\nlark-1.3.1.dist-info/RECORD,,\n",
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return folder / "lark/__init__.py"


def overwrite_lark(folder: Path) -> Path:
    """The same, its file overwritten by the package `lark-parser`."""
    file = install_lark(folder)
    file.write_text('__version__ = "0.12.0"\n')
    return file
