"""All one can observe of a package's types, as JSON; run as a program it prints those of the compiled package."""

from __future__ import annotations

import importlib
import json
import sys
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces.message_fields import record_of
from tests.interfaces.test_against_compiled import facts
from tests.interfaces.twins import description_by_c, hash_by_c, random_message, seeded, sources_by_c

PACKAGE = "reference_interfaces"
_PARTS = {
    "msg": [""],
    "srv": ["", "_Request", "_Response", "_Event"],
    "action": [
        *("", "_Goal", "_Result", "_Feedback", "_FeedbackMessage"),
        *(f"_SendGoal{part}" for part in ("", "_Request", "_Response", "_Event")),
        *(f"_GetResult{part}" for part in ("", "_Request", "_Response", "_Event")),
    ],
}
_TYPES = ("msg/Waypoint", "msg/Nothing", "srv/Plan", "srv/Poke", "action/Navigate")
NAMES = [f"{name}{part}" for name in _TYPES for part in _PARTS[name.split("/")[0]]]


def facts_of_package() -> dict[str, Any]:
    return {name: facts_of(name) for name in NAMES}


def facts_of(name: str) -> dict[str, Any]:
    folder, _, full = name.partition("/")
    module = f"{PACKAGE}.{folder}._{full.partition('_')[0].lower()}"
    cls: Any = getattr(importlib.import_module(module), full)
    found = {
        "class": repr(facts(cls)),
        "hash": hash_by_c(cls).hex(),
        "description": repr(description_by_c(cls)),
        "sources": [[type_name, encoding, text.rstrip()] for type_name, encoding, text in sources_by_c(cls)],
    }
    if hasattr(cls, "SLOT_TYPES"):
        rng = seeded(name)
        messages = [cls(), *(random_message(cls, rng) for _ in range(10))]
        # Compiled code leaves padding uninitialised and may append to a payload; decoding tells what counts.
        found["messages"] = [repr(deserialize_message(serialize_message(message), cls)) for message in messages]
        found["equal"] = found["messages"] == [repr(message) for message in messages]
    return found


if __name__ == "__main__":
    from reference_interfaces.msg import Waypoint

    if record_of(Waypoint) is not None:
        sys.exit("this is not the compiled package")
    sys.stdout.write(json.dumps(facts_of_package()))
