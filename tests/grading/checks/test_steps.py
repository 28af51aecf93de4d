"""The order in which the steps of a conversation are drawn."""

from __future__ import annotations

import itertools
import random
from typing import Any

from course_kit.grading.checks.steps import Step, Steps, rules_of
from course_kit.grading.checks.vocabulary import Model, draw_one_of, step_rule

VOLTS = (9.0, 10.0, 10.2, 10.5)
STATES = ("ok", "critical", "recovered")


class Battery(Model):
    state = "ok"

    @step_rule(volts=draw_one_of(*VOLTS))
    def measure(self, _node: object, volts: float) -> None:
        recovers = self.state == "critical" and volts >= 10.5
        self.state = "critical" if volts < 10.0 else "recovered" if recovers else self.state

    @step_rule(when=lambda model: model.state != "critical")
    def reset(self, _node: object) -> None:
        self.state = "ok"


class Counter(Model):
    """A model that is in another state after each step."""

    def __init__(self) -> None:
        self.count = 0

    @step_rule(amount=draw_one_of(1, 2, 3))
    def add(self, _node: object, amount: int) -> None:
        self.count += amount

    @step_rule(often=2, rule="ten")  # an argument may have this name
    def skip(self, _node: object, rule: str) -> None:
        assert rule == "ten"
        self.count += 10


def talk(model: Any, seed: int, count: int) -> list[tuple[str, Step]]:
    steps, done = Steps(rules_of(type(model)), random.Random(seed)), []  # noqa: S311
    for _ in range(count):
        step = steps.draw_step(model, [step for _, step in done], apart=False)
        done.append((getattr(model, "state", ""), step))
        step.do(None, model, [])  # type: ignore[arg-type] - a model that needs no node
    return done


def test_a_model_of_few_states_meets_each_option_in_each_state() -> None:
    for seed in range(30):
        met = {(state, step.arguments.get("volts")) for state, step in talk(Battery(), seed, 80)}
        assert met >= {(state, volts) for state in STATES for volts in VOLTS}, seed
        assert {("ok", None), ("recovered", None)} <= met, seed


def test_in_a_round_each_option_comes_once() -> None:
    for seed in range(30):
        first = [step for _, step in talk(Counter(), seed, 5)]
        assert sorted(step.arguments.get("amount", 0) for step in first) == [0, 0, 1, 2, 3], seed


def test_what_has_to_come_first_comes_first_in_each_round() -> None:
    steps, first = Steps(rules_of(Counter), random.Random(1)), rules_of(Counter)[:1]  # noqa: S311
    drawn = [steps.draw_step(Counter(), [], apart=False, first=first) for _ in range(9)]
    assert {step.rule.name for step in drawn} == {"add"}


class Forgetful(Model):
    """A model of three kinds of steps, of which two are one rule's."""

    @step_rule(often=12, even=draw_one_of(True, False))
    def ask(self, _node: object, even: bool) -> None: ...

    @step_rule(often=6)
    def refuse(self, _node: object) -> None: ...

    def kind_of(self, rule: str, /, **arguments: Any) -> object:
        return (rule, arguments.get("even"))


def test_in_a_round_each_kind_of_step_comes_after_each_other() -> None:
    model = Forgetful()
    for seed in range(30):
        kinds = [step.kind for _, step in talk(model, seed, 18)]
        assert len(set(itertools.pairwise(kinds))) == 9, seed


def test_a_step_that_is_left_out_comes_after_no_other_and_none_comes_after_a_restart() -> None:
    class Partly(Forgetful):
        @step_rule(often=6)
        def lose(self, _node: object) -> None: ...

    for seed in range(30):
        steps, done, pairs = Steps(rules_of(Partly), random.Random(seed)), [], set()  # noqa: S311
        for number in range(36):
            done = done if number % 5 else []
            step = steps.draw_step(Partly(), done, apart=False)
            if step.rule.name != "lose":
                pairs |= {(before.kind, step.kind) for before in done[-1:]}
                done.append(step)
        assert len(pairs) == 9, seed


def test_the_same_seed_draws_the_same_steps() -> None:
    def told(seed: int) -> list[tuple[str, dict[str, Any]]]:
        return [(step.rule.name, step.arguments) for _, step in talk(Battery(), seed, 60)]

    assert told(1) == told(1)
    assert told(1) != told(2)
