"""Checks: how a grader declares them, and how they are run one after another.

A check is a function that talks to the submission over the wire and either returns `Evidence` or raises `Failed`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.evidence import Evidence, Failed, NotRun
from course_kit.grading.diagnosis import causes
from course_kit.grading.errors import GradingError
from course_kit.grading.model.report import CheckResult

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.grading.checks.context import CheckContext


@dataclass(frozen=True)
class Check:
    """One thing a submission must do."""

    id: str  # its name in reports
    title: str  # one line for the learner
    points: float  # what it is worth
    depends_on: tuple[str, ...]  # ids of checks without which it makes no sense; it is skipped unless they passed
    deadline_s: float  # seconds for all its waiting together
    run: Callable[[CheckContext], Evidence]
    proves: tuple[str, ...] = ()  # ids of the sentences in exercise.toml that it proves


def require_order(checks: Sequence[Check]) -> None:
    """Each check has its own id, and comes after those it depends on."""
    before: list[str] = []
    for check in checks:
        if check.id in before:
            raise ValueError(f"two checks are called {check.id}")
        if unmet := [name for name in check.depends_on if name not in before]:
            raise ValueError(f"the check {check.id} is never run: {', '.join(unmet)} does not come before it")
        before.append(check.id)


def choose_part(checks: Sequence[Check], part: str) -> list[Check]:
    """The checks of one part, whose ids begin with its name (`door`: `door_locked`), and those they depend on."""
    chosen = {check.id for check in checks if f"{check.id}_".startswith(f"{part}_")}
    if not chosen:
        raise GradingError(f"There is no part '{part}'. The checks are: {', '.join(check.id for check in checks)}.")
    for check in reversed(checks):
        if check.id in chosen:
            chosen.update(check.depends_on)
    return [check for check in checks if check.id in chosen]


def run_all(checks: Sequence[Check], context: CheckContext) -> Iterator[CheckResult]:
    """Run the checks, yielding each result as soon as it is known."""
    require_order(checks)
    lost: dict[str, list[str]] = {}  # for each check that failed or waits for such a one: what failed, as quoted titles
    broken = ""
    for check in checks:
        missing = list(dict.fromkeys(title for name in check.depends_on for title in lost.get(name, ())))
        if broken or missing:  # where the grader has failed there is no grade
            lost[check.id] = missing
            why = f'the grader failed in "{broken}"' if broken else f"{' and '.join(missing)} did not pass"
            yield CheckResult(check.id, check.title, "skipped", check.points, message=f"Not run, because {why}.")
            continue
        result = replace(_run(check, context), proves=check.proves)
        if result.status != "passed":
            lost[check.id] = [f'"{check.title}"']
        if result.status == "error":
            broken = check.title
        yield result


def _run(check: Check, context: CheckContext) -> CheckResult:
    try:
        context.begin(check.deadline_s)
        seen = check.run(context)
    except Failed as verdict:
        name_lost_node(context, verdict)
        seen, status, diagnosis, message = verdict.evidence, "failed", verdict.diagnosis, verdict.message
        steps, graph = verdict.steps or context.record.steps(seen), context.see_graph()
    except GradingError:
        raise
    except NotRun as reason:
        return CheckResult(check.id, check.title, "skipped", check.points, message=f"Not run, {reason}")
    except Exception as problem:  # noqa: BLE001 - whatever it is, it is our fault and must not cost any points
        text = f"The grader itself failed here ({type(problem).__name__}: {problem}). This is not your fault."
        return CheckResult(check.id, check.title, "error", check.points, message=text)
    else:
        status, diagnosis, message, steps, graph = "passed", None, "", (), seen.graph
    details = (seen.sent, seen.expected, seen.got, diagnosis, message, steps)
    return CheckResult(check.id, check.title, status, check.points, *details, graph=graph)


def name_lost_node(context: CheckContext, failed: Failed) -> None:
    """Where a silent program's node has lost its executor, that is the reason."""
    if failed.evidence.got.startswith("no ") and (place := context.program.lost_in()):
        failed.diagnosis = "action.node_lost"
        failed.message = f"A callback spins its own node in {causes.source_line(context.job, place)}."
