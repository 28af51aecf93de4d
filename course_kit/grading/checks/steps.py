"""The steps of a conversation: rules, each a kind of step, what is drawn for them, and in which order."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Sequence

    from course_kit.grading.checks.graded_node import GradedNode

_FEW_STATES = 8  # that a model is seen in; with more of them each option in each would take too long
_BY_STATE = 0.7  # of the steps, as long as there is something untried
_RULE = "_course_kit_rule"


@dataclass(frozen=True)
class Draw:
    """A value that is drawn for each step."""

    options: tuple[Any, ...]
    make: Callable[[random.Random], Any] | None = None


def draw_one_of(*options: Any) -> Draw:
    """One of these: each comes once before one comes a second time, so that no edge is left to chance.

    Args:
        options: values, or other drawings.

    Example:
        >>> @step_rule(value=draw_one_of(0.0, 32.0, math.nan, draw_between(-200.0, 500.0)))
        ... def convert(self, node, value): ...
    """
    return Draw(options)


def draw_between(low: float, high: float) -> Draw:
    """A number in a range, both ends included; a whole one for two whole ends.

    Example:
        >>> @step_rule(order=draw_between(1, 9))
        ... def count(self, node, order): ...
    """
    whole = isinstance(low, int) and isinstance(high, int)
    return Draw((), lambda rng: rng.randint(int(low), int(high)) if whole else rng.uniform(low, high))


def draw_by(make: Callable[[random.Random], Any]) -> Draw:
    """What a function makes of a random.Random.

    Example:
        >>> @step_rule(values=draw_by(lambda rng: [rng.uniform(-1, 1) for _ in range(3)]))
        ... def several(self, node, values): ...
    """
    return Draw((), make)


def draw_values(value: Any, rng: random.Random) -> Any:
    """A list, a dict or a value in which each drawing is replaced by what it gives."""
    if isinstance(value, dict):
        return {name: draw_values(part, rng) for name, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [draw_values(part, rng) for part in value]
    if not isinstance(value, Draw):
        return value
    return value.make(rng) if value.make else draw_values(rng.choice(value.options), rng)


@dataclass(frozen=True)
class Rule:
    """A kind of step of a model; see `step_rule`."""

    name: str
    check: str
    draws: dict[str, Any]
    when: Callable[[Any], bool]  # whether such a step may be done now, by the model
    often: int
    run: Callable[..., None]

    def options(self) -> list[_Option]:
        """What can be drawn for it; the rule itself where nothing is to choose."""
        several = [(name, draw) for name, draw in self.draws.items() if isinstance(draw, Draw)]
        found = [_Option(self.name, name, place) for name, draw in several for place in range(len(draw.options))]
        return found or [_Option(self.name)]


class _Option(NamedTuple):
    rule: str
    argument: str = ""
    place: int = 0


def step_rule(
    check: str = "", *, when: Callable[[Any], bool] = lambda _: True, often: int = 0, **draws: Any
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Decorator that makes a method of a `Model` a kind of step.

    Args:
        check: the id of the check that a failure costs, where the conversation has several.
        when: says of the model whether the step may be done now.
        often: how often it is done while each other rule goes through its options once; as many times as its longest
            `draw_one_of` has options when 0.
        draws: a drawing or a constant for each argument of the method after `node`.

    Example:
        >>> @step_rule(when=lambda model: model.critical)
        ... def reset(self, node):
        ...     node.call("/reset").refused()
    """

    def declare(function: Callable[..., None]) -> Callable[..., None]:
        times = often or max([1, *(len(draw.options) for draw in draws.values() if isinstance(draw, Draw))])
        setattr(function, _RULE, Rule(function.__name__, check, draws, when, times, function))
        return function

    return declare


def rules_of(model: type) -> list[Rule]:
    """The rules of a model's class, by name."""
    return [found for name in dir(model) if (found := getattr(getattr(model, name), _RULE, None))]


@dataclass(frozen=True)
class Step:
    """One step: a rule, what was drawn for it, and of which kind it is."""

    rule: Rule
    arguments: dict[str, Any]
    kind: object
    options: set[_Option]

    def do(self, node: GradedNode, model: Any, done: list[Step]) -> None:
        """Do it and note it, unless the model does not allow it now."""
        if self.rule.when(model):
            done.append(self)
            model.act(node, lambda: self.rule.run(model, node, **self.arguments))


class Steps:
    """Draws steps without end: each option of each rule once, then all again; each kind of step after each other kind.

    Of a model with few states each option comes in each state: what depends on what was before is not left to chance.
    """

    def __init__(self, rules: Sequence[Rule], rng: random.Random) -> None:
        self._rng, self._rules = rng, tuple(rules)
        self._hands: dict[int, list[int]] = {}
        self.round = sum(rule.often for rule in rules)
        self._waiting: list[Step] = []
        self._drawn = 0
        self._seen: dict[str, set[_Option]] = {}  # by the model's state: which options have been tried in it
        self._met: set[tuple[object, object]] = set()  # kinds of steps, one after the other

    def draw_step(self, model: Any, done: Sequence[Step], *, apart: bool, first: Sequence[Rule] = ()) -> Step:
        """The next step after those done since the program's start, of one of the rules that have to come `first`.

        `apart`, all of a rule come one after the other.
        """
        kinds = [None, *(step.kind for step in done[-2:])][-2:]  # those before were the last two at the draws before
        self._met.update(pairwise(kinds))
        values = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
        state = repr({name: value for name, value in values.items() if not callable(value)})
        seen = self._seen.setdefault(state, set())
        self._drawn += 1
        by_state = self._drawn > self.round and not (apart or first) and self._rng.random() < _BY_STATE
        untried = []
        if by_state and seen and len(self._seen) <= _FEW_STATES:
            allowed = [rule for rule in self._rules if rule.when(model)]
            untried = [(rule, option) for rule in allowed for option in rule.options() if option not in seen]
        if untried:
            step = self._draw(model, *self._rng.choice(untried))
        else:
            step = self._take(model, kinds[-1], apart=apart, first=first)
        seen |= step.options
        return step

    def _take(self, model: Any, last: object, *, apart: bool, first: Sequence[Rule]) -> Step:
        """From the hand of a round: a step whose kind has not come after the last one's yet, if there is one."""
        if not self._waiting:
            rules = [rule for rule in self._rules for _ in range(rule.often - 1)]
            self._rng.shuffle(rules)
            rules += self._rng.sample(self._rules, len(self._rules))  # taken first: who is slow shows all once
            self._waiting = [self._draw(model, rule) for rule in rules]
        if first:
            places = [place for place, step in enumerate(self._waiting) if step.rule in first]
            return self._waiting.pop(places[-1]) if places else self._draw(model, self._rng.choice(first))
        if apart:
            self._waiting.sort(key=lambda step: step.rule.name)
        elif self._drawn > len(self._rules):
            new = (place for place, step in enumerate(self._waiting) if (last, step.kind) not in self._met)
            return self._waiting.pop(max(new, default=-1))
        return self._waiting.pop()

    def _draw(self, model: Any, rule: Rule, wanted: _Option | None = None) -> Step:
        arguments, options = {}, {_Option(rule.name)}
        for name, draw in rule.draws.items():
            if not isinstance(draw, Draw) or not draw.options:
                arguments[name] = draw_values(draw, self._rng)
                continue
            place = wanted.place if wanted and wanted.argument == name else self._deal_option(draw)
            options.add(_Option(rule.name, name, place))
            arguments[name] = draw_values(draw.options[place], self._rng)
        return Step(rule, arguments, model.kind_of(rule.name, **arguments), options)

    def _deal_option(self, draw: Draw) -> int:
        """The place of the next option, as from a hand of cards."""
        hand = self._hands.setdefault(id(draw), [])
        if not hand:
            hand += self._rng.sample(range(len(draw.options)), len(draw.options))
        return hand.pop()
