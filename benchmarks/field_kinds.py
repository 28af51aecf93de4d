"""Each kind of field, live against compiled, each way: `python benchmarks/field_kinds.py [WORD]`.

The compiled class of the wheels, and a live one made of the same text, with the checks on that the course switches on.
What is measured is processor time, both sides in turns; what counts is the ratio of the medians. A WORD measures only
the kinds that have it in their name.
"""

from __future__ import annotations

import array
import statistics
import sys
import time
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces.catalogue import installed_text
from course_kit.interfaces.definition import TypeName
from course_kit.interfaces.library import Library
from course_kit.interfaces.message_fields import message_class

if TYPE_CHECKING:
    from collections.abc import Callable

AIM = 1.1
_BATCH_S, _ROUNDS = 0.004, 25


class Kind(NamedTuple):
    """A field to measure.

    Attributes:
        name: what it is.
        type: the message's full name.
        field: the field's name.
        value: makes the value, of the messages' nested class where there is one.
    """

    name: str
    type: str
    field: str
    value: Callable[[], object]


def _poses(count: int) -> list[Any]:
    pose = message_class("geometry_msgs/msg/Pose")
    return [pose() for _ in range(count)]


KINDS = [
    Kind("bool", "std_msgs/msg/Bool", "data", lambda: True),
    Kind("int64", "std_msgs/msg/Int64", "data", lambda: -5),
    Kind("float64", "geometry_msgs/msg/Point", "y", lambda: 2.5),
    Kind("float32", "std_msgs/msg/Float32", "data", lambda: 2.5),
    Kind("string", "std_msgs/msg/String", "data", lambda: "some words, as they are usual"),
    Kind("byte", "std_msgs/msg/Byte", "data", lambda: b"a"),
    Kind("a message", "geometry_msgs/msg/Pose", "position", message_class("geometry_msgs/msg/Point")),
    Kind("image: uint8[], 900 kB of bytes", "sensor_msgs/msg/Image", "data", lambda: bytes(range(225)) * 4096),
    Kind("image: uint8[], 900 kB of array", "sensor_msgs/msg/Image", "data", lambda: array.array("B", bytes(921600))),
    Kind("image: uint8[], 90 kB of numpy's bytes", "sensor_msgs/msg/Image", "data", np.zeros(92160, "u1").tobytes),
    Kind("point cloud: uint8[], 2 MB of bytes", "sensor_msgs/msg/PointCloud2", "data", lambda: bytes(2_000_000)),
    Kind("uint8[], 1000 of a list", "sensor_msgs/msg/Image", "data", lambda: list(range(250)) * 4),
    Kind("int8[], 10,000 of a list", "nav_msgs/msg/OccupancyGrid", "data", lambda: [-1, 100] * 5000),
    Kind("float32[], 1000 of a list", "sensor_msgs/msg/LaserScan", "ranges", lambda: [0.5] * 1000),
    Kind("float64[], 1000 of a list", "std_msgs/msg/Float64MultiArray", "data", lambda: [0.5] * 1000),
    Kind("float64[], 1000 of array", "std_msgs/msg/Float64MultiArray", "data", lambda: array.array("d", [0.5] * 1000)),
    Kind("int64[], 1000 of a list", "std_msgs/msg/Int64MultiArray", "data", lambda: list(range(1000))),
    Kind("float64[36], of a list", "geometry_msgs/msg/PoseWithCovariance", "covariance", lambda: [0.5] * 36),
    Kind("float64[36], of numpy", "geometry_msgs/msg/PoseWithCovariance", "covariance", lambda: np.zeros(36)),
    Kind("bool[], 1000", "rcl_interfaces/msg/ParameterValue", "bool_array_value", lambda: [True, False] * 500),
    Kind("byte[], 1000", "std_msgs/msg/ByteMultiArray", "data", lambda: [b"a", b"b"] * 500),
    Kind("string[], 100", "sensor_msgs/msg/JointState", "name", lambda: ["a joint"] * 100),
    Kind("200 poses", "geometry_msgs/msg/PoseArray", "poses", lambda: _poses(200)),
]


def live_twin(full_name: str) -> Any:
    """A live class of the same text as a compiled one; messages in it are the compiled ones, as in one's own types."""
    name = TypeName(*full_name.split("/"))
    built = Library(lambda wanted: installed_text(*wanted)).get(name)
    assert built is not None  # noqa: S101
    return built.classes[name.name]


def ways(cls: Any, kind: Kind) -> dict[str, Callable[[], object]]:
    """What is done with a message, by the name of the column."""
    value = kind.value()
    message = cls(**{kind.field: value})
    payload = serialize_message(message)
    arguments = {kind.field: value}
    return {
        "make": lambda: cls(**arguments),
        "assign": lambda: setattr(message, kind.field, value),
        "read": lambda: getattr(message, kind.field),
        "serialise": lambda: serialize_message(message),
        "deserialise": lambda: deserialize_message(payload, cls),
    }


def _processor_time(work: Callable[[], object], times: int) -> float:
    started = time.process_time()
    for _ in range(times):
        work()
    return time.process_time() - started


def ratio(compiled: Callable[[], object], live: Callable[[], object]) -> float:
    """Processor time of the live side for each of the compiled one's, medians of batches taken in turns."""
    times = 1
    while _processor_time(compiled, times) + _processor_time(live, times) < 2 * _BATCH_S:
        times *= 2
    pairs = [(_processor_time(compiled, times), _processor_time(live, times)) for _ in range(_ROUNDS)]
    before, after = (statistics.median(side) for side in zip(*pairs, strict=True))
    return after / before


def main() -> int:
    """Print the table; the exit code says whether the aim was missed."""
    word = sys.argv[1] if len(sys.argv) > 1 else ""
    missed = 0
    columns = "".join(f"{way:>12}" for way in ("make", "assign", "read", "serialise", "deserialise"))
    print(f"live / compiled, aim {AIM}\n\n  {'':<40}{columns}")
    for kind in [kind for kind in KINDS if word in kind.name]:
        compiled, live = ways(message_class(kind.type), kind), ways(live_twin(kind.type), kind)
        ratios = {way: ratio(compiled[way], live[way]) for way in compiled}
        missed += sum(value > AIM for value in ratios.values())
        cells = "".join(f"{value:>10.2f}{'!' if value > AIM else ' '} " for value in ratios.values())
        print(f"  {kind.name:<40}{cells}", flush=True)
    print(f"\n{missed} above {AIM}: {'MISSED' if missed else 'met'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
