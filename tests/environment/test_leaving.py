"""Who leaves the graph ends, and stays away from it, see native/leaving.c."""

from __future__ import annotations

import ctypes
import os
import re
import subprocess
import sys
from typing import TYPE_CHECKING

from course_kit.interfaces.native.loader import LIBRARY
from tests.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.lab.runtime.core import Lab

LEAVES = "import rclpy; rclpy.init(); rclpy.create_node('leaves').destroy_node(); rclpy.shutdown()"
BOUND = re.compile(r"binding file .+/(\S+) \[0\] to .+/(\S+) \[0\]: normal symbol `(\S+)'")
REPLACED = ("DomainParticipant12set_listenerE", "GraphCache15add_", "GraphCache18remove_", "GraphCache27update_")


def test_the_middleware_leaves_and_forgets_by_the_repaired_functions(domain: int, tmp_path: Path) -> None:
    linker = {"LD_DEBUG": "bindings", "LD_DEBUG_OUTPUT": str(tmp_path / "linker")}
    environ = {**os.environ, **linker, "ROS_DOMAIN_ID": str(domain)}
    subprocess.run([sys.executable, "-c", LEAVES], env=environ, check=True, timeout=120)
    bound = [match.groups() for path in tmp_path.iterdir() for match in BOUND.finditer(path.read_text())]
    for part in REPLACED:
        homes = {home for user, home, symbol in bound if user == "librmw_fastrtps_shared_cpp.so" and part in symbol}
        assert homes == {"_helper.so"}, part
    assert any(home.startswith(("libfastrtps", "libfastdds")) and "set_listenerEPN" in name for _, home, name in bound)


class Text(ctypes.Structure):  # std::string
    _fields_ = (("data", ctypes.c_char_p), ("size", ctypes.c_size_t), ("rest", ctypes.c_char * 16))


class NodeInfo(ctypes.Structure):  # rmw_dds_common::msg::NodeEntitiesInfo: two names, no readers, no writers
    _fields_ = (("namespace", Text), ("name", Text), ("entities", ctypes.c_void_p * 6))


class ParticipantInfo(ctypes.Structure):  # rmw_dds_common::msg::ParticipantEntitiesInfo, its nodes as a std::vector
    _fields_ = (("gid", ctypes.c_ubyte * 16), ("nodes", ctypes.c_void_p * 3))


class Leaver(ctypes.Structure):
    _fields_ = (("graph", ctypes.c_void_p), ("gid", ctypes.c_ubyte * 16))


def test_a_late_message_brings_no_node_back(own_lab: Lab) -> None:
    names = own_lab.engine.node.get_node_names
    helper = ctypes.CDLL(str(LIBRARY))
    leavers = (Leaver * 256).in_dll(helper, "leavers")
    before = bytes(leavers)
    subprocess.run([sys.executable, "-c", LEAVES], check=True, timeout=120)
    wait_until(lambda: bytes(leavers) != before, "somebody who has left")
    known = (Leaver * 256).from_buffer_copy(before)
    last = next(leavers[index] for index in range(256) if bytes(leavers[index]) != bytes(known[index]))

    node = NodeInfo(Text(b"/", 1), Text(b"late", 4))
    end = ctypes.addressof(node) + ctypes.sizeof(node)
    message = ParticipantInfo(last.gid, (ctypes.addressof(node), end, end))
    update = helper[
        "_ZN14rmw_dds_common10GraphCache27update_participant_entitiesERKNS_3msg24ParticipantEntitiesInfo_ISaIvEEE"
    ]
    graph = ctypes.c_void_p(last.graph)
    update(graph, ctypes.byref(message))
    assert "late" not in names()
    message.gid[15] ^= 1  # somebody else's
    update(graph, ctypes.byref(message))
    assert "late" in names()
