"""What a check has seen: its evidence, its verdicts, and what crossed the wire, as a short list of steps."""

from __future__ import annotations

import time
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.ros.sequence import Arrow

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from course_kit.ros.graph import Overview
    from course_kit.ros.messages import Message
    from course_kit.ros.sequence import Kind

GRADER, NODE = "grader", "your node"
_MOST = 8  # steps; what happened before them is left out, and that is said
_LONGEST = 110  # characters of a step's text
_LONGEST_TEXT = 40  # of a text in a message
_FEW = 4  # fields; of larger messages only those that are not zero
_FEWER_DIGITS = 4  # of numbers in large messages; small ones show all


@dataclass(frozen=True)
class Evidence:
    """What was seen on the wire: what we sent, what should come back, and what came."""

    sent: str = ""
    expected: str = ""
    got: str = ""
    graph: Overview | None = None  # who talks to whom, where that was looked at


class Failed(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check was not passed."""

    def __init__(self, evidence: Evidence, message: str, diagnosis: str | None = None, *, breaks: str = "") -> None:
        super().__init__(message)
        self.evidence = evidence  # what was seen
        self.message = message  # what happened in this case, in one or two sentences for the learner
        self.diagnosis = diagnosis  # a code of the catalogue when the cause is established, else None
        self.breaks = breaks  # the sentence of the exercise that is broken, where the check proves several
        self.instead = ""  # the check that it would cost by itself; where that is lost, too, nothing else is to blame
        self.steps: tuple[Arrow, ...] = ()  # what crossed the wire; taken from the record of the check when empty


@contextmanager
def charge_to(breaks: str) -> Iterator[None]:
    """What fails in here breaks this sentence, or costs this check, unless it names another one."""
    try:
        yield
    except Failed as failed:
        failed.breaks = failed.breaks or breaks
        raise


class UnseenError(Failed):
    """What a step was to show was over before the grader could see it: it shows nothing, and proves nothing."""


class UnansweredError(Failed):
    """The program runs and does not answer."""


class NotRun(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check that makes no sense in this grading; the text tells the learner why."""


TimedStep = tuple[float, Arrow]  # a step and when it happened, in seconds of the system's clock


@dataclass
class Exchange:
    """Something the grader has sent, and what came back for it."""

    about: str = ""
    minor: bool = False
    partner: str = NODE
    steps: list[TimedStep] = field(default_factory=list)
    further_steps: Callable[[], Iterable[TimedStep]] = tuple  # asked for when the check has failed

    def add_received(self, text: str, kind: Kind = "response") -> None:
        """Keep what the node has sent; as a "failure", what should have come and has not."""
        self.steps.append((time.time(), Arrow(self.partner, GRADER, kind, _cut(text))))


class ExchangeLog:
    """All turns of one check, in the order in which they began; `partner` is whom the grader talks with."""

    def __init__(self) -> None:
        self.partner = NODE
        self._turns: list[Exchange] = []
        self._looking = True

    def clear(self) -> None:
        """Forget everything: another check begins. What still comes for an old turn is ignored."""
        self._turns = []

    def forget_all_but(self, last: int) -> None:
        """Forget the oldest turns."""
        del self._turns[:-last]

    def last_exchange(self) -> tuple[str, str]:
        """What was sent last and what came for it, in words."""
        arrows = [arrow for _, arrow in self._turns[-1].steps] if self._turns else []
        sent = "; ".join(arrow.text for arrow in arrows if arrow.sender == GRADER)
        return sent, "; ".join(arrow.text for arrow in arrows if arrow.sender != GRADER)

    def sent_texts(self) -> Iterator[str]:
        """All that was sent, in words, as far as it is kept."""
        return (arrow.text for turn in self._turns for _, arrow in turn.steps if arrow.sender == GRADER)

    def add_sent(
        self, text: str, kind: Kind = "request", *, about: str = "", minor: bool = False, partner: str = ""
    ) -> Exchange:
        """Keep what the grader sends."""
        turn = self.begin_exchange(about, minor=minor, partner=partner)
        turn.steps.append((time.time(), Arrow(GRADER, turn.partner, kind, _cut(text))))
        return turn

    def begin_exchange(self, about: str = "", *, minor: bool = False, partner: str = "") -> Exchange:
        """Keep what the node sends by itself, or what the grader is about to send."""
        turn = Exchange(about, minor, partner or self.partner)
        if self._looking:
            self._turns.append(turn)
        return turn

    @contextmanager
    def looking_away(self) -> Iterator[None]:
        """Keep nothing meanwhile: for what the grader does to tidy up."""
        before, self._looking = self._looking, False
        try:
            yield
        finally:
            self._looking = before

    def steps(self, evidence: Evidence) -> tuple[Arrow, ...]:
        """The steps that led to a verdict: the turn it is about, else the last ones, and what was missed or wanted."""
        turns = [turn for turn in self._turns if turn.about and turn.about == evidence.sent][-1:]
        if not turns:
            turns = [turn for turn in self._turns if not turn.minor or turn is self._turns[-1]]
        pairs = sorted(
            (pair for turn in turns for pair in (*turn.steps, *turn.further_steps())), key=lambda pair: pair[0]
        )
        found = [step for _, step in pairs]
        if not found:
            return ()
        if (before := len(found) - _MOST) > 0:  # what is shown begins with what was asked
            sent = [step for step in found[:before] if step.sender == GRADER]
            asked = sent[-1:] if found[before].sender != GRADER else []
            before -= len(asked)
            note = f"({before} earlier step{'s' * (before > 1)} left out)"
            found = [*([Arrow(GRADER, GRADER, "note", note)] if before else []), *asked, *found[-_MOST:]]
        return (*found, *_end(found[-1], evidence))


def _end(last: Arrow, evidence: Evidence) -> Iterator[Arrow]:
    if evidence.got and (last.sender == GRADER or evidence.got.startswith("no ")):
        partner = last.receiver if last.sender == GRADER else last.sender
        yield Arrow(partner, GRADER, "failure", _cut(evidence.got))
    if evidence.expected:
        yield Arrow(GRADER, GRADER, "note", _cut(f"expected: {evidence.expected}"))


def in_one_line(message: Message) -> str:
    """A ROS message in one line, `value=21.5, from_unit='celsius'`; nested fields with a dot."""
    fields = list(_fields(message))
    listed = fields if len(fields) <= _FEW else [(name, value) for name, value in fields if value]
    digits = 0 if len(fields) <= _FEW else _FEWER_DIGITS
    words = [f"{name}={_value(value, digits)}" for name, value in listed]
    if len(listed) < len(fields):
        words.append("the rest 0" if listed else "all fields 0")
    return ", ".join(words)


def _fields(message: Message, before: str = "") -> Iterator[tuple[str, object]]:
    for name in message.get_fields_and_field_types():
        value = getattr(message, name)
        if hasattr(value, "get_fields_and_field_types"):
            yield from _fields(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def _value(value: object, digits: int) -> str:
    if isinstance(value, float):
        return repr(value) if value.is_integer() or not digits else f"{value:.{digits}g}"
    if isinstance(value, str):
        return repr(value if len(value) <= _LONGEST_TEXT else f"{value[:_LONGEST_TEXT]}...")
    return repr(value.tolist() if hasattr(value, "tolist") else value)  # an array as it is written in programs


def _cut(text: str) -> str:
    text = " ".join(text[: 10 * _LONGEST].split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."
