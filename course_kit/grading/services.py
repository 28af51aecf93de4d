"""What graders ask of a service server: is it there, does it answer, and if not, why not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading import endings, graph, silence
from course_kit.grading.bench import SubmissionEndedError
from course_kit.grading.checks import Evidence, Failed

if TYPE_CHECKING:
    from course_kit.grading.bench import Bench

_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the services it will make
_NODE_S = 1.5  # a node's name arrives a moment after its endpoints
_OTHER_TYPE_S = 0.5  # the right name with another type: the node was seen to offer just that
_NUDGE_S = 1.0  # an executor with several threads notices a callback's exception with the next request only
_STUCK_S = 3.0  # a callback seen waiting in rclpy for so long waits for itself


@dataclass(frozen=True)
class Service:
    """A service as the exercise names it.

    Attributes:
        name: its full name.
        interface: its class.
        type: the interface's name, `package/srv/Name`.
    """

    name: str
    interface: Any
    type: str


@dataclass(frozen=True)
class Answer:
    """A response and how long it took, in seconds, fairly counted."""

    response: Any
    latency_s: float


def expect_offered(bench: Bench, service: Service, request: Any) -> Evidence:
    """The service is on the graph, with its type, and its program is there to be asked.

    Args:
        bench: the test bench.
        service: what is expected.
        request: any request; whether and how it is answered is for other checks. It tells a server from a
            program that offers a service and ends at once, however fast each is discovered.

    Raises:
        Failed: it is not; with start.*, name.service, type.interface or limit.*.
    """
    expected = f"the service {service.name} of type {service.type}"
    client = bench.tester.client(service.interface, service.name)
    clock = bench.clock()

    def other_type() -> bool:
        return clock.wall() > _OTHER_TYPE_S and any(
            offer.name == service.name and offer.type != service.type for offer in bench.tester.services()
        )

    def settled() -> bool:
        return clock.past(_SETTLED_S) and bool(bench.tester.nodes()) and silence.spins(bench)

    def decided() -> bool:
        return client.service_is_ready() or other_type() or settled()

    try:
        bench.wait_until(decided, bench.job.limits.start_s)
    except SubmissionEndedError as ended:
        diagnosis, message = endings.of_start(ended.life, bench.job)
        raise Failed(Evidence("", expected, "a program that has ended"), message, diagnosis) from None
    if not client.service_is_ready():
        raise _not_offered(bench, service, expected)
    try:
        bench.wait_until(client.call_async(request).done, _NUDGE_S)
    except SubmissionEndedError as ended:
        if ended.diagnosis == "start.exit":
            evidence = Evidence("", expected, "a program that has ended")
            raise Failed(evidence, ended.message, ended.diagnosis) from None
    return Evidence("", expected, expected)


def expect_node(bench: Bench, name: str, service: Service) -> Evidence:
    """A node of this full name is on the graph, beside the service.

    Raises:
        Failed: it is not; with name.node.
    """
    expected = f"a node called {name}"
    try:
        ensure_ready(bench, service)
        found = bench.wait_until(lambda: name in bench.tester.nodes(), _NODE_S)
    except SubmissionEndedError as ended:
        raise Failed(Evidence("", expected, "a program that has ended"), ended.message, ended.diagnosis) from None
    if found:
        return Evidence("", expected, expected)
    nodes = bench.tester.nodes()
    got = f"on the graph: {', '.join(nodes) or 'no node'}"
    message = f"The graph has {graph.listed(nodes, 'node')}, and none is called {name}.{graph.closest(name, nodes)}"
    raise Failed(Evidence("", expected, got), message, "name.node")


def ensure_ready(bench: Bench, service: Service) -> None:
    """Have a running submission that offers the service: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    if bench.spoiled:
        bench.launch()
        client = bench.tester.client(service.interface, service.name)
        try:
            if bench.wait_until(client.service_is_ready, bench.job.limits.start_s):
                return
        except SubmissionEndedError:
            pass
        bench.spoil()
        evidence = Evidence("", f"the service {service.name}, started again", "no service")
        raise Failed(evidence, "An earlier check ended your program, and started again it did not come up.")


def call(bench: Bench, service: Service, request: Any, shown: str, expected: str) -> Answer:
    """Send one request and wait for its answer.

    Args:
        bench: the test bench.
        service: whom to call.
        request: what to send.
        shown: the request as the learner is shown it.
        expected: what a right answer is, in words.

    Raises:
        Failed: none came; with the reason if it can be established.
    """
    ensure_ready(bench, service)
    if bench.time_is_up():
        message = f"Each answer came, but so slowly that the {bench.deadline_s:g} s for this check were over."
        raise Failed(Evidence(shown, expected, "too late to be asked"), message, "service.blocks")
    clock = bench.clock()
    first = bench.tester.client(service.interface, service.name)
    futures = [first.call_async(request)]
    looked = False

    def decided() -> bool:
        nonlocal looked
        if any(future.done() for future in futures):
            return True
        if len(futures) == 1 and clock.wall() > _NUDGE_S:
            other = bench.tester.client(service.interface, service.name, 1)
            futures.append(other.call_async(request))
        if not looked and clock.wall() > _STUCK_S and clock.past(_STUCK_S):
            looked = True
            return silence.doing(bench).waits_for_ros
        return False

    try:
        bench.wait_until(decided, silence.ANSWER_S)
    except SubmissionEndedError as ended:
        evidence = Evidence(shown, expected, "no answer: the program ended")
        raise Failed(evidence, ended.message, ended.diagnosis) from None
    for future in futures:
        if future.done():
            return Answer(future.result(), clock.fair() if clock.wall() > _NUDGE_S else clock.wall())
    raise silence.unanswered(bench, shown, expected)


def _not_offered(bench: Bench, service: Service, expected: str) -> Failed:
    offers, nodes = bench.tester.services(), bench.tester.nodes()
    bench.spoil()
    got = "; ".join(f"{offer.name} [{offer.type}]" for offer in offers) or graph.listed(nodes, "node")
    evidence = Evidence("", expected, f"on the graph: {got}")
    same_name = [offer for offer in offers if offer.name == service.name]
    if same_name:
        message = f"The service {service.name} is there with the type {same_name[0].type} instead of {service.type}."
        return Failed(evidence, message, "type.interface")
    if offers:
        alike = [offer for offer in offers if offer.type == service.type] or offers
        message = f"No service is called {service.name}.{graph.closest(service.name, [offer.name for offer in alike])}"
        return Failed(evidence, message, "name.service")
    if nodes:
        return Failed(evidence, f"Your node {nodes[0]} is up, and offers no service.", None)
    return Failed(evidence, *graph.why_empty(bench, service.name)[::-1])
