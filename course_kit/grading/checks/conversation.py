"""A conversation with a model: steps drawn at random, done on the node and on a reference in plain Python.

A step that disagrees is shrunk: the shortest part of the conversation that still fails on a fresh start of the program
is the evidence. Then the conversation goes on without the rules of the check that is lost.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Check, name_lost_node
from course_kit.grading.checks.evidence import Evidence, Failed, NotRun, UnansweredError, UnseenError
from course_kit.grading.checks.graded_node import GradedNode
from course_kit.grading.checks.steps import Rule, Step, Steps, rules_of
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.context import CheckContext

DEADLINE_S = 45.0  # for all waiting of a conversation, its shrinking included
_TALK_S = 30.0  # after which no further step is drawn: whoever is slow is asked less, and loses nothing by it
_TALK_SHARE = 0.4  # the same of a long deadline
_WALL, _WALL_AFTER_ALL = 0.8, 0.5  # as long as a rule has not been tried once, and from then on
_SHRINK_S = 2.5  # for all tries on one failure, after the first
_TAILS = (1, 2, 3, 5, 9, 17)  # so many of the last steps are tried by themselves
_STRIKES = 2  # after so many failures of a check that is lost already a rule is left out
_SILENT_RULES = 3  # so many different steps without an answer, and none that was right: it answers nothing
_OF_ONE_ANSWER = ("math.", "validation.", "field.")  # diagnoses that explain no step which is right by itself
_REMEMBERS = "service.remembers"
_ENDLESS = "limit.time"  # names its line; to see it again takes seconds of computing, and tells no more
_ENDED_AT_START = ("start.crash", "start.exit", "start.import")
_KEPT = 40  # turns of the record; what was before them is of no use


class Model:
    """What a right node does, in plain Python; made anew for each start of the program.

    A subclass keeps what a node has to remember, and has rules: methods that do one step on the node and expect what
    the model says.

    Attributes:
        history: the sentence of the exercise that is broken when a step fails only after others; for nodes that
            remember nothing. Empty where each rule's own sentence is the one.
        lost: ids of the checks that are lost already: what they are about is no use looking at again.

    Example:
        >>> class Counter(Model):
        ...     def __init__(self):
        ...         self.count = 0
        ...
        ...     @step_rule(amount=draw_one_of(0, 1, draw_between(-9, 9)))
        ...     def add(self, node, amount):
        ...         self.count += amount
        ...         node.call("/add_up", amount=amount).expect(total=self.count)
    """

    history = ""
    lost: frozenset[str] = frozenset()

    def begin(self, node: GradedNode) -> None:
        """Called when the program has just been started; for models that have to look what is there."""

    def kind_of(self, rule: str, /, **arguments: Any) -> object:  # noqa: ARG002 - for a subclass
        """Of which kind a step is: each kind comes after each other, as far as there are steps. Its rule's name."""
        return rule

    def act(self, node: GradedNode, step: Callable[[], object]) -> None:  # noqa: ARG002 - for a subclass
        """Called for each step, which it does; for models of what may have to be done again."""
        step()

    def end(self, node: GradedNode) -> None:
        """Called after the last step; for what may come late."""


@dataclass(frozen=True)
class CheckPart:
    """A check whose points hang on a conversation.

    Attributes:
        id: its id.
        title: one line for the learner.
        points: what it is worth.
        proves: ids of the sentences of the exercise; a failure names the one it breaks.
        after: ids of checks without which it makes no sense, beside those of the conversation.

    Example:
        >>> CheckPart("same_unit", "The same unit changes nothing", points=0.5, proves=["same_unit"])
    """

    id: str
    title: str
    points: float
    proves: Sequence[str]
    after: Sequence[str] = ()


def conversation(
    model: type[Model], *parts: CheckPart, steps: int, after: Sequence[str] = (), deadline_s: float = DEADLINE_S
) -> list[Check]:
    """The checks of a conversation with a node, which is held once for all of them.

    Args:
        model: the class of the reference.
        parts: the checks.
        steps: how many steps are done at least; each option of each rule comes once in any case.
        after: ids of checks without which it makes no sense.
        deadline_s: seconds for all waiting, shrinking included.

    Example:
        >>> counts = CheckPart("counts", "The counter counts", points=2.0, proves=["total"])
        >>> CHECKS += conversation(Counter, counts, steps=40)
    """

    def check_of(part: CheckPart) -> Check:
        def run(context: CheckContext) -> Evidence:
            held = context.conversations.get(model)
            if held is None:
                held = context.conversations[model] = Conversation(context, model, parts, steps)
                held.hold()
                if not model.history:
                    context.spoil()  # what the node remembers of it is nothing that a later check knows
            return held.verdict_of(part)

        return Check(part.id, part.title, part.points, (*after, *part.after), deadline_s, run, tuple(part.proves))

    return [check_of(part) for part in parts]


@dataclass
class Conversation:
    """A conversation that is being held, and what came of it."""

    context: CheckContext
    model: type[Model]
    parts: tuple[CheckPart, ...]
    steps: int
    last: Model | None = None  # the model of a conversation that has come to its end
    _failed: dict[str, Failed] = field(default_factory=dict)  # by checks
    _done: Counter[str] = field(default_factory=Counter)  # right steps, by checks
    _hindered: dict[str, str] = field(default_factory=dict)  # what kept a check from being judged
    _unseen: set[str] = field(default_factory=set)  # checks of which something was over before it could be seen
    _strikes: Counter[str] = field(default_factory=Counter)  # by rules
    _silent: set[str] = field(default_factory=set)  # rules whose step got no answer
    _apart: bool = False  # each rule on a fresh start: what one leaves behind for another is lost already

    def hold(self) -> None:
        """Hold it: all steps, or as many as there is time for."""
        steps = Steps(rules_of(self.model), random.Random(self.context.job.seed))  # noqa: S311 - test values, not secrets
        node, model, done = self._begin()
        clock = self.context.clock()
        for number in range(max(self.steps, steps.round)):
            first = self._rules_to_judge() if self._failed else ()
            step = steps.draw_step(model, done, apart=self._apart, first=first)
            if self._part_of(step.rule, "").id in self.lost_checks or self._strikes[step.rule.name] >= _STRIKES:
                continue
            all_tried = number > len(rules_of(self.model)) and not first
            wall = _WALL_AFTER_ALL if all_tried else _WALL  # of the time after which the program would be ended
            on_the_wall = clock.wall_s() > wall * self.context.job.limits.wall_s
            enough = all_tried and clock.has_passed(max(_TALK_S, _TALK_SHARE * self.context.deadline_s))
            if on_the_wall or enough or self.context.time_is_up():
                return
            if self._apart and done and done[-1].rule != step.rule:
                self.context.spoil()
                node, model, done = self._begin()
            try:
                step.do(node, model, done)
            except Failed as failed:
                self._keep(failed, done)
                if self._is_over(step, failed):
                    return
                self.context.spoil()
                try:
                    node, model, done = self._begin()
                except Failed as gone:  # what was not judged yet is not proven
                    ended = gone.diagnosis in _ENDED_AT_START  # else it may have had no time to come up
                    unproven = () if self.context.time_is_up() and not ended else self.parts
                    self._failed = {part.id: gone for part in unproven} | self._failed
                    return
            else:
                self._done[self._part_of(step.rule, "").id] += 1
            self.context.record.forget_all_but(_KEPT)
        self._end(node, model, done or [step])

    def _end(self, node: GradedNode, model: Model, done: list[Step]) -> None:
        """After the last step; when it fails again on fresh starts, as long as that costs another check."""
        fresh = False
        while not self.context.time_is_up():
            self.last, lost = model, self.lost_checks
            try:
                model.end(node)
            except Failed as failed:
                self._keep(failed, done)
            else:
                return
            if self.context.job.first_failure or (fresh and lost == self.lost_checks):
                return
            self.context.spoil()
            try:
                node, model, _ = self._begin()
            except Failed:
                return
            fresh = True

    def _is_over(self, step: Step, failed: Failed) -> bool:
        """Whether nothing more is asked after a failure: the first was wanted, or the program answers nothing."""
        if self.context.job.first_failure:
            return bool(self._failed)
        if self._done or len(self._silent) < _SILENT_RULES:
            return False
        title = self._part_of(step.rule, failed.breaks).title
        self._hindered = {part.id: title for part in self.parts} | self._hindered
        return True

    def _rules_to_judge(self) -> list[Rule]:
        """The rules whose check has neither failed nor had a right step."""
        judged = {*self.lost_checks, *self._done}
        open_rules = [rule for rule in rules_of(self.model) if self._part_of(rule, "").id not in judged]
        return [rule for rule in open_rules if self._strikes[rule.name] < _STRIKES]

    @property
    def lost_checks(self) -> frozenset[str]:
        """The ids of the checks that have failed, and of those that will not be run without them."""
        lost = set(self._failed)
        for part in self.parts:  # in the order in which they depend on each other
            if lost.intersection(part.after):
                lost.add(part.id)
        return frozenset(lost)

    def verdict_of(self, part: CheckPart) -> Evidence:
        """What came of it for one of its checks; raises NotRun, or GradingError, where it could not be judged."""
        failed, hindered_by = self._failed.get(part.id), self._hindered.get(part.id)
        if failed is not None:
            simpler = next((other for other in self.parts if other.id == failed.instead), None)
            if simpler is None or simpler.id not in self._failed:
                raise failed
            hindered_by = simpler.title
        done = self._done[part.id]
        if not done and part.id in self._unseen:
            raise GradingError(f'the machine is too busy to judge "{part.title}": grade it again later.')
        # What fails only after this went right shows that it did.
        is_shown = any(part.id in other.after and other.id in self._failed for other in self.parts)
        if not (done or is_shown) and any(rule.check in (part.id, "") for rule in rules_of(self.model)):
            raise NotRun(f'because "{hindered_by}" did not pass.' if hindered_by else "because no time was left.")
        return Evidence("a conversation drawn by the seed", part.title, f"{done} drawn steps, each as it should be")

    def _begin(self) -> tuple[GradedNode, Model, list[Step]]:
        """A program that has just been started, and a model for it."""
        node = GradedNode(self.context)
        node.ensure_running()
        model = self.model()
        model.lost = self.lost_checks
        model.begin(node)
        self.context.record.clear()
        return node, model, []

    def _part_of(self, rule: Rule, sentence: str) -> CheckPart:
        """The check that a broken sentence costs, or the check that is named in its place; first the rule's own."""
        own = next((part for part in self.parts if part.id == rule.check), self.parts[0])
        if not sentence or sentence in own.proves:
            return own
        return next((part for part in self.parts if sentence in (part.id, *part.proves)), own)

    def _keep(self, failed: Failed, done: list[Step]) -> None:
        """Keep a failure for the check that it costs, shrunk; of a check that is lost already only the count."""
        last = done[-1]
        if isinstance(failed, UnseenError):
            self._unseen.add(self._part_of(last.rule, "").id)
            return
        name_lost_node(self.context, failed)
        lost, fails_alone = self._part_of(last.rule, failed.breaks), len(done) == 1
        if lost.id not in self._failed:
            endless = failed.diagnosis == _ENDLESS
            if endless:
                self.context.record.forget_all_but(1)
            shown = failed.evidence if fails_alone else replace(failed.evidence, sent="")  # with what was before
            failed.steps = failed.steps or self.context.record.steps(shown)
            shrinks = not endless and not self.context.job.first_failure and self.context.job.mode != "attach"
            if shrinks and (not fails_alone or self.last):
                failed, lost, needed = self._shrink(failed, done, lost)
                fails_alone = needed == 1
                if self.model.history and needed > 1:
                    self._apart = True
                    lost = self._part_of(last.rule, self.model.history)
        known = lost.id in self._failed
        self._strikes[last.rule.name] += known
        self._failed.setdefault(lost.id, failed)
        if silent := isinstance(failed, UnansweredError):
            self._strikes[last.rule.name] = _STRIKES
            self._silent.add(last.rule.name)
        self._credit(failed, last, lost, again=not (fails_alone and (known or silent)))

    def _credit(self, failed: Failed, last: Step, lost: CheckPart, *, again: bool) -> None:
        """A rule that fails for another check is right for its own where the step passes, once that check is lost."""
        own = self._part_of(last.rule, "")
        if own == lost or self._done[own.id] or self.context.job.first_failure:
            return
        found = self._find_failure([last]) if again and self.context.job.mode != "attach" else (failed, last)
        if found is None:
            self._done[own.id] += 1
        else:  # what else is drawn for it may go right; and another failure is seen when it is drawn next
            is_lost = self._part_of(last.rule, found[0].breaks).id in self._failed
            self._strikes[last.rule.name] = max(self._strikes[last.rule.name], int(is_lost))
            self._hindered[own.id] = lost.title

    def _shrink(self, failed: Failed, done: list[Step], lost: CheckPart) -> tuple[Failed, CheckPart, int]:
        """The failure of the shortest part of a conversation, the check that it costs, and how many steps that has."""
        clock = self.context.clock()
        shrinks, best, found = False, done, (failed, lost)
        tails = _TAILS[:2] if self.model.history else _TAILS  # what remembers nothing is quick to ask all again
        for length in sorted({*(length for length in tails if length < len(done)), len(done)}):
            if length > 1 and clock.has_passed(_SHRINK_S) and not self.model.history:
                break
            if again := self._fails(done[-length:], lost):
                shrinks, best, found = True, done[-length:], again
                break
        size = len(best)
        while shrinks and size > 1 and best[2:]:  # first half of them is left out, then a quarter, at last one
            size, place = (size + 1) // 2, 0
            while place < len(best) - 1 and not clock.has_passed(_SHRINK_S):
                shorter = [*best[:place], *best[min(place + size, len(best) - 1) :]]
                if again := self._fails(shorter, lost):
                    best, found = shorter, again
                else:
                    place += size
        shortest = found[0]
        if not shrinks and len(done) > 1:  # by itself the last step is right
            shortest.message = f"{shortest.message} This failed after {len(done) - 1} other steps."
        if self.model.history and len(best) > 1:
            if (shortest.diagnosis or "").startswith(_OF_ONE_ANSWER):  # whose reason is that of another fault
                shortest.message, shortest.diagnosis = "By itself, the same request is answered rightly.", None
            shortest.diagnosis = shortest.diagnosis or _REMEMBERS
            shortest.message = f"{shortest.message} It takes what was sent before to bring this about."
        return (*found, len(best))

    def _fails(self, steps: Sequence[Step], lost: CheckPart) -> tuple[Failed, CheckPart] | None:
        """How these steps fail on a fresh start, and what that costs; None when they do not, or cost what is lost."""
        failed, step = self._find_failure(steps, to_the_end=self.last is not None) or (None, None)
        if failed is None or step is None or isinstance(failed, UnseenError):
            return None
        name_lost_node(self.context, failed)
        costs = self._part_of(step.rule, failed.breaks)
        if costs != lost and costs.id in self._failed:
            return None
        record, several = self.context.record, len(steps) > 1
        failed.steps = record.steps(replace(failed.evidence, sent="") if several else failed.evidence)
        if several and (before := list(record.sent_texts())[:-1]):
            failed.evidence = replace(failed.evidence, sent="; ".join([*before, failed.evidence.sent]))
        return failed, costs

    def _find_failure(self, steps: Sequence[Step], *, to_the_end: bool = False) -> tuple[Failed, Step | None] | None:
        """How these steps fail on a fresh start, and at which; at none when the program does not come up."""
        self.context.spoil()
        step = None
        try:
            node, model, done = self._begin()
            for step in steps:
                step.do(node, model, done)
            if to_the_end:
                model.end(node)
        except Failed as failed:
            return failed, step
        return None
