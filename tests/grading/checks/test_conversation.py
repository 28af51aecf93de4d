"""A conversation with a program that is stood in for: what a failure costs, and how it is shrunk."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import FunctionType, SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.grading.checks.evidence import Evidence, ExchangeLog, Failed, NotRun, UnansweredError, UnseenError
from course_kit.grading.checks.vocabulary import CheckPart, Model, conversation, draw_one_of, step_rule
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from course_kit.grading.checks.vocabulary import Check, GradedNode


@dataclass
class StandIn:
    """A context whose program is a list of what it was asked since it was started."""

    asked: list[str] = field(default_factory=list)
    starts: int = 1
    memory: dict[str, Any] = field(default_factory=lambda: {"met": True, "heard": {}})
    conversations: dict[type, Any] = field(default_factory=dict)
    record: ExchangeLog = field(default_factory=ExchangeLog)
    spoiled: bool = False
    job: Any = field(
        default_factory=lambda: SimpleNamespace(
            seed=1, first_failure=False, mode="run", limits=SimpleNamespace(wall_s=60.0)
        )
    )
    deadline_s: float = 45.0

    def spoil(self) -> None:
        self.asked, self.starts = [], self.starts + 1

    def ask(self, what: str) -> list[str]:
        self.record.add_sent(what)
        self.asked.append(what)
        return self.asked

    def clock(self) -> Any:
        return SimpleNamespace(wall_s=lambda: 0.0, has_passed=lambda _: False)

    def time_is_up(self) -> bool:
        return False

    @property
    def program(self) -> Any:
        return SimpleNamespace(lost_in=lambda: 0)


def fail(sent: str, code: str | None = None, breaks: str = "") -> None:
    raise Failed(Evidence(sent, "right", "wrong"), f"{sent} is wrong.", code, breaks=breaks)


def judge(checks: list[Check], context: StandIn) -> dict[str, str]:
    """What came of each check: passed, why it was not run, or what failed."""
    return {one.id: outcome_of(one, context) for one in checks}


def outcome_of(check: Check, context: StandIn) -> str:
    try:
        check.run(context)  # type: ignore[arg-type]
    except Failed as failed:
        return failed.message
    except NotRun as reason:
        return str(reason)
    return "passed"


class Letters(Model):
    """Three kinds of steps; a program is right when it was never asked for c after a."""

    @step_rule("a", times=draw_one_of(1, 2))
    def ask_a(self, node: GradedNode, times: int) -> None:
        for _ in range(times):
            node.context.ask("a")  # type: ignore[attr-defined]

    @step_rule("b", often=8)
    def ask_b(self, node: GradedNode) -> None:
        node.context.ask("b")  # type: ignore[attr-defined]

    @step_rule("c", often=3)
    def ask_c(self, node: GradedNode) -> None:
        if "a" in node.context.ask("c"):  # type: ignore[attr-defined]
            fail("c")


def checks_of(model: type[Model]) -> list[Check]:
    return conversation(model, *(CheckPart(name, name, points=1.0, proves=[f"on_{name}"]) for name in "abc"), steps=40)


def test_a_failure_costs_its_own_check_and_is_shrunk_to_the_steps_that_it_takes() -> None:
    context = StandIn()
    assert judge(checks_of(Letters), context) == {"a": "passed", "b": "passed", "c": "c is wrong."}
    lost = context.conversations[Letters].verdict_of
    with pytest.raises(Failed) as failure:
        lost(next(one for one in context.conversations[Letters].parts if one.id == "c"))
    assert failure.value.evidence.sent in {"a; c", "a; a; c"}
    assert [step.text for step in failure.value.steps][-2:] == ["wrong", "expected: right"]


def test_a_failure_that_names_a_sentence_costs_the_check_that_proves_it() -> None:
    class Elsewhere(Letters):
        @step_rule("c")
        def ask_c(self, node: GradedNode) -> None:
            if len(node.context.ask("c")) > 1:  # type: ignore[attr-defined]
                fail("c", breaks="on_b")

    found = judge(checks_of(Elsewhere), StandIn())
    assert found == {"a": "passed", "b": "c is wrong.", "c": "passed"}  # which is right by itself


@pytest.mark.parametrize("seen", [0, 1])
def test_what_was_never_seen_is_neither_right_nor_wrong(seen: int) -> None:
    class Late(Letters):
        @step_rule("c", times=draw_one_of(1, 2, 3))
        def ask_c(self, node: GradedNode, times: int) -> None:
            del node
            if times > seen:
                raise UnseenError(Evidence("c"), "It was over.")

    checks, context = checks_of(Late), StandIn()
    if seen:
        assert judge(checks, context)["c"] == "passed"
        return
    with pytest.raises(GradingError, match="grade it again"):
        judge(checks, context)


def test_an_endless_loop_is_met_once() -> None:
    class Endless(Letters):
        @step_rule("c", often=3)
        def ask_c(self, node: GradedNode) -> None:
            node.context.ask("c")  # type: ignore[attr-defined]
            fail("c", "limit.time")

    context = StandIn()
    assert judge(checks_of(Endless), context)["c"] == "c is wrong."
    assert context.starts == 1 + 1 + 1  # at first, after the failure, and for the checks after the conversation


def test_a_program_that_does_not_come_up_again_has_proven_nothing_more(monkeypatch: pytest.MonkeyPatch) -> None:
    context = StandIn()

    def gone(_: Model, node: GradedNode) -> None:
        if node.context.starts > 1:  # type: ignore[attr-defined]
            fail("start", "start.crash")

    monkeypatch.setattr(Letters, "begin", gone)
    found = judge(checks_of(Letters), context)
    assert (found["a"], found["b"]) == ("start is wrong.", "start is wrong.")
    assert found["c"].startswith("c is wrong. This failed after ")  # it cannot be shrunk


def test_a_program_that_had_no_time_to_come_up_again_is_not_blamed_for_that(monkeypatch: pytest.MonkeyPatch) -> None:
    class Late(StandIn):
        def time_is_up(self) -> bool:
            return self.starts > 1

    context = Late()
    monkeypatch.setattr(Letters, "begin", lambda _, node: node.context.time_is_up() and fail("start"))
    found = judge(checks_of(Letters), context)
    assert found["c"].startswith("c is wrong.")
    assert {found["a"], found["b"]} <= {"passed", 'because "c" did not pass.', "because no time was left."}
    monkeypatch.setattr(Letters, "begin", lambda _, node: node.context.time_is_up() and fail("start", "start.crash"))
    assert judge(checks_of(Letters), Late())["a"] == "start is wrong."  # which is not for want of time


@pytest.mark.parametrize(("also_a", "of_c"), [(True, 'because "a" did not pass.'), (False, "c is wrong.")])
def test_what_a_simpler_cause_explains_costs_nothing_more(*, also_a: bool, of_c: str) -> None:
    class Blamed(Letters):
        @step_rule("a")
        def ask_a(self, node: GradedNode) -> None:
            if node.context.ask("a") and also_a:  # type: ignore[attr-defined]
                fail("a")

        @step_rule("c")
        def ask_c(self, node: GradedNode) -> None:
            node.context.ask("c")  # type: ignore[attr-defined]
            failed = Failed(Evidence("c"), "c is wrong.")
            failed.instead = "a"
            raise failed

    assert judge(checks_of(Blamed), StandIn())["c"] == of_c


def test_a_program_that_answers_nothing_is_asked_three_different_things() -> None:
    def be_silent(_: Model, node: GradedNode) -> None:
        node.context.ask("it")  # type: ignore[attr-defined]
        raise UnansweredError(Evidence("it"), "No answer.", breaks="a")

    rules = {}
    for name in "abcde":
        step = FunctionType(be_silent.__code__, globals(), f"ask_{name}", None, be_silent.__closure__)
        rules[step.__name__] = step_rule(name)(step)
    silent, context = type("Silent", (Model,), rules), StandIn()
    found = judge(conversation(silent, *(CheckPart(name, name, 1.0, []) for name in "abcde"), steps=40), context)
    assert found == {"a": "No answer."} | dict.fromkeys("bcde", 'because "a" did not pass.')
    assert context.starts == 1 + 2 + 1  # after two of three failures, and for the checks after the conversation


def test_what_its_end_shows_costs_each_check_that_it_breaks() -> None:
    class Ended(Letters):
        def end(self, _: GradedNode) -> None:
            for name in sorted({"a", "b"} - self.lost):
                fail(name, breaks=f"on_{name}")

    assert judge(checks_of(Ended), StandIn()) == {name: f"{name} is wrong." for name in "abc"}


def test_what_hangs_on_a_lost_check_is_asked_no_more() -> None:
    class Wrong(Letters):
        @step_rule("a")
        def ask_a(self, node: GradedNode) -> None:
            fail(node.context.ask("a")[0])  # type: ignore[attr-defined]

        @step_rule("c", often=3)
        def ask_c(self, node: GradedNode) -> None:
            assert "a" not in conversations[Wrong].lost_checks
            node.context.ask("c")  # type: ignore[attr-defined]

    context = StandIn()
    conversations = context.conversations
    parts = [CheckPart(name, name, 1.0, [], after=["a"] * (name == "c")) for name in "abc"]
    assert judge(conversation(Wrong, *parts, steps=40), context)["a"] == "a is wrong."
    assert conversations[Wrong].lost_checks == {"a", "c"}
