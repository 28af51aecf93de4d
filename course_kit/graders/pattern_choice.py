"""Exercise 4: which communication pattern fits. The answers are read and marked; no ROS is involved.

Half a point for each pattern, half for each reason. A student edition lacks the answers to what counts: there nothing
is marked, and what is said is whether the submission is complete.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from course_kit import quiz
from course_kit.grading.checks.check import Check
from course_kit.grading.checks.evidence import Evidence, Failed
from course_kit.grading.diagnosis import causes
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.quiz import MarkedAnswers, Scenario

_SHAPE = 'a dictionary: answers = {"<scenario id>": ("<pattern>", "<reason id>"), ...}'
_MARK_S = 5.0
_PROVES = {"pattern": ("pattern", "others_count"), "reason": ("reason", "decides", "own_reason", "others_count")}
_MOST_NAMED = 20  # entries that belong to no scenario
_FOUND = ("too_large", "value", "entries")  # what is said of a variable that is set


def checks_for(job: Job) -> list[Check]:
    """The checks of the scenarios that the job's seed draws: two for each, after one that reads the answers."""
    sheet, after = _Sheet(quiz.draw(job.seed)), ("answers",)
    # Worth nothing by themselves: all points go to the halves.
    checks = [
        Check("answers", "There is a dictionary of answers", 0.0, (), job.limits.wall_s, sheet.read, ("dictionary",)),
        Check("known_ids", "Every entry belongs to a scenario", 0.0, after, _MARK_S, sheet.known_ids, ("no_scenario",)),
    ]
    for place, scenario in enumerate(sheet.scenarios):
        for half, proves in _PROVES.items():
            title, mark = f"{half.capitalize()}: {scenario.title}", partial(sheet.mark, place, half)
            checks.append(Check(f"{scenario.id}_{half}", title, 0.5, after, _MARK_S, mark, proves))
    return checks


class _Sheet:
    """The answers of one submission, read by the first check and marked for the others."""

    def __init__(self, scenarios: tuple[Scenario, ...]) -> None:
        self.scenarios = scenarios
        self._result: MarkedAnswers  # from the first check on

    def read(self, context: CheckContext) -> Evidence:
        entries = _read(context)
        self._result = quiz.mark(self.scenarios, entries)
        if not self._result.is_final:
            why = "your instructor marks the scenarios of this seed: this edition of the course lacks their answers."
            raise GradingError(f"{why} {self._result.describe_state()} To practise, leave the seed out.")
        return Evidence("", _SHAPE, f"a dictionary with {len(entries)} entries")

    def known_ids(self, _: CheckContext) -> Evidence:
        strangers = self._result.strangers
        expected = "ids of scenarios only"
        if not strangers:
            return Evidence("", expected, expected)
        drawn = [scenario.id for scenario in self.scenarios]
        meant = {name: quiz.nearest(name, drawn) for name in strangers[:_MOST_NAMED]}
        named = [f"'{name}' (did you mean '{near}'?)" if near else f"'{name}'" for name, near in meant.items()]
        if (others := len(strangers) - len(named)) > 0:
            named.append(f"{others} more")
        message = f"These entries belong to no scenario: {'; '.join(named)}. They do not change your points."
        raise Failed(Evidence("", expected, ", ".join(strangers)), message, "quiz.unknown")

    def mark(self, place: int, half: str, context: CheckContext) -> Evidence:
        scenario, marked = self._result.marks[place].scenario, getattr(self._result.marks[place], half)
        if half == "pattern":
            sent, expected = f"{scenario.id}: {scenario.text}", "the pattern that fits: topic, service or action"
            got = marked.got
        else:
            listed = ", ".join(name for name, _ in quiz.reasons_as_shown(scenario, context.job.seed))
            sent, expected = "", f"the reason that decides, out of {listed}"
            got = ": ".join(filter(None, (marked.got, scenario.reasons.get(marked.got))))
        evidence = Evidence(sent, expected, got or "nothing")
        if not marked.right:
            raise Failed(evidence, marked.explanation, marked.code)
        return evidence


def _read(context: CheckContext) -> dict[object, object]:
    """The entries of the submission, by reading it if that is enough, else by running it."""
    told, variable, code = context.job.text.literal or _run(context), context.job.variable, "quiz.malformed"
    if told.get("too_large"):
        raise Failed(Evidence("", _SHAPE, "far more"), f"{variable} is too large to hold answers.", code)
    if "value" in told:
        message = f"{variable} is not a dictionary, so no answer can be found under a scenario's id."
        raise Failed(Evidence("", _SHAPE, told["value"][:80]), message, code)
    if "entries" in told:
        return quiz.read_answers(told["entries"])
    others = [name for name in told.get("set_names", ()) if name != variable]
    names, meant = ", ".join(others) or "nothing", quiz.nearest(variable, others)
    near = f" Did you mean {meant}?" if meant else ""
    message = f"Your program does not set a variable called {variable}; it sets {names}.{near}"
    raise Failed(Evidence("", _SHAPE, f"the names {names}"), message, "quiz.missing")


def _run(context: CheckContext) -> Record:
    """Have the program work its answers out, and find out why if it does not come to its end."""
    process = context.program.run_to_end(context.time_is_up)
    told = process.notes
    if "set_names" in told and not (told.get("ended_itself") and told.keys().isdisjoint(_FOUND)):
        return told
    code, message = causes.explain_start(process, context.job)
    raise Failed(Evidence("", _SHAPE, "a program that did not run to its end"), message, code)
