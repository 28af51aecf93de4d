"""Plots of a real topic: what they take, what they leave out, how they end."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseArray, PoseWithCovariance, Twist
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool, Float64, String

from course_kit import lab, panels
from course_kit.panels.plotting import NumberField, thin_samples
from tests.waiting import wait_until

pytestmark = pytest.mark.usefixtures("live_lab")


def drawn(panel: Any) -> list[float]:
    """The values the page has, in order."""
    return list(np.frombuffer(panel.widget.samples).reshape(-1, 2)[:, 1])


def test_each_message_is_a_point_and_time_goes_on() -> None:
    panel = panels.plot("/speed", Twist, "linear.x")
    for value in (1.0, 2.0, 0.5):
        lab.publish("/speed", Twist, linear={"x": value})
    assert [value for _, value in panel.samples] == [1.0, 2.0, 0.5]
    times = [at for at, _ in panel.samples]
    assert times == sorted(times)
    wait_until(lambda: drawn(panel) == [1.0, 2.0, 0.5])
    assert panel.widget.count == 3


def test_it_is_described_in_words() -> None:
    panel = panels.plot("/speed", Twist, "linear.x")
    bundle = panel._repr_mimebundle_()
    text = "A plot of linear.x of /speed [geometry_msgs/msg/Twist] against time, the last 20 seconds."
    assert bundle["text/plain"] == text
    assert "application/vnd.jupyter.widget-view+json" in bundle


def test_what_is_older_than_the_seconds_shown_is_forgotten() -> None:
    panel = panels.plot("/speed", Float64, "data", seconds=0.2)
    lab.publish("/speed", Float64, data=1.0)
    first = panel.samples[0][0]
    wait_until(lambda: time.monotonic() - panel._begun > first + 0.3)
    lab.publish("/speed", Float64, data=2.0)
    assert [value for _, value in panel.samples] == [2.0]
    with pytest.raises(lab.LabError, match="a number of seconds"):
        panels.plot("/speed", Float64, "data", seconds=0)


def test_it_also_hears_a_best_effort_publisher_that_comes_later() -> None:
    class Sensor(Node):
        def __init__(self) -> None:
            super().__init__("sensor")
            profile = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
            publisher = self.create_publisher(Float64, "level", profile)
            self.create_timer(0.01, lambda: publisher.publish(Float64(data=3.5)))

    panel = panels.plot("/level", Float64, "data")
    lab.start(Sensor)
    wait_until(lambda: len(panel.samples) > 3)
    assert {value for _, value in panel.samples} == {3.5}


def test_a_fast_topic_does_not_flood_the_page() -> None:
    panel = panels.plot("/speed", Float64, "data")
    sent: list[Any] = []
    panel.widget.observe(sent.append, "samples")
    for number in range(300):
        lab.publish("/speed", Float64, data=float(number))
    wait_until(lambda: drawn(panel)[-1:] == [299.0])
    assert len(sent) < 100


def test_after_its_end_nothing_is_left_on_the_graph() -> None:
    panel = panels.plot("/speed", Float64, "data")
    looking = lab.current().engine.node
    assert looking.count_subscribers("/speed") == 1
    again = panels.plot("/speed", Float64, "data")
    assert looking.count_subscribers("/speed") == 1
    assert "Run its cell again" in panel.widget.ended
    again.close()
    assert looking.count_subscribers("/speed") == 0
    lab.publish("/speed", Float64, data=1.0)
    assert again.samples == []


@pytest.mark.parametrize(
    ("message_type", "path", "message"),
    [
        (Twist, "linar.x", "no field 'linar' in a geometry_msgs/msg/Twist; .* Did you mean 'linear'"),
        (Twist, "linear", "'linear' is not a number but a geometry_msgs/Vector3. In it: linear.x, linear.y, linear.z"),
        (Twist, "linear.x.y", "no field 'y' in a double; it has none"),
        (Twist, "linear x", "is not a path to a field, such as .data."),
        (String, "data", "'data' is not a number but a string"),
        (LaserScan, "ranges", r"not a number but a sequence<float>. Take one element: 'ranges\[0\]'"),
        (42, "data", "42 is not a message type"),
    ],
)
def test_a_field_that_is_no_number_is_said_at_once(message_type: Any, path: str, message: str) -> None:
    with pytest.raises(lab.FieldError, match=message):
        panels.plot("/speed", message_type, path)


def test_numbers_are_found_inside_messages_and_arrays() -> None:
    covariance = PoseWithCovariance()
    covariance.covariance[7] = 0.25
    assert NumberField(PoseWithCovariance, "covariance[7]").read_number(covariance) == 0.25
    assert NumberField(Bool, "data").read_number(Bool(data=True)) == 1.0
    scan = LaserScan(ranges=[1.0, 2.0])
    assert NumberField(LaserScan, "ranges[1]").read_number(scan) == 2.0
    assert NumberField(LaserScan, "ranges[2]").read_number(scan) is None
    assert NumberField(PoseArray, "poses[0].position.x").read_number(PoseArray()) is None


def test_thinning_keeps_peaks_and_the_latest_value() -> None:
    samples = np.column_stack([np.arange(10_000.0), np.zeros(10_000)])
    samples[1234, 1], samples[7777, 1], samples[-1, 1] = 5.0, -3.0, 0.5
    left = thin_samples(samples, 600)
    assert len(left) <= 600
    assert {5.0, -3.0} <= set(left[:, 1])
    assert list(left[-1]) == [9999.0, 0.5]
    assert (np.diff(left[:, 0]) > 0).all()
    assert thin_samples(samples[:600], 600) is not None
    assert len(thin_samples(samples[:600], 600)) == 600
    assert len(thin_samples(np.full((5000, 2), np.nan), 100)) <= 100
