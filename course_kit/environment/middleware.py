"""The middleware (RMW) that ROS will load, settled before rclpy is imported.

With an RMW_IMPLEMENTATION that is not installed the import of rclpy ends the process, so that a kernel dies without
a word. The ROS wheels have Fast DDS alone; a sourced ROS may have others.
"""

from __future__ import annotations

import os

from course_kit.environment.errors import SettingsError

SUPPORTED = "rmw_fastrtps_cpp"  # the one the live interfaces are made for
VARIABLES = ("RMW_IMPLEMENTATION", "RCL_ASSERT_RMW_ID_MATCHES")  # rcl compares both with what is loaded
# Tells the processes started from here which value of the user's was replaced.
_REPLACED = "COURSE_KIT_RMW_REPLACED"


def settle() -> str:
    """See that ROS can load what the environment asks for, and have it load Fast DDS where it cannot."""
    wanted = {name: os.environ[name] for name in VARIABLES if os.environ.get(name)}
    if set(wanted.values()) <= {SUPPORTED}:
        return ""
    found = _loaded()
    if found is None or set(wanted.values()) == {found}:
        return ""
    name, value = next((name, value) for name, value in wanted.items() if value != found)
    if found != SUPPORTED and not _fast_dds_loads():
        raise SettingsError(
            f"{name} is set to '{value}', which is not installed here, and neither is {SUPPORTED}, which the course "
            "needs. Install ros-jazzy-rmw-fastrtps-cpp, or delete .venv and run ./course in a terminal without ROS."
        )
    for each in VARIABLES:
        os.environ.pop(each, None)
    os.environ["RMW_IMPLEMENTATION"] = SUPPORTED
    os.environ[_REPLACED] = f"{name}={value}"
    return (
        f"{name} is set to '{value}', but no such middleware is installed here: the course uses {SUPPORTED} (Fast "
        f"DDS). Unset {name} to remove this message."
    )


def replaced() -> str:
    """The setting of the user's that was replaced, `RMW_IMPLEMENTATION=rmw_cyclonedds_cpp`; empty when none was."""
    return os.environ.get(_REPLACED, "")


def unsupported() -> str:
    """What to tell about a middleware that works and does not suit the live interfaces; empty when all is well."""
    chosen = os.environ.get("RMW_IMPLEMENTATION") or SUPPORTED
    if chosen == SUPPORTED:
        return ""
    return (
        f"RMW_IMPLEMENTATION is set to '{chosen}', but the course's own message types (course_interfaces, %%interface) "
        f"work with {SUPPORTED} only: set RMW_IMPLEMENTATION to that, or unset it, and start again."
    )


def _loaded() -> str | None:
    """The identifier of the middleware that rcl gets; "" when it gets none, None where there is no rcl."""
    import ctypes

    # rcl compares when it is loaded, and ends the process; the middleware is loaded when it is first asked for.
    kept = {name: os.environ.pop(name) for name in VARIABLES if name in os.environ}
    try:
        rcl = ctypes.CDLL("librcl.so")
        utilities = ctypes.CDLL("librcutils.so")
    except OSError:
        return None
    finally:
        os.environ.update(kept)
    identify = rcl.rmw_get_implementation_identifier
    identify.restype = ctypes.c_char_p
    identifier: bytes | None = identify()
    utilities.rcutils_reset_error()  # what it left would be printed beside the next, unrelated error
    return identifier.decode() if identifier else ""


def _fast_dds_loads() -> bool:
    kept = {name: os.environ.pop(name) for name in VARIABLES if name in os.environ}
    os.environ["RMW_IMPLEMENTATION"] = SUPPORTED
    try:
        return _loaded() == SUPPORTED
    finally:
        del os.environ["RMW_IMPLEMENTATION"]
        os.environ.update(kept)
