"""A node's name arrives a moment after its endpoints, and is waited for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest

from course_kit.grading.checks import discovery
from course_kit.grading.checks.check import Failed

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.context import CheckContext


def context(*graphs: list[str]) -> CheckContext:
    """One in which the graph has these nodes, one look after the other, and at last those of the last look."""
    left = list(graphs)

    def wait_until(condition: Callable[[], bool], *_: float, **__: Any) -> bool:
        return any(condition() for _ in range(5))

    node = SimpleNamespace(nodes=lambda: left.pop(0) if len(left) > 1 else left[0])
    return cast("CheckContext", SimpleNamespace(grader_node=node, wait_until=wait_until))


def test_a_late_name_is_waited_for() -> None:
    assert discovery.first_node(context([], [], ["/counter"])) == "/counter"


def test_a_program_without_a_node_fails_in_words() -> None:
    with pytest.raises(Failed, match="no node"):
        discovery.first_node(context([]))
