"""A number of a topic against time, drawn while it arrives."""

from __future__ import annotations

import threading
import time
from collections import deque
from typing import TYPE_CHECKING

import anywidget
import numpy as np
import traitlets

from course_kit import lab
from course_kit.lab.topics import Subscription
from course_kit.panels.base import Latest, Panel, of_files
from course_kit.panels.number_field import NumberField
from course_kit.panels.plot_picture import plot_svg
from course_kit.panels.still import still
from course_kit.ros.messages import type_name

if TYPE_CHECKING:
    import numpy.typing as npt
    from rclpy.qos import QoSProfile

    Samples = npt.NDArray[np.float64]
    from course_kit.ros.messages import Message

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
        self._updates = Latest(self._show)
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
        samples = thinned(np.array(self.samples, dtype=np.float64), _DRAWN)
        return still(self.describe(), plot_svg(samples.tolist(), self.seconds, self.field), "still_drawings.css")

    def _take(self, message: Message) -> None:
        """A message has come; on the lab's thread."""
        value = self._number.of(message)
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
            self.widget.samples = thinned(samples, _DRAWN).tobytes()

    def _end(self) -> None:
        self.widget.ended = _ENDED


def thinned(samples: Samples, most: int) -> Samples:
    """At most so many samples, and among them the highest and lowest of each stretch, so that no peak is lost."""
    if len(samples) <= most:
        return samples
    kept = []
    for stretch in np.array_split(np.arange(len(samples)), most // 2):
        values = samples[stretch, 1]
        if np.isnan(values).all():
            kept.append(stretch[0])
            continue
        kept += sorted({stretch[np.nanargmin(values)], stretch[np.nanargmax(values)]})
    kept[-1] = len(samples) - 1  # the latest one is shown as text
    return samples[kept]


def _quality(topic: str) -> QoSProfile:
    """A QoS profile that takes what publishers offer, also those that come later."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    publishers = lab.current().engine.node.count_publishers("/" + str(topic).strip("/"))
    reliability = ReliabilityPolicy.BEST_AVAILABLE if publishers else ReliabilityPolicy.BEST_EFFORT
    return QoSProfile(depth=_DEPTH, reliability=reliability)
