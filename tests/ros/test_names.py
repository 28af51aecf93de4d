"""Names on the graph."""

from __future__ import annotations

import pytest

from course_kit.ros import names

GRAPH = ["/robot/add_two_ints", "/set_power", "/fibonacci", "/camera/left/image"]


@pytest.mark.parametrize(
    ("wanted", "meant"),
    [
        ("/add_two_ints", "/robot/add_two_ints"),  # another namespace
        ("/set_powr", "/set_power"),  # a slip
        ("/fib", "/fibonacci"),  # the beginning of it
        ("/ad_two_ints", "/robot/add_two_ints"),  # both
        ("/SET_POWER", "/set_power"),
        ("/image", "/camera/left/image"),
        ("/weather", None),
        ("", None),
        ("/set_power" * 100_000, None),  # nobody's slip; comparing takes the product of the lengths
    ],
)
def test_the_nearest_name(wanted: str, meant: str | None) -> None:
    assert names.nearest_name(wanted, [*GRAPH, "/x" * 500_000]) == meant
    assert names.did_you_mean(wanted, GRAPH) == (f" Did you mean {meant}?" if meant else "")


def test_what_ros_brings_along() -> None:
    assert names.is_of_every_node("/a/b/set_parameters")
    assert not names.is_of_every_node("/set_speed")
    assert names.is_of_ros("/rosout")
    assert names.is_hidden("/fibonacci/_action/status")
    assert not names.is_hidden("/a_b/c_")
