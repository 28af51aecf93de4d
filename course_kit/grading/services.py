"""What graders ask of a service server: is it there, does it answer, and if not, why not."""

from __future__ import annotations

import ast
import difflib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading import endings
from course_kit.grading.bench import SubmissionEndedError
from course_kit.grading.checks import Evidence, Failed
from course_kit.grading.traces import Activity, activity

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.bench import Bench, Life

_SETTLED_S = 2.0  # a node that is up and spinning for so long has made the services it will make
_OTHER_TYPE_S = 0.5  # the right name with another type: the node was seen to offer just that
_NUDGE_S = 1.0  # an executor with several threads notices a callback's exception with the next request only
_STUCK_S = 3.0  # a callback seen waiting in rclpy for so long waits for itself
_ANSWER_S = 5.0  # one answer
_LOOK_S = 0.3  # how long it is watched to tell which
_IDLE_SHARE = 0.5  # below this share of one processor a program that does not answer is waiting, not computing


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


def expect_offered(bench: Bench, service: Service) -> Evidence:
    """The service is on the graph, with its type.

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
        return clock.wall() > _SETTLED_S and bool(bench.tester.nodes()) and clock.past(_SETTLED_S) and _spins(bench)

    def decided() -> bool:
        return client.service_is_ready() or other_type() or settled()

    try:
        bench.wait_until(decided, bench.job.limits.start_s)
    except SubmissionEndedError as ended:
        bench.spoil()
        diagnosis, message = endings.of_start(ended.life, bench.job)
        raise Failed(Evidence("", expected, "a program that has ended"), message, diagnosis) from None
    if client.service_is_ready():
        return Evidence("", expected, expected)
    raise _not_offered(bench, service, expected)


def expect_node(bench: Bench, name: str) -> Evidence:
    """A node of this full name is on the graph.

    Raises:
        Failed: it is not; with name.node.
    """
    expected = f"a node called {name}"
    try:
        found = bench.wait_until(lambda: name in bench.tester.nodes(), _SETTLED_S)
    except SubmissionEndedError as ended:
        bench.spoil()
        diagnosis, message = endings.of_call(ended.life, bench.job)
        raise Failed(Evidence("", expected, "a program that has ended"), message, diagnosis) from None
    if found:
        return Evidence("", expected, expected)
    nodes = bench.tester.nodes()
    got = f"on the graph: {', '.join(nodes) or 'no node'}"
    message = f"The graph has {_listed(nodes, 'node')}, and none is called {name}.{_closest(name, nodes)}"
    raise Failed(Evidence("", expected, got), message, "name.node")


def ensure_ready(bench: Bench, service: Service) -> None:
    """Have a running submission that offers the service: one that has died or hangs is started again.

    Raises:
        Failed: it does not come up a second time.
    """
    if bench.spoiled:
        bench.launch()
        expect_offered(bench, service)


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
            return _doing(bench).waits_for_ros
        return False

    try:
        bench.wait_until(decided, _ANSWER_S)
    except SubmissionEndedError as ended:
        bench.spoil()
        diagnosis, message = endings.of_call(ended.life, bench.job)
        raise Failed(Evidence(shown, expected, "no answer: the program ended"), message, diagnosis) from None
    for future in futures:
        if future.done():
            return Answer(future.result(), clock.fair() if clock.wall() > _NUDGE_S else clock.wall())
    raise unanswered(bench, shown, expected)


def unanswered(bench: Bench, shown: str, expected: str) -> Failed:
    """Establish why a program that lives on does not answer."""
    bench.spoil()
    clock = bench.clock()
    before = bench.life(fresh=True)
    doing = _doing(bench)
    bench.wait_until(lambda: clock.wall() > _LOOK_S, _LOOK_S)
    life = bench.life(fresh=True)
    busy = _computes(before, life, clock.wall())
    evidence = Evidence(shown, expected, f"no answer within {_ANSWER_S:g} s; the program is still running")
    diagnosis, message = _why_silent(bench, doing, busy=busy)
    if diagnosis is None and (logged := endings.of_logged(life.stderr, bench.job)):
        diagnosis, message = logged
    return Failed(evidence, message, diagnosis)


def _why_silent(bench: Bench, doing: Activity, *, busy: bool) -> endings.Cause:
    job = bench.job
    if doing.callback is not None:
        where = endings.source_line(job, doing.callback.line)
        if doing.waits_for_ros or _waits_for_a_future(job.source, doing.callback.line):
            return "service.deadlock", f"Your callback has stopped in {where}: it waits there for ROS, and ROS waits for it."
        if busy:
            return "limit.time", f"Your callback was still computing in {where} after {_ANSWER_S:g} s."
        return "service.blocks", f"Your callback stands still in {where}, and meanwhile nobody is answered."
    if doing.spinning and _awaits(job.source):
        return "service.deadlock", "Your callback awaits something that never comes: nobody is left to deliver it."
    if job.mode == "run" and not doing.spinning:
        where = f" It is in {endings.source_line(job, doing.own.line)}." if doing.own else ""
        return "start.nothing", f"Your node is on the graph, but nothing spins it, so no callback ever runs.{where}"
    return None, "Your service is there and did not answer."


def _computes(before: Life, after: Life, seconds: float) -> bool:
    """Whether a program used a processor, or stood in the queue for one, most of the time."""
    return after.cpu_s + after.waited_s - before.cpu_s - before.waited_s > _IDLE_SHARE * seconds


def _doing(bench: Bench) -> Activity:
    return activity(bench.stacks(), bench.job.name)


def _spins(bench: Bench) -> bool:
    return bench.job.mode != "run" or _doing(bench).spinning


def _awaits(source: str) -> bool:
    return any(isinstance(node, ast.Await) for node in ast.walk(ast.parse(source)))


def _waits_for_a_future(source: str, line: int) -> bool:
    """Whether the function around `line` makes an asynchronous call and looks at its future itself."""
    names = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.lineno <= line <= (node.end_lineno or 0):
            names = {inner.attr for inner in ast.walk(node) if isinstance(inner, ast.Attribute)}
    return bool(names & {"call_async", "send_goal_async"}) and bool(names & {"done", "result", "wait"})


def _not_offered(bench: Bench, service: Service, expected: str) -> Failed:
    offers, nodes = bench.tester.services(), bench.tester.nodes()
    bench.spoil()
    got = "; ".join(f"{offer.name} [{offer.type}]" for offer in offers) or _listed(nodes, "node")
    evidence = Evidence("", expected, f"on the graph: {got}")
    same_name = [offer for offer in offers if offer.name == service.name]
    if same_name:
        message = f"The service {service.name} is there with the type {same_name[0].type} instead of {service.type}."
        return Failed(evidence, message, "type.interface")
    if offers:
        alike = [offer for offer in offers if offer.type == service.type] or offers
        message = f"No service is called {service.name}.{_closest(service.name, [offer.name for offer in alike])}"
        return Failed(evidence, message, "name.service")
    if nodes:
        return Failed(evidence, f"Your node {nodes[0]} is up, and offers no service.", None)
    return Failed(evidence, *_nothing_there(bench, service)[::-1])


def _nothing_there(bench: Bench, service: Service) -> endings.Cause:
    if bench.job.mode == "attach":
        return "start.nothing", f"Nobody on the graph of ROS domain {bench.tester.domain} offers {service.name}."
    clock = bench.clock()
    before = bench.life(fresh=True)
    doing = _doing(bench)
    bench.wait_until(lambda: clock.wall() > _LOOK_S, _LOOK_S)
    busy = _computes(before, bench.life(fresh=True), clock.wall())
    where = f" It is in {endings.source_line(bench.job, doing.own.line)}." if doing.own else ""
    start_s = bench.job.limits.start_s
    if busy:
        return "limit.time", f"After {start_s:g} s your program was still computing, and no node had appeared.{where}"
    return "start.nothing", f"Your program runs, but within {start_s:g} s no node has appeared on the graph.{where}"


def _closest(wanted: str, names: Sequence[str]) -> str:
    close = difflib.get_close_matches(wanted, names, n=1, cutoff=0.3) or list(names)[:1]
    return f" The closest is {close[0]}." if close else ""


def _listed(names: Sequence[str], what: str) -> str:
    return f"the {what}{'s' if len(names) > 1 else ''} {', '.join(names)}" if names else f"no {what}"
