"""Whether a grader tests what its exercise says, and the exercise says what it tests.

A sentence is proven by a submission that does not keep it (its `breaks` names the sentence) and for which one of the
sentence's checks fails; one that grants a freedom by a right program that makes use of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.workers import exercise_job

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.grading import Report
    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.exercise import Exercise


def checks_of(exercise: Exercise, seed: int | None = None) -> Sequence[Check]:
    """The checks of an exercise, as its grader makes them for a seed; for the exercise's own when None."""
    drawn = (exercise.seed or 0) if seed is None else seed
    return exercise_job.checks_of(exercise, drawn)


def find_sentence_faults(exercise: Exercise, checks: Sequence[Check]) -> list[str]:
    """What does not fit between the sentences of a task and the checks of its grader."""
    known = {one.id for one in exercise.sentences}
    found = [
        f"the check '{one.id}' names the sentence '{name}', which exercise.toml does not have."
        for one in checks
        for name in one.proves
        if name not in known
    ]
    found += [f"no sentence of the task says what the check '{one.id}' tests." for one in checks if not one.proves]
    named = {name for one in checks for name in one.proves}
    found += [
        f"no check tests the sentence '{one.id}'."
        for one in exercise.sentences
        if not one.freedom and one.id not in named
    ]
    return found


def find_unproven(sets: Corpus, reports: Mapping[ProofSubmission, Report]) -> Iterator[str]:
    """The sentences that nothing proves, and what submissions break that no sentence is."""
    known = {one.id for one in sets.exercise.sentences}
    yield from (
        f"{one.kind} {one.name} breaks the sentence '{name}', which exercise.toml does not have."
        for one in sets.submissions
        for name in one.breaks
        if name not in known
    )
    checks = {seed: checks_of(sets.exercise, seed) for seed in {one.seed for one in sets.submissions} | {None}}
    right = {_name(one) for one in sets.submissions if _is_right(one) and reports[one].score >= reports[one].max_score}
    for sentence in sets.exercise.sentences:
        own = {seed: [one.id for one in made if sentence.id in one.proves] for seed, made in checks.items()}
        red = any(
            check.status == "failed" and check.id in own[one.seed]
            for one in sets.submissions
            if sentence.id in one.breaks
            for check in reports[one].checks
        )
        if sentence.freedom and sentence.freedom not in right:
            yield (
                f"the sentence '{sentence.id}' grants a freedom, and there is no right program '{sentence.freedom}' "
                "with full marks."
            )
        if not sentence.freedom and not red:
            named = ", ".join(own[None])
            yield f"no submission that breaks the sentence '{sentence.id}' fails one of its checks ({named})."


def _is_right(submission: ProofSubmission) -> bool:
    """Whether full marks are expected: of solutions, variants, and right programs with a change that does no harm."""
    return submission.kind in ("solution", "variant") or (submission.kind == "slip" and not submission.failed)


def _name(submission: ProofSubmission) -> str:
    return submission.name if submission.kind == "slip" else submission.path.stem
