"""The middleware (RMW) that ROS will load, settled before rclpy is imported.

With an RMW_IMPLEMENTATION that is not installed the import of rclpy ends the process, so that a kernel dies without
a word. The ROS wheels have Fast DDS alone; a sourced ROS may have others.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

SUPPORTED = "rmw_fastrtps_cpp"  # the one the live interfaces are made for
VARIABLES = ("RMW_IMPLEMENTATION", "RCL_ASSERT_RMW_ID_MATCHES")  # rcl compares both with what is loaded
# Tells the processes started from here which setting of the user's was replaced: RMW_IMPLEMENTATION=rmw_cyclonedds_cpp
REPLACED = "COURSE_KIT_RMW_REPLACED"


def _has_fast_dds_3() -> bool:
    """Whether the ROS of this process is Kilted or later; Jazzy's Fast DDS 2 has its library under another name."""
    prefixes = (sys.prefix, *filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)))
    return any(Path(prefix, "lib", "libfastdds.so").exists() for prefix in prefixes)


# Fast DDS 3 reads another variable, and spells the two times of a profile in another way.
_FAST_DDS_3 = _has_fast_dds_3()
PROFILE_VARIABLE = "FASTDDS_DEFAULT_PROFILES_FILE" if _FAST_DDS_3 else "FASTRTPS_DEFAULT_PROFILES_FILE"
PROFILES = Path(__file__).with_name("fast_dds_3") if _FAST_DDS_3 else Path(__file__).parent


def choose_middleware() -> str:
    """See that ROS can load what the environment asks for, and have it load Fast DDS where it cannot; what to tell."""
    wanted = {name: os.environ[name] for name in VARIABLES if os.environ.get(name)}
    asked = set(wanted.values())
    if asked <= {SUPPORTED} or (len(asked) == 1 and all(map(_is_installed, asked))):
        return ""
    name, value = next((name, value) for name, value in wanted.items() if value != SUPPORTED)
    for each in VARIABLES:
        os.environ.pop(each, None)
    os.environ["RMW_IMPLEMENTATION"] = SUPPORTED
    os.environ[REPLACED] = f"{name}={value}"
    return (
        f"{name} is set to '{value}', but no such middleware is installed here: the course uses {SUPPORTED} (Fast "
        f"DDS). Unset {name} to remove this message."
    )


def explain_middleware() -> str:
    """What to tell about a middleware that works and does not suit the live interfaces; empty when all is well."""
    chosen = os.environ.get("RMW_IMPLEMENTATION") or SUPPORTED
    if chosen == SUPPORTED:
        return ""
    return (
        f"RMW_IMPLEMENTATION is set to '{chosen}', but the course's own message types (course_interfaces, %%interface) "
        f"work with {SUPPORTED} only: set RMW_IMPLEMENTATION to that, or unset it, and start again."
    )


def _is_installed(name: str) -> bool:
    import ctypes  # rarely

    try:
        ctypes.CDLL(f"lib{name}.so")
    except OSError:
        return False
    return True
