"""The verbs in which a check talks with a learner's node.

Everything that is sent stands in the record of the check, which a learner sees drawn: nothing is sent in secret.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from msgspec.structs import astuple

from course_kit.grading.checks import discovery, hangs
from course_kit.grading.checks.answers import Answer, Change, describe_value, message_of, only_field, require_fields
from course_kit.grading.checks.discovery import WantedEndpoint
from course_kit.grading.checks.evidence import Evidence, Exchange, Failed, charge_to, in_one_line
from course_kit.grading.checks.graded_goal import GradedGoal
from course_kit.grading.checks.parameters import RemoteParameters, describe_result, parameter_file, start_arguments
from course_kit.grading.diagnosis import causes

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.grader_node import BoundedInbox, OfferedService
    from course_kit.ros.messages import Message, ServiceType

MESSAGE_S = 3.0  # within which a message is answered by another one, unless the check says otherwise
_MET = "met"  # remembered of a running submission
_FILE = "parameters.yaml"
_CLIENTS = 2  # that ask together: each of them is woken by every answer


class GradedNode:
    """A learner's program, which runs, as a check talks with it.

    The names are those of `[[endpoints]]` in exercise.toml, from the root: "/add".
    """

    def __init__(self, context: CheckContext) -> None:
        self.context = context
        self._last_sent = ""
        self._turn: Exchange | None = None

    # --- services

    def call(
        self, service: str, request: Any = None, *, within_s: float = 0.0, breaks: str = "", **fields: Any
    ) -> Answer:
        """Send a request and wait for the answer.

        Args:
            service: its name.
            request: the request as a message or a dict; or its fields one by one.
            within_s: how long an answer is waited for, where 5 s, and 2 s after one that never came, will not do.
            breaks: the sentence of the exercise, or the check, that it costs when none comes.
            fields: of the request.

        Raises:
            Failed: no answer came; with the reason if it can be established.

        Example:
            >>> node.call("/add", a=1, b=2).expect(sum=3)
        """
        self.ensure_running()
        end, context = self._end(service), self.context
        message = message_of(end.interface.Request, request, fields)
        sent_text = in_one_line(message)
        evidence = Evidence(sent_text, "an answer")
        turn = context.record.add_sent(f"request {service}: {sent_text}", about=sent_text)
        clock = context.latency_clock()
        sent = context.grader_node.client(end.interface, service).send(message)
        with charge_to(breaks):
            hangs.await_answer(context, sent.is_answered, evidence, within_s)
        response = sent.response()
        turn.add_received(f"response: {in_one_line(response)}")
        return Answer(sent_text, in_one_line(response), clock.latency(), response)

    def call_together(
        self, service: str, requests: Sequence[Any], *, at_a_time: int = 10, within_s: float = 5.0
    ) -> list[Answer]:
        """Send many requests, so many of them unanswered at a time, and wait for all answers.

        Args:
            service: its name.
            requests: each a message or a dict.
            at_a_time: how many wait for their answer at most, sent by two clients.
            within_s: seconds in which all are answered.

        Raises:
            Failed: not all were answered in time; with service.blocks when they came too slowly.

        Example:
            >>> for number, answer in enumerate(node.call_together("/add", [{"a": n, "b": 1} for n in range(10)])):
            ...     answer.expect(sum=number + 1)
        """
        self.ensure_running()
        end, node = self._end(service), self.context.grader_node
        messages = [message_of(end.interface.Request, request, {}) for request in requests]
        clients = [node.client(end.interface, service, number % _CLIENTS) for number in range(at_a_time)]
        responses = hangs.call_many(self.context, clients, messages, within_s)
        pairs = zip(messages, responses, strict=True)
        return [Answer(in_one_line(request), in_one_line(other), 0.0, other) for request, other in pairs]

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
        self.ensure_running()
        interface = self._end(topic, "subscription").interface
        sent = message_of(interface, message, fields)
        for name in self._list_published_topics():
            inbox = self.inbox(name)
            inbox.heard = inbox.count
        self._last_sent = f"{topic}: {in_one_line(sent)}"
        self._turn = self.context.record.add_sent(self._last_sent, "message")
        self.context.grader_node.publisher(interface, topic).publish(sent)
        return self

    def expect(  # noqa: PLR0913 - all that a check may say of a message
        self,
        topic: str,
        wanted: Any = None,
        *,
        within_s: float = MESSAGE_S,
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
            breaks: the sentence of the exercise that another message breaks, where the check proves several.
            why: what is wrong with another message, for the learner.
            diagnosis: its code of the catalogue.
            fields: of the message.

        Raises:
            Failed: none came, with topic.silent, or another one.

        Example:
            >>> node.send("/voltage", 9.0).expect("/state", "critical")
        """
        self.ensure_running()
        inbox, clock = self.inbox(topic), self.context.clock()
        evidence = Evidence(self._last_sent, f"a message on {topic}")
        with charge_to(breaks), hangs.explain_end(self.context, evidence):
            self.context.wait_until(lambda: inbox.count > inbox.heard, within_s)
        if inbox.count == inbox.heard:
            seconds = hangs.describe_seconds(clock.fair_s(), within_s)
            got = f"nothing on {topic} within {seconds} s"
            self._exchange().add_received(got, "failure")
            cause = discovery.explain_silent_topic(self.context, self._last_sent.partition(":")[0], topic, seconds)
            raise Failed(replace(evidence, got=got), *cause[::-1], breaks=breaks)
        message: Message = inbox.newer_than(inbox.heard)[0]
        inbox.heard += 1
        self._exchange().add_received(f"{topic}: {in_one_line(message)}", "message")
        if wanted is None and not fields:
            return message
        found = only_field(message, {**(wanted or {}), **fields} if fields else wanted)
        where = topic if callable(found) else f"In the message on {topic}, "
        evidence = replace(
            evidence, expected=f"{topic}: {describe_value(found)}", got=f"{topic}: {in_one_line(message)}"
        )
        with charge_to(breaks):
            require_fields(found, message, where, evidence, why=why, diagnosis=diagnosis)
        return message

    def expect_nothing(self, *names: str, seconds: float = 0.3, why: str = "", breaks: str = "") -> None:
        """No message comes on these topics that was not expected.

        Args:
            names: the topics; all that the node publishes when none is named.
            seconds: how long it is listened to; 0 or less for what has come already.
            why: what is wrong with one, for the learner.
            breaks: as in `expect`.

        Raises:
            Failed: one came.

        Example:
            >>> node.send("/voltage", 10.2).expect_nothing("/state", why="It is still critical.")
        """
        self.ensure_running()
        listened = {name: self.inbox(name) for name in names or self._list_published_topics()}

        def find_extra_messages() -> list[str]:
            return [name for name, inbox in listened.items() if inbox.count > inbox.heard]

        evidence = Evidence(self._last_sent, f"no further message on {' or '.join(listened)}")
        with hangs.explain_end(self.context, evidence):
            self.context.grader_node.spin_once(0.0)
            self.context.wait_until(lambda: bool(find_extra_messages()), seconds)
        for name in find_extra_messages():
            inbox = listened[name]
            got, inbox.heard = f"{name}: {in_one_line(inbox.messages[-1])}", inbox.count
            self._exchange().add_received(got, "message")
            text = why or f"Nothing that we sent calls for this message on {name}."
            raise Failed(replace(evidence, got=got), text, breaks=breaks)

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
        self.ensure_running()
        wanted = {**(values or {}), **more}
        remote, clock = self.parameters(of), self.context.latency_clock()
        result = remote.set_values(wanted)
        self._last_sent = f"set {describe_value(wanted)}"
        return Change(self._last_sent, describe_result(result), clock.latency(), wanted, result)

    def get(self, *names: str, of: str = "") -> dict[str, Any]:
        """The values of parameters; None for one that is not declared.

        Example:
            >>> node.get("max_speed")
            {'max_speed': 1.0}
        """
        self.ensure_running()
        return self.parameters(of).values(names)

    def parameters(self, of: str = "") -> RemoteParameters:
        """The parameters of a node as they are asked for from outside."""
        if not of and not (of := self.context.memory.get("node", "")):
            of = self.context.memory["node"] = discovery.first_node(self.context)
        self.context.turn_to(f"{of.rpartition('/')[2]}.py")
        return RemoteParameters(self.context, of)

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
        self.ensure_running()
        interface = self._end(action).interface
        return GradedGoal(self.context, action, interface, message_of(interface.Goal, goal, fields))

    # --- the program

    def wait(self, seconds: float) -> None:
        """Let time go by, in which messages are taken in.

        Example:
            >>> node.set(max_speed=0.5).accepted()
            >>> node.wait(0.2)  # rclpy may tell the callbacks of a change after it has answered
        """
        self.context.wait_until(lambda: False, seconds)

    def start(
        self,
        *arguments: str,
        parameters: Mapping[str, Any] | None = None,
        file: Mapping[str, Any] | None = None,
        of: str = "",
        program: str = "",
    ) -> None:
        """Start the program afresh, as a learner would on the command line; whoever asks it something waits for it.

        Args:
            arguments: what follows the program's name.
            parameters: values given with `-p`.
            file: values given in a parameter file.
            of: the node's name in that file; any node's when left out.
            program: the file to start alone, of a submission of several; the one that was started last when left out.

        Example:
            >>> node.start(parameters={"max_speed": 0.5})
            >>> node.start(file={"max_speed": 0.5})
            >>> node.start(program="door.py", parameters={"locked": True})
        """
        words = [*arguments, *(start_arguments(parameters) if parameters else [])]
        files = {}
        if file:
            files[_FILE] = parameter_file(file, of)
            words += [*([] if "--ros-args" in words else ["--ros-args"]), "--params-file", _FILE]
        self.context.launch(words, files, program=program)

    def kill(self, program: str) -> None:
        """End the process that runs one of the files, at once, while the others run on; one of several nodes lives on.

        Args:
            program: the file's name.

        Example:
            >>> node.start(program="delivery.launch.py")
            >>> node.kill("door.py")
        """
        self.context.record.add_sent(f"kill {program}", "message", partner=program.removesuffix(".py"))
        self.context.program.kill(program)

    def ensure_running(self) -> None:
        """Have a running program whose endpoints are all connected; one that has died or hangs is started again."""
        context = self.context
        if not context.spoiled and context.memory.get(_MET):
            return
        self.prepare()
        expected = f"a node with {', '.join(end.name for end in self.endpoints)}"
        discovery.await_start(context, expected, self._is_connected)
        if missing := [end for end in self.endpoints if not end.is_there(context)]:
            context.spoil()
            evidence = Evidence("", expected, f"missing: {', '.join(end.name for end in missing)}")
            raise Failed(evidence, *discovery.explain_missing(context, missing[0]))
        with hangs.explain_end(context, Evidence("", expected), causes.explain_start, discovery.ENDED):
            hangs.greet_node(context)
        context.memory[_MET] = True

    def prepare(self) -> None:
        """Have a program, and all ends on our side, so that they are found while others are waited for."""
        if self.context.spoiled:
            self.context.launch()
        self._is_connected()

    def message_for(self, endpoint: str, given: Any) -> Message:
        """A message for a topic, a request for a service or a goal for an action, of what may be given to its verb."""
        end = self._end(endpoint)
        part = {"service": "Request", "action": "Goal"}.get(end.kind)
        return message_of(getattr(end.interface, part) if part else end.interface, given, {})

    @property
    def endpoints(self) -> list[WantedEndpoint]:
        """All that exercise.toml names, of the program that runs; where several run, of all of them."""
        job = self.context.job
        running = (end for end in job.endpoints if job.launches or end.program in ("", job.text.program))
        return [WantedEndpoint(*astuple(end)) for end in running]

    # --- inside

    def _is_connected(self) -> bool:
        return all([end.is_there(self.context) for end in self.endpoints])  # noqa: C419 - each makes its end

    def _end(self, name: str, kind: str = "") -> WantedEndpoint:
        """What has this name; where a topic has both ends among them, the publisher if not another kind is wanted."""
        found = [end for end in self.endpoints if end.name == name]
        if found:
            end = min(found, key=lambda end: (end.kind != kind, end.kind))
            self.context.turn_to(end.program)
            return end
        known = ", ".join(end.name for end in self.endpoints)
        raise ValueError(f"exercise.toml has no endpoint {name}; it has {known}")

    def _list_published_topics(self) -> list[str]:
        return [end.name for end in self.endpoints if end.kind == "publisher"]

    def inbox(self, topic: str) -> BoundedInbox:
        """What has come on a topic so far."""
        return self.context.grader_node.inbox(self._end(topic).interface, topic)

    def _exchange(self) -> Exchange:
        return self._turn or self.context.record.begin_exchange()


def offer_service(node: GradedNode, name: str, interface: ServiceType, **answer: Any) -> OfferedService:
    """Offer a service to the program, which calls it; one that is offered already gets another answer.

    Args:
        node: the program.
        name: the service's full name.
        interface: its class.
        answer: fields of the response that each request gets at once; without any, requests wait for `reply`.

    Example:
        >>> door = offer_service(node, "/open", SetBool)
        >>> node.goal("/deliver", room="attic")
        >>> node.context.wait_until(lambda: door.requests, 3.0)
        >>> door.reply(SetBool.Response(success=True))
    """
    offered = node.context.grader_node.offer_service(name, interface, node.context.record)
    offered.answer = message_of(interface.Response, None, answer) if answer else None
    return offered
