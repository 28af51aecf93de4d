"""Who leaves the graph waits with an end for a discovery callback that may be running, see native/leaving.c."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

LEAVES = "import rclpy; rclpy.init(); rclpy.create_node('leaves').destroy_node(); rclpy.shutdown()"
BOUND = re.compile(
    r"binding file .+/(\S+) \[0\] to .+/(\S+) \[0\]: normal symbol `\S+set_listenerEPN\S+ListenerE(N\S+)?'"
)


def test_the_middleware_leaves_by_the_function_that_has_an_end(domain: int, tmp_path: Path) -> None:
    linker = {"LD_DEBUG": "bindings", "LD_DEBUG_OUTPUT": str(tmp_path / "linker")}
    environ = {**os.environ, **linker, "ROS_DOMAIN_ID": str(domain)}
    subprocess.run([sys.executable, "-c", LEAVES], env=environ, check=True, timeout=120)
    bound = [match.groups() for path in tmp_path.iterdir() for match in BOUND.finditer(path.read_text())]
    assert ("librmw_fastrtps_shared_cpp.so", "_helper.so", None) in bound
    assert any(library.startswith(("libfastrtps", "libfastdds")) and within for _, library, within in bound)
