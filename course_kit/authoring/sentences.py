"""Whether a grader tests what its exercise says, and the exercise says what it tests.

A sentence is proven by a submission that does not keep it (its `breaks` names the sentence) and for which one of the
sentence's checks fails; one that grants a freedom by a right program that makes use of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading import exercise_job

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.grading import Report
    from course_kit.grading.checks.check import Check
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.sentences import Sentence


@dataclass(frozen=True)
class ProvenSentence:
    """A sentence of a task and what stands behind it."""

    sentence: Sentence  # the sentence
    checks: tuple[str, ...]  # the ids of the checks that name it
    # the submissions that do not keep it, each with those of its checks that failed
    red: tuple[tuple[ProofSubmission, tuple[str, ...]], ...]
    right: ProofSubmission | None  # the right program that makes use of the freedom it grants, if it got full marks


def checks_of(task: Exercise, seed: int | None = None) -> Sequence[Check]:
    """The checks of an exercise, as its grader makes them for a seed; for the exercise's own when None."""
    drawn = (task.seed or 0) if seed is None else seed
    return exercise_job.checks_of(task, drawn)


def faults(task: Exercise, checks: Sequence[Check]) -> list[str]:
    """What does not fit between the sentences of a task and the checks of its grader."""
    known = {one.id for one in task.sentences}
    found = [
        f"the check '{one.id}' names the sentence '{name}', which exercise.toml does not have."
        for one in checks
        for name in one.proves
        if name not in known
    ]
    found += [f"no sentence of the task says what the check '{one.id}' tests." for one in checks if not one.proves]
    named = {name for one in checks for name in one.proves}
    found += [
        f"no check tests the sentence '{one.id}'." for one in task.sentences if not one.freedom and one.id not in named
    ]
    return found


def proven(sets: Corpus, reports: Mapping[ProofSubmission, Report]) -> list[ProvenSentence]:
    """What a proof run has shown of each sentence."""
    seeds = {submission.seed for submission in sets.submissions} | {None}
    checks = {seed: checks_of(sets.task, seed) for seed in seeds}
    found = []
    for one in sets.task.sentences:
        own = {seed: tuple(check.id for check in made if one.id in check.proves) for seed, made in checks.items()}
        red = [
            (submission, failed)
            for submission in sets.submissions
            if one.id in submission.breaks and (failed := _failed(reports[submission], own[submission.seed]))
        ]
        right = next((each for each in sets.submissions if _is_right(each) and _name(each) == one.freedom), None)
        if right is not None and reports[right].score < reports[right].max_score:
            right = None
        found.append(ProvenSentence(one, own[None], tuple(red), right))
    return found


def unproven(sets: Corpus, reports: Mapping[ProofSubmission, Report]) -> Iterator[str]:
    """The sentences that nothing proves, and what submissions break that no sentence is; arguments as of `proven`."""
    known = {one.id for one in sets.task.sentences}
    yield from (
        f"{one.kind} {one.name} breaks the sentence '{name}', which exercise.toml does not have."
        for one in sets.submissions
        for name in one.breaks
        if name not in known
    )
    for one in proven(sets, reports):
        name, freedom = one.sentence.id, one.sentence.freedom
        if freedom and one.right is None:
            yield f"the sentence '{name}' grants a freedom, and there is no right program '{freedom}' with full marks."
        if not freedom and not one.red:
            yield f"no submission that breaks the sentence '{name}' fails one of its checks ({', '.join(one.checks)})."


def _is_right(submission: ProofSubmission) -> bool:
    """Whether full marks are expected: of solutions, variants, and right programs with a change that does no harm."""
    return submission.kind in ("solution", "variant") or (submission.kind == "slip" and not submission.failed)


def _name(submission: ProofSubmission) -> str:
    return submission.name if submission.kind == "slip" else submission.path.stem


def _failed(report: Report, checks: Sequence[str]) -> tuple[str, ...]:
    return tuple(one.id for one in report.checks if one.id in checks and one.status == "failed")
