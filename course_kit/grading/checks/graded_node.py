"""The verbs in which a check talks with a learner's node, and what comes back.

Everything that is sent stands in the record of the check, which a learner sees drawn: nothing is sent in secret.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rcl_interfaces.srv import ListParameters

from course_kit.grading.bounds import bounded
from course_kit.grading.checks import discovery, load_test, topics
from course_kit.grading.checks.actions import WantedAction
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.context import GRAPH_STEP_S
from course_kit.grading.checks.graded_goal import GradedGoal
from course_kit.grading.checks.matching import describe_wanted, differences, interface_of, message_of, only_field
from course_kit.grading.checks.parameters import Remote, SetResult, require_proper_answer, shown, start_arguments, yaml
from course_kit.grading.checks.services import Service
from course_kit.grading.diagnosis import exceptions, exits, hangs
from course_kit.grading.exchange_log import Exchange, in_one_line
from course_kit.ros.parameters import LIST_SERVICE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.messages import Message

ANSWER_S = 3.0  # within which a message is answered by another one, unless the check says otherwise
_MEET_S = 1.0
_NUDGE_S = 1.0  # when nothing has come for so long, rclpy is given something to do, after which it logs what it caught
_MET = "met"  # remembered of a running submission
_FILE = "parameters.yaml"


@dataclass(frozen=True)
class Outcome:
    """What came back for something that was sent.

    Attributes:
        sent: what was sent, in words.
        got: what came, in words.
        latency_s: after how many seconds.
    """

    sent: str
    got: str
    latency_s: float = 0.0

    def fail(self, why: str, *, expected: str, breaks: str = "", diagnosis: str | None = None) -> None:
        """End the check: what came is wrong.

        Args:
            why: what is wrong, in a sentence for the learner.
            expected: what a right node does, in words.
            breaks: the sentence of the task that is broken, where the check proves several.
            diagnosis: a code of the catalogue, where what was seen establishes it.

        Raises:
            Failed: always.

        Example:
            >>> answer = node.call("/area", radius=-1.0)
            >>> if answer.response.area < 0:
            ...     answer.fail("An area is never negative.", expected="an area of 0 or more")
        """
        raise Failed(Evidence(self.sent, expected, self.got), why, diagnosis, breaks=breaks)

    def within(self, seconds: float, *, breaks: str = "") -> None:
        """It took no longer than so many seconds.

        Args:
            seconds: the most that the task allows.
            breaks: as in `fail`.

        Raises:
            Failed: it took longer, with service.blocks.

        Example:
            >>> node.call("/add", a=1, b=2).within(1.5, breaks="quick")
        """
        if self.latency_s > seconds:
            why = f"The answer took {self.latency_s:.1f} s, and meanwhile every other client has to wait."
            self.fail(why, expected=f"an answer within {seconds:g} s", breaks=breaks, diagnosis="service.blocks")

    def not_before(self, seconds: float, *, breaks: str = "") -> None:
        """It took at least so many seconds: work that takes time was not left out.

        Args:
            seconds: the least that the task allows.
            breaks: as in `fail`.

        Raises:
            Failed: it came sooner.

        Example:
            >>> node.call("/weigh", a=1, b=2).not_before(0.4)
        """
        if self.latency_s < seconds:
            why = "This came too soon: the work that takes so long was not done."
            got = f"it came after {self.latency_s:.2f} s"
            expected = f"not before {seconds:g} s have passed"
            raise Failed(Evidence(self.sent, expected, got), why, breaks=breaks)


@dataclass(frozen=True)
class Answer(Outcome):
    """The response of a service.

    Attributes:
        response: the message.
    """

    response: Any = None

    def expect(self, *, breaks: str = "", why: str = "", diagnosis: str | None = None, **fields: Any) -> Answer:
        """The response has these fields; others may hold anything.

        Args:
            breaks: the sentence of the task that a wrong answer breaks, where the check proves several.
            why: what is wrong with another answer, for the learner.
            diagnosis: its code of the catalogue.
            fields: a value for each; a dict for a message in it, or a function that says whether a value is right.

        Raises:
            Failed: one is not so.

        Example:
            >>> node.call("/add", a=1, b=2).expect(sum=3)
        """
        for path, wanted, got in differences(fields, self.response):
            told = why or f"{path} has to be {describe_wanted(wanted)}, and is {got!r}."
            self.fail(told, expected=describe_wanted(fields), breaks=breaks, diagnosis=diagnosis)
        return self

    def refused(
        self,
        *,
        reason: str = "message",
        what: str = "this request",
        breaks: str = "",
        unexplained: str = "",
        **fields: Any,
    ) -> None:
        """The request was refused, with a reason.

        Args:
            reason: the field with the reason, which must not be blank; empty when the task asks for none.
            what: was wrong with the request, for the learner: "an unknown unit".
            breaks: the sentence that is broken by accepting it.
            unexplained: the one that is broken by refusing it without a reason.
            fields: by which a refusal is known; `success=False` when none are given.

        Raises:
            Failed: it was accepted, with validation.missing, or there is no reason, with validation.no_reason.

        Example:
            >>> node.call("/convert", value=1.0, unit="kelvin").refused(what="an unknown unit")
        """
        wanted = fields or {"success": False}
        expected = describe_wanted(wanted) + (f" and a {reason} that says why" if reason else "")
        if next(differences(wanted, self.response), None):
            why = f"Your service accepted {what}."
            self.fail(why, expected=expected, breaks=breaks, diagnosis="validation.missing")
        if reason and not getattr(self.response, reason).strip():
            why = f"Your service was right to refuse {what}, but its {reason} is empty: the client cannot tell why."
            self.fail(why, expected=expected, breaks=unexplained or breaks, diagnosis="validation.no_reason")


@dataclass(frozen=True)
class Change(Outcome):
    """The answer to a change of parameters.

    Attributes:
        values: what was to be set.
        result: whether it was, and the reason.
    """

    values: Any = None
    result: Any = None

    def accepted(self, *, breaks: str = "") -> None:
        """The change was accepted.

        Args:
            breaks: as in `fail`.

        Raises:
            Failed: it was refused, with validation.overzealous or parameter.bad_callback.

        Example:
            >>> node.set(max_speed=0.5).accepted()
        """
        if not self.result.successful:
            evidence = Evidence(self.sent, "accepted: the value is valid", self.got)
            require_proper_answer(self.result, evidence)
            why = f"Your node refused {shown(self.values)}, which is valid."
            raise Failed(evidence, why, "validation.overzealous", breaks=breaks)

    def refused(self, *, expected: str = "refused", breaks: str = "", diagnosis: str = "validation.missing") -> None:
        """The change was refused.

        Args:
            expected: why, in words.
            breaks: as in `fail`.
            diagnosis: what it means that it was accepted.

        Raises:
            Failed: it was accepted, or rclpy refused it because the callback returned no result.

        Example:
            >>> node.set(max_speed=-1.0).refused(breaks="refused")
        """
        if self.result.successful:
            why = f"Your node accepted {shown(self.values)}."
            self.fail(why, expected=expected, breaks=breaks, diagnosis=diagnosis)
        require_proper_answer(self.result, Evidence(self.sent, expected, self.got))


class GradedNode:
    """A learner's program, which runs, as a check talks with it.

    The names are those of `[[endpoints]]` in exercise.toml, from the root: "/add".
    """

    def __init__(self, context: CheckContext) -> None:
        self.context = context
        self._heard: dict[str, int] = context.memory.setdefault("heard", {})

    # --- services

    def call(
        self,
        service: str,
        request: Any = None,
        *,
        within_s: float = hangs.ANSWER_S,
        breaks: str = "",
        **fields: Any,
    ) -> Answer:
        """Send a request and wait for the answer.

        Args:
            service: its name.
            request: the request as a message or a dict; or its fields one by one.
            within_s: how long an answer is waited for.
            breaks: the sentence of the task, or the check, that it costs when none comes.
            fields: of the request.

        Raises:
            Failed: no answer came; with the reason if it can be established.

        Example:
            >>> node.call("/add", a=1, b=2).expect(sum=3)
        """
        self.meet()
        found = self._service(service)
        message = message_of(found.interface.Request, request, fields)
        told = in_one_line(message)
        context, turn = self.context, self.context.record.sent(f"request {service}: {told}", about=told)
        clock, client = context.clock(), found.client(context.grader_node)
        evidence = Evidence(told, "an answer")
        try:
            with exceptions.explained(context, evidence, exits.of_call, "no answer: the program ended"):
                sent = client.send(message)
                self._wait(sent.answered, within_s)
        except Failed as failed:
            failed.breaks = breaks
            raise
        if not sent.answered():
            turn.missed("no answer")
            silent = hangs.unanswered(context, told, "an answer", clock.fair())
            silent.breaks = breaks
            raise silent
        response = bounded(sent.response())
        turn.came(f"response: {in_one_line(response)}")
        latency_s = clock.fair() if clock.wall() > _NUDGE_S else clock.wall()
        return Answer(told, in_one_line(response), latency_s, response)

    def call_together(
        self, service: str, requests: Sequence[Any], *, at_a_time: int = 10, within_s: float = 5.0, expected: str = ""
    ) -> list[Answer]:
        """Send many requests, so many of them unanswered at a time, and wait for all answers.

        Args:
            service: its name.
            requests: each a message or a dict.
            at_a_time: how many wait for their answer at most, each sent by another client.
            within_s: seconds in which all are answered.
            expected: in words.

        Raises:
            Failed: not all were answered in time; with service.blocks when they came too slowly.

        Example:
            >>> for number, answer in enumerate(node.call_together("/add", [{"a": n, "b": 1} for n in range(10)])):
            ...     answer.expect(sum=number + 1)
        """
        self.meet()
        found = self._service(service)
        messages = [message_of(found.interface.Request, one, {}) for one in requests]
        sent = f"{len(messages)} requests from {at_a_time} clients, at most {at_a_time} unanswered at a time"
        evidence = Evidence(sent, expected or f"{len(messages)} answers within {within_s:g} s, each to its own request")
        load = load_test.Load(at_a_time, at_a_time, within_s)
        responses = load_test.call_many(self.context, found, messages, load, evidence)
        pairs = zip(messages, responses, strict=True)
        return [Answer(in_one_line(one), in_one_line(other), 0.0, other) for one, other in pairs]

    # --- topics

    def send(self, topic: str, message: Any = None, **fields: Any) -> GradedNode:
        """Publish a message; what `expect` looks at afterwards is what comes from now on.

        Args:
            topic: its name.
            message: the message, a dict, or the value of its only field; or its fields one by one.
            fields: of the message.

        Example:
            >>> node.send("/brightness", 0.7).expect("/lamp", True)
        """
        self.meet()
        made = message_of(self._type(topic), message, fields)
        for name in self._published():
            self._heard[name] = self.inbox(name).count
        self._sent = f"{topic}: {in_one_line(made)}"
        self._turn: Exchange = self.context.record.sent(self._sent, "message")
        self.context.grader_node.publisher(self._type(topic), topic).publish(made)
        return self

    def expect(  # noqa: PLR0913 - all that a check may say of a message
        self,
        topic: str,
        wanted: Any = None,
        *,
        within_s: float = ANSWER_S,
        breaks: str = "",
        why: str = "",
        diagnosis: str | None = None,
        **fields: Any,
    ) -> Message:
        """The next message on a topic is this one; it is returned.

        Args:
            topic: its name.
            wanted: a dict of fields, a message, the value of the only field, or a function that says yes or no.
            within_s: how long it is waited for.
            breaks: the sentence of the task that another message breaks, where the check proves several.
            why: what is wrong with another message, for the learner.
            diagnosis: its code of the catalogue.
            fields: of the message.

        Raises:
            Failed: none came, with topic.silent, or another one.

        Example:
            >>> node.send("/voltage", 9.0).expect("/state", "critical")
        """
        self.meet()
        message = self._next(topic, within_s, breaks)
        if wanted is None and not fields:
            return message
        found = only_field(message, {**(wanted or {}), **fields} if fields else wanted)
        for path, one, got in differences(found, message):
            evidence = Evidence(
                self._last_sent(), f"{topic}: {describe_wanted(found)}", f"{topic}: {in_one_line(message)}"
            )
            told = why or f"{path or topic} has to be {describe_wanted(one)}, and is {got!r}."
            raise Failed(evidence, told, diagnosis, breaks=breaks)
        return message

    def expect_nothing(self, *names: str, seconds: float = 0.3, why: str = "", breaks: str = "") -> None:
        """No message comes on these topics that was not expected.

        Args:
            names: the topics; all that the node publishes when none is named.
            seconds: how long it is listened to.
            why: what is wrong with one, for the learner.
            breaks: as in `expect`.

        Raises:
            Failed: one came.

        Example:
            >>> node.send("/voltage", 10.2).expect_nothing("/state", why="It is still critical.")
        """
        self.meet()
        listened = names or self._published()

        def extra() -> list[str]:
            return [name for name in listened if self.inbox(name).count > self._heard.setdefault(name, 0)]

        evidence = Evidence(self._last_sent(), f"no message more on {' and '.join(listened)}")
        with exceptions.explained(self.context, evidence):
            self.context.wait_until(lambda: bool(extra()), seconds)
        for name in extra():
            message = self.inbox(name).messages[-1]
            self._heard[name] = self.inbox(name).count
            self._exchange().came(f"{name}: {in_one_line(message)}", "message")
            got = f"{name}: {in_one_line(message)}"
            raise Failed(
                replace(evidence, got=got), why or f"Nothing was sent for which {name} needs this.", breaks=breaks
            )

    # --- parameters

    def set(self, values: Mapping[str, Any] | None = None, *, of: str = "", **more: Any) -> Change:
        """Set one parameter, or several at once: all or none.

        Args:
            values: by the parameters' names; or one by one.
            of: the node's full name; the program's only node when left out.
            more: of the values.

        Raises:
            Failed: no answer came.

        Example:
            >>> node.set(max_speed=0.5).accepted()
            >>> node.set(max_speed=0.5, enabled="yes").refused()
        """
        self.meet()
        wanted = {**(values or {}), **more}
        remote, clock = self.parameters(of), self.context.clock()
        result: SetResult = remote.set(*next(iter(wanted.items()))) if len(wanted) == 1 else remote.set_together(wanted)
        self._sent = f"set {shown(wanted)}"
        latency_s = clock.fair() if clock.wall() > _NUDGE_S else clock.wall()
        return Change(self._sent, result.shown(), latency_s, wanted, result)

    def get(self, *names: str, of: str = "") -> dict[str, Any]:
        """The values of parameters; None for one that is not declared.

        Example:
            >>> node.get("max_speed")
            {'max_speed': 1.0}
        """
        self.meet()
        return {name: one.value for name, one in self.parameters(of).values(list(names)).items()}

    def parameters(self, of: str = "") -> Remote:
        """The parameters of a node as they are asked for from outside."""
        if not of and not (of := self.context.memory.get("node", "")):
            nodes = self.context.grader_node.nodes()
            of = self.context.memory["node"] = nodes[0] if nodes else "/"
        return Remote(self.context, of)

    # --- actions

    def goal(self, action: str, goal: Any = None, **fields: Any) -> GradedGoal:
        """Send a goal; whether it is accepted, and how it ends, is asked of what is returned.

        Args:
            action: its name.
            goal: the goal as a message or a dict; or its fields one by one.
            fields: of the goal.

        Example:
            >>> goal = node.goal("/count_down", order=3)
            >>> goal.accepted_by().ends("SUCCEEDED", sequence=[3, 2, 1])
        """
        self.meet()
        found = WantedAction(action, self._type(action))
        message = message_of(found.interface.Goal, goal, fields)
        return GradedGoal(self.context, found, message)

    # --- the program

    def start(
        self,
        *arguments: str,
        parameters: Mapping[str, Any] | None = None,
        file: Mapping[str, Any] | None = None,
        of: str = "",
        meets: bool = True,
    ) -> None:
        """Start the program afresh, as a learner would on the command line.

        Args:
            arguments: what follows the program's name.
            parameters: values given with `-p`.
            file: values given in a parameter file.
            of: the node's name in that file; any node's when left out.
            meets: wait until it is up; else that is done when it is first asked something.

        Raises:
            Failed: it does not come up.

        Example:
            >>> node.start(parameters={"max_speed": 0.5})
            >>> node.start(file={"max_speed": 0.5})
        """
        words = [*arguments, *(start_arguments(parameters) if parameters else [])]
        files = {}
        if file:
            lines = [f"    {name}: {yaml(value)}" for name, value in file.items()]
            files[_FILE] = "\n".join([f"{of.lstrip('/') or '/**'}:", "  ros__parameters:", *lines]) + "\n"
            words += [*([] if "--ros-args" in words else ["--ros-args"]), "--params-file", _FILE]
        self.context.launch(words, files)
        self._heard = self.context.memory.setdefault("heard", {})
        if meets:
            self.meet()

    def meet(self) -> None:
        """Have a running program whose endpoints are all connected; one that has died or hangs is started again.

        Raises:
            Failed: it does not come up.
        """
        context = self.context
        if not context.spoiled and context.memory.get(_MET):
            return
        self.prepare()
        clock = context.clock()
        names = ", ".join(one["name"] for one in context.job.endpoints)
        evidence = Evidence("", f"a node with {names}")
        with exceptions.explained(context, evidence, exceptions.of_start, discovery.ENDED):
            context.wait_for_start(lambda: self._connected() or discovery.has_settled(context, clock))
            if not self._connected():
                context.spoil()
                why = "Your program started once, but did not offer all of this when it was started again."
                raise Failed(replace(evidence, got="not all of it is there"), why)
            self.greet()
        context.memory[_MET] = True

    def greet(self) -> None:
        """Have the node's process know our endpoints: asked last, a question for its parameters is answered after that.

        Raises:
            SubmissionEndedError: the program has ended.
        """
        context, node = self.context, self.context.grader_node
        offers = [name for name, _ in node.node.get_service_names_and_types() if name.endswith(LIST_SERVICE)]
        if offers:
            client = node.client(ListParameters, offers[0])
            context.wait_until(client.is_ready, _MEET_S, step_s=GRAPH_STEP_S)
            context.wait_until(client.send(ListParameters.Request()).answered, _MEET_S)
        else:
            clock = context.clock()
            context.wait_until(lambda: clock.wall() > 0.1, _MEET_S)  # noqa: PLR2004 - seconds

    def prepare(self) -> None:
        """Have a program, and all ends on our side, so that they are found while others are waited for."""
        if self.context.spoiled:
            self.context.launch()
        self._heard = self.context.memory.setdefault("heard", {})
        self._make_ends()

    def message(self, topic: str, given: Any) -> Message:
        """A message for a topic, of what may be given to `send`."""
        return message_of(self._type(topic), given, {})

    def request(self, service: str, given: Any) -> Message:
        """A request for a service, of what may be given to `call`."""
        return message_of(self._type(service).Request, given, {})

    def goal_message(self, action: str, given: Any) -> Message:
        """A goal for an action, of what may be given to `goal`."""
        return message_of(self._type(action).Goal, given, {})

    # --- inside

    def _wait(self, condition: Callable[[], bool], seconds: float) -> bool:
        if self.context.wait_until(condition, min(_NUDGE_S, seconds)):
            return True
        with self.context.record.looking_away():
            self.greet()  # an executor of several threads tells what a callback has raised when it has more to do
        return self.context.wait_until(condition, seconds - _NUDGE_S)

    def _make_ends(self) -> None:
        node = self.context.grader_node
        for one in self.context.job.endpoints:
            interface, name = interface_of(one["type"]), one["name"]
            if one["kind"] == "service":
                node.client(interface, name)
            elif one["kind"] == "publisher":
                node.inbox(interface, name)
            elif one["kind"] == "subscription":
                node.publisher(interface, name)

    def _connected(self) -> bool:
        return all(self._is_there(**one) for one in self.context.job.endpoints)

    def _is_there(self, kind: str, name: str, type: str) -> bool:  # noqa: A002 - as exercise.toml calls it
        node, interface = self.context.grader_node, interface_of(type)
        if kind == "service":
            return node.client(interface, name).is_ready()
        if kind == "action":
            return WantedAction(name, interface).ready(node)
        if kind == "publisher":
            return bool(node.publishers(name))
        return bool(node.publisher(interface, name).get_subscription_count())

    def _type(self, name: str) -> Any:
        for one in self.context.job.endpoints:
            if one["name"] == name:
                return interface_of(one["type"])
        known = ", ".join(one["name"] for one in self.context.job.endpoints)
        raise ValueError(f"exercise.toml has no endpoint {name}; it has {known}")

    def _service(self, name: str) -> Service:
        return Service(name, self._type(name))

    def _published(self) -> list[str]:
        return [one["name"] for one in self.context.job.endpoints if one["kind"] == "publisher"]

    def inbox(self, topic: str) -> Any:
        """What has come on a topic so far."""
        return self.context.grader_node.inbox(self._type(topic), topic)

    def _last_sent(self) -> str:
        return getattr(self, "_sent", "")

    def _exchange(self) -> Exchange:
        return getattr(self, "_turn", None) or self.context.record.sent("(nothing)", minor=True)

    def _next(self, topic: str, within_s: float, breaks: str) -> Message:
        inbox, place = self.inbox(topic), self._heard.setdefault(topic, 0)
        evidence = Evidence(self._last_sent(), f"a message on {topic}")
        clock = self.context.clock()
        try:
            with exceptions.explained(self.context, evidence):
                came = self.context.wait_until(lambda: inbox.count > place, within_s)
        except Failed as failed:
            failed.breaks = breaks
            raise
        if not came:
            seconds = hangs.told(clock.fair(), within_s)
            self._exchange().missed(f"within {seconds} s nothing on {topic}")
            evidence = replace(evidence, got=f"within {seconds} s nothing on {topic}")
            sent = self._last_sent().partition(":")[0]
            raise Failed(evidence, *topics.why_nothing(self.context, sent, topic, seconds)[::-1], breaks=breaks)
        message = inbox.since(place)[0]
        self._heard[topic] = place + 1
        self._exchange().came(f"{topic}: {in_one_line(message)}", "message")
        return message
