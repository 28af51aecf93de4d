"""A type is defined anew while nodes of the old definition live, on the same names: nobody gets anything wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment, interfaces
from tests.interfaces.spun import Spun

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


class Graph(Spun):
    """Two nodes in one process, spun while a test waits."""

    def __init__(self, domain: int) -> None:
        super().__init__(domain, "old", "new")
        self.old, self.new = self.nodes


@pytest.fixture
def graph(domain: int) -> Iterator[Graph]:
    made = Graph(domain)
    yield made
    made.close()


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Definitions of tests are not saved among the learner's."""
    monkeypatch.setattr(environment, "run_dir", lambda: tmp_path)


OLD_INFO, NEW_INFO = "string name\nint32 age\n", "float64[] values\nstring name\nbool ok\n"
OLD_ASK, NEW_ASK = (
    "string question\n---\nint64 answer\n",
    "int64[] question\nfloat64 weight\n---\nstring answer\nbool sure\n",
)


def test_topic_with_old_and_new_endpoints(graph: Graph, capfd: pytest.CaptureFixture[str]) -> None:
    old = interfaces.define("redefined_topic/msg/Info", OLD_INFO)
    got: dict[str, list[Any]] = {"old": [], "new": []}
    old_publisher = graph.old.create_publisher(old, "info", 10)
    graph.old.create_subscription(old, "info", got["old"].append, 10)

    new = interfaces.define("redefined_topic/msg/Info", NEW_INFO)
    assert new is not old
    from redefined_topic.msg import Info

    assert Info is new
    new_publisher = graph.new.create_publisher(new, "info", 10)
    graph.new.create_subscription(new, "info", got["new"].append, 10)
    graph.wait_for(lambda: old_publisher.get_subscription_count() == 2, "both subscriptions")
    graph.wait_for(lambda: new_publisher.get_subscription_count() == 2, "both subscriptions")
    big = [0.5] * 100_000  # far beyond what the first type of that name has ever needed
    for age in range(5):
        old_publisher.publish(old(name="old", age=age))
        new_publisher.publish(new(values=big, name="new", ok=True))
    graph.wait_for(lambda: len(got["old"]) == len(got["new"]) == 5, "five messages each")
    assert [message.age for message in got["old"]] == list(range(5))
    assert all(message.values.tolist() == big and message.ok for message in got["new"])
    assert capfd.readouterr().err.count("dropped a message that is not a redefined_topic/msg/Info") == 2


def test_service_with_old_and_new_endpoints(graph: Graph) -> None:
    asked = []
    old = interfaces.define("redefined_service/srv/Ask", OLD_ASK)

    def old_answer(request: Any, response: Any) -> Any:
        asked.append(request)
        response.answer = len(request.question)
        return response

    def new_answer(request: Any, response: Any) -> Any:
        asked.append(request)
        response.answer, response.sure = f"{list(request.question)} {request.weight}", True
        return response

    old_service = graph.old.create_service(old, "ask", old_answer)
    old_client = graph.old.create_client(old, "ask")
    new = interfaces.define("redefined_service/srv/Ask", NEW_ASK)
    new_client = graph.new.create_client(new, "ask")
    lost = [new_client.call_async(new.Request(question=question, weight=2.0)) for question in ([], [1, 2, 3])]
    assert graph.answer(old_client, old.Request(question="abc")).answer == 3
    assert not any(future.done() for future in lost)
    assert [type(request) for request in asked] == [old.Request]

    graph.old.destroy_service(old_service)
    graph.new.create_service(new, "ask", new_answer)
    lost.append(old_client.call_async(old.Request(question="abc")))
    for _ in range(3):
        answer = graph.answer(new_client, new.Request(question=[1, 2], weight=0.5))
        assert (answer.answer, answer.sure) == ("[1, 2] 0.5", True)
    assert not any(future.done() for future in lost)
    assert {type(request) for request in asked[1:]} == {new.Request}


def test_a_message_within_a_service_is_defined_anew() -> None:
    interfaces.define("redefined_part/msg/Address", "string street\n")
    before = interfaces.define("redefined_part/srv/Move", "Address to\n---\n")
    address = interfaces.define("redefined_part/msg/Address", "string street\nint32 number\n")
    after = interfaces.get_type("redefined_part/srv/Move")
    assert after is not before
    assert isinstance(after.Request().to, address)
    assert not hasattr(before.Request().to, "number")
    from redefined_part.srv import Move

    assert Move is after


def test_an_invalid_text_leaves_the_old_definition() -> None:
    first = interfaces.define("redefined_invalid/msg/Info", OLD_INFO)
    with pytest.raises(interfaces.InterfaceDefinitionError):
        interfaces.define("redefined_invalid/msg/Info", "sting name\n")
    assert interfaces.get_type("redefined_invalid/msg/Info") is first
