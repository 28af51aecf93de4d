"""A number of a topic against time, drawn while it arrives."""

from __future__ import annotations

import math
import re
import threading
import time
from collections import deque
from itertools import pairwise
from statistics import median
from typing import TYPE_CHECKING

import anywidget
import numpy as np
import traitlets

from course_kit import lab
from course_kit.interfaces.message_fields import message_fields
from course_kit.lab.errors import FieldError
from course_kit.lab.topics import Subscription
from course_kit.panels.base import LatestValue, Panel, draw, of_files, still
from course_kit.ros.filling import unknown_field
from course_kit.ros.messages import is_message_type, type_name

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import numpy.typing as npt
    from rclpy.qos import QoSProfile

    from course_kit.ros.messages import Message

    Samples = npt.NDArray[np.float64]

_KEPT = 20_000  # samples, however fast they come
_DRAWN = 600  # points a line has at most; a screen has hardly more
_DEPTH = 100
_ENDED = "This plot has ended. Run its cell again to go on."


class PlotWidget(anywidget.AnyWidget):
    """The plot as the page has it."""

    _esm = of_files("plotting.js")
    _css = of_files("frame.css", "plotting.css")
    topic = traitlets.Unicode().tag(sync=True)
    field = traitlets.Unicode().tag(sync=True)
    span = traitlets.Float().tag(sync=True)
    samples = traitlets.Bytes().tag(sync=True)
    count = traitlets.Int().tag(sync=True)
    ended = traitlets.Unicode().tag(sync=True)


class Plot(Panel):
    """The last seconds of one number of a topic."""

    def __init__(self, topic: str, message_type: type[Message], field: str, seconds: float) -> None:
        if not seconds > 0:
            raise lab.LabError(f"A plot needs a number of seconds, such as 20, not {seconds!r}.")
        self._number = NumberField(message_type, field)
        super().__init__(topic, field)
        self.topic, self.field, self.seconds = topic, field, float(seconds)
        self._type = type_name(message_type)
        self._begun = time.monotonic()
        self._lock = threading.Lock()
        self._samples: deque[tuple[float, float]] = deque(maxlen=_KEPT)
        self._count = 0
        self.widget = PlotWidget(topic=topic, field=field, span=self.seconds)
        self.at_close(self._end)
        self._updates = LatestValue(self._show)
        self.at_close(self._updates.close)
        self.at_close(Subscription(lab.current().engine, topic, message_type, self._take, _quality(topic)).close)

    @property
    def samples(self) -> list[tuple[float, float]]:
        """Time and value of what is shown, oldest first; the time in seconds since the plot began."""
        with self._lock:
            return list(self._samples)

    def describe(self) -> str:
        """What is drawn."""
        return f"A plot of {self.field} of {self.topic} [{self._type}] against time, the last {self.seconds:g} seconds."

    def still(self) -> str:
        """What has come so far, against time."""
        samples = thin_samples(np.array(self.samples, dtype=np.float64), _DRAWN)
        return still(self.describe(), plot_svg(samples.tolist(), self.seconds, self.field), "still_drawings.css")

    def _take(self, message: Message) -> None:
        """A message has come; on the lab's thread."""
        value = self._number.read_number(message)
        if value is None:
            return
        now = time.monotonic() - self._begun
        with self._lock:
            self._samples.append((now, value))
            self._count += 1
            while self._samples[0][0] < now - self.seconds:
                self._samples.popleft()
        self._updates.put(None)

    def _show(self, _: None) -> None:
        with self._lock:
            samples, count = np.array(self._samples, dtype=np.float64), self._count
        with self.widget.hold_sync():
            self.widget.count = count
            self.widget.samples = thin_samples(samples, _DRAWN).tobytes()

    def _end(self) -> None:
        self.widget.ended = _ENDED


def thin_samples(samples: Samples, most: int) -> Samples:
    """At most so many samples, and among them the highest and lowest of each stretch, so that no peak is lost."""
    if len(samples) <= most:
        return samples
    places = []
    for stretch in np.array_split(np.arange(len(samples)), most // 2):
        values = samples[stretch, 1]
        if np.isnan(values).all():
            places.append(stretch[0])
            continue
        places += sorted({stretch[np.nanargmin(values)], stretch[np.nanargmax(values)]})
    places[-1] = len(samples) - 1  # the latest one is shown as text
    return samples[places]


def _quality(topic: str) -> QoSProfile:
    """A QoS profile that takes what publishers offer, also those that come later."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    publishers = lab.current().engine.node.count_publishers("/" + str(topic).strip("/"))
    reliability = ReliabilityPolicy.BEST_AVAILABLE if publishers else ReliabilityPolicy.BEST_EFFORT
    return QoSProfile(depth=_DEPTH, reliability=reliability)


_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")


class NumberField:
    """A path to a number in messages of a type."""

    def __init__(self, message_type: type[Message], path: str) -> None:
        if not is_message_type(message_type):
            raise FieldError(f"{getattr(message_type, '__name__', message_type)!r} is not a message type.")
        self.path = path
        self._steps: list[str | int] = []
        self._check(message_type)

    def read_number(self, message: Message) -> float | None:
        """The number; None in a message whose array is too short."""
        for step in self._steps:
            if isinstance(step, int):
                if step >= len(message):
                    return None
                message = message[step]
            else:
                message = getattr(message, step)
        return float(message)

    def _check(self, message_type: type[Message]) -> None:
        current: type[Message] | None = message_type
        owner, kind = type_name(message_type), None
        for part in self.path.split("."):
            found = _PART.fullmatch(part)
            if found is None:
                raise FieldError(
                    f"{self.path!r} is not a path to a field, such as 'data' or 'linear.x' or 'ranges[0]'."
                )
            name, indices = found[1], [int(index) for index in re.findall(r"\d+", found[2])]
            fields = {field.name: field for field in message_fields(current)} if current is not None else {}
            if name not in fields:
                raise FieldError(unknown_field(name, fields, f"a {owner}"))
            self._steps += [name, *indices]
            kind = fields[name].type.element if indices else fields[name].type
            owner, current = str(kind), None if kind.container else fields[name].nested
        if kind is None or kind.container or kind.primitive is None or kind.base == "octet":
            raise FieldError(self._no_number(owner, current))

    def _no_number(self, kind: str, current: type[Message] | None) -> str:
        text = f"{self.path!r} is not a number but a {kind}."
        if current is not None:
            inside = [f"{self.path}.{field.name}" for field in message_fields(current)]
            return f"{text} In it: {', '.join(inside)}."
        return f"{text} Take one element: '{self.path}[0]'." if "[" in kind or "sequence" in kind else text


_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 626, 12, 200  # of the frame, in the template's user units
_SAME = 1e-5  # of a number: what differs by less is drawn as one; its marks would be too long to read
_LEAST_GAP = 0.5  # seconds without a message that the line never goes across


def plot_svg(samples: Sequence[Sequence[float]], span: float, field: str) -> str:
    """The drawing as an `svg` element, which templates take as it is."""
    finite = [value for _, value in samples if math.isfinite(value)]
    marks = _marks(*_range(finite))
    low, high = marks[0], marks[-1]
    now = samples[-1][0] if samples else 0.0

    def x_of(seconds: float) -> float:
        return round(_LEFT + (seconds + span) / span * (_RIGHT - _LEFT), 1)

    def y_of(value: float) -> float:
        return round(_TOP + (high - value) / (high - low) * (_BOTTOM - _TOP), 1)

    gap = max([_LEAST_GAP, *([8 * median(b[0] - a[0] for a, b in pairwise(samples))] if len(samples) > 1 else [])])
    line, before = "", -math.inf
    for at, value in samples:
        if math.isfinite(value):
            line += f"{'L' if at - before <= gap else 'M'}{x_of(at - now)} {y_of(value)}"
            before = at
        else:
            before = -math.inf
    text = f"The latest value is {finite[-1]:.4g}." if finite else "No message yet."
    return draw(
        "still_plot.svg",
        summary=f"{field} against time. {text}",
        field=field,
        rows=[(y_of(mark), f"{mark:.4g}") for mark in marks],
        columns=[(x_of(mark), f"{mark:.4g}") for mark in _marks(-span, 0.0) if mark >= -span],
        line=line,
    )


def _range(values: Sequence[float]) -> tuple[float, float]:
    """What the vertical axis has to cover; never nothing."""
    low, high = (min(values), max(values)) if values else (0.0, 1.0)
    if high - low > _SAME * max(abs(low), abs(high)):
        return low, high
    room = abs(low) * 0.2 or 1.0
    return low - room, high + room


def _marks(low: float, high: float) -> list[float]:
    """Round numbers that cover a stretch in about four steps."""
    exact = (high - low) / 4
    power = 10.0 ** math.floor(math.log10(exact))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= exact * 0.999)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [float(f"{number * step:.12g}") for number in range(first, last + 1)]


class Comparison:
    """Numbers side by side: bars that do not move, so no widget, which would be dead on the next day."""

    def __init__(self, title: str, values: Mapping[str, float], unit: str) -> None:
        if not values or not all(math.isfinite(value) and value >= 0 for value in values.values()):
            raise ValueError(f"compare needs at least one number, finite and not below zero; got {dict(values)!r}.")
        self._title = title
        self._order = sorted(values, key=lambda name: values[name])
        longest = max(values.values()) or 1.0
        self._drawn = draw("comparison.html", title=title, values=values, unit=unit, longest=longest)

    def _repr_mimebundle_(self, **_options: object) -> dict[str, str]:
        return {"text/plain": repr(self), "text/html": str(self._drawn)}

    def __repr__(self) -> str:
        """The order without the numbers, which no two runs share."""
        return f"{self._title}, smallest first: {', '.join(self._order)}."
