"""What has to hold of an exercise's submissions and their reports, and what is said where it does not.

A sentence of the task is proven by a submission that does not keep it (its `breaks` names the sentence) and for which
one of the sentence's checks fails; one that grants a freedom by a right program that makes use of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading import exit_code
from course_kit.grading.model import catalogue, exercise_folders
from course_kit.grading.workers import exercise_job
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.grading import Report
    from course_kit.grading.checks.check import Check
    from course_kit.grading.model.exercise import Exercise

    Reports = Mapping[ProofSubmission, Report]


@dataclass(frozen=True)
class Fault:
    """Something that does not hold."""

    exercise: str  # where; empty for what concerns all exercises together
    rule: str  # the name of the rule that is broken, a key of `RULES`, or `codes`
    submission: str  # kind and name of the submission, if it is about one
    text: str  # what is the matter

    def __str__(self) -> str:
        where = " ".join(part for part in (self.exercise, self.submission) if part)
        return f"{where}: {self.text}" if where else self.text


def judge_starter(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """The starter and its notebook run, do not pass, and are helped on by the first rung of the exercise's ladder."""
    if not sets.of_kind("starter"):
        yield "there is no starter."
    rungs = {hint.text for hint in sets.exercise.hints}
    seen = set()
    for proof in sets.of_kind("starter"):
        report = reports[proof]
        failed = [check for check in report.checks if check.status == "failed"]
        seen.add(tuple((check.id, check.status, check.diagnosis) for check in report.checks))
        if exit_code(report) != 1 or not failed:
            yield proof, f"it should be graded and not passed, and is: {describe_report(report)}"
        elif failed[0].hint not in rungs:
            yield proof, f"its first failed check, {failed[0].id}, has no hint from the ladder in exercise.toml."
    if len(seen) > 1:
        yield "the starter program and the starter notebook get different verdicts."


def judge_solution(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """There is a solution, and it gets full marks."""
    if not sets.of_kind("solution"):
        yield "there is no solution."
    yield from _not_full_marks(sets.of_kind("solution"), reports)


def judge_variants(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """Right programs in other styles get full marks."""
    yield from _not_full_marks(sets.of_kind("variant"), reports)


def judge_broken(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """Each broken program gets the diagnosis it is named after and no other, with evidence and a hint.

    Beside an exercise of another folder it may have any name, and then loses points.
    """
    in_own_folder = (sets.exercise.folder / exercise_folders.PROOF).is_dir()
    for proof in sets.of_kind("broken"):
        report = reports[proof]
        got = {check.diagnosis for check in report.checks if check.status == "failed"}
        is_code = proof.name in catalogue.catalogue()
        if not is_code and not in_own_folder:
            yield proof, "it is named after a code that diagnoses.toml does not have."
        elif is_code and got != {proof.name}:
            yield proof, f"it should get this code alone, and gets: {describe_report(report)}"
        elif report.score >= report.max_score:
            yield proof, "it gets full marks."
        yield from ((proof, text) for text in _poor_feedback(report))


def judge_slips(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """Each slip fails the checks it is listed with, with those diagnoses, and no other."""
    for proof in sets.of_kind("slip"):
        report = reports[proof]
        failed = [check for check in report.checks if check.status in ("failed", "error")]
        if {(check.id, check.diagnosis) for check in failed} != proof.failed:
            wanted = ", ".join(f"{check} ({code or 'no code'})" for check, code in sorted(proof.failed, key=str))
            yield proof, f"it should fail {wanted}, and gets: {describe_report(report)}"
        elif proof.says not in " ".join(check.message for check in failed):
            yield proof, f"a message should say '{proof.says}', and this is said: {describe_report(report)}"
        yield from ((proof, text) for text in _poor_feedback(report))


def judge_checks(sets: Corpus, reports: Reports) -> Iterator[str | tuple[ProofSubmission, str]]:
    """Each check can fail: some submission turns it red."""
    red = {check.id for proof in sets.submissions for check in reports[proof].checks if check.status == "failed"}
    known = {check.id: None for proof in sets.of_kind("solution") for check in reports[proof].checks}
    yield from (f"no submission makes the check '{check}' fail." for check in known if check not in red)


def judge_sentences(sets: Corpus, reports: Reports) -> Iterator[str]:
    """Each sentence of the task is tested, and each test has a sentence. A task without sentences is exempt."""
    if not sets.exercise.sentences:
        return
    yield from find_sentence_faults(sets.exercise, checks_of(sets.exercise))
    yield from find_unproven(sets, reports)


RULES: Mapping[str, Callable[[Corpus, Reports], Iterator[str | tuple[ProofSubmission, str]]]] = {
    "starter": judge_starter,
    "solution": judge_solution,
    "variants": judge_variants,
    "broken": judge_broken,
    "slips": judge_slips,
    "checks": judge_checks,
    "sentences": judge_sentences,
}


def find_faults(sets: Corpus, reports: Reports) -> list[Fault]:
    """All that does not hold of one exercise."""
    found = []
    for name, rule in RULES.items():
        for fault in rule(sets, reports):
            proof, text = fault if isinstance(fault, tuple) else (None, fault)
            where = _describe_submission(proof, sets.exercise) if proof is not None else ""
            found.append(Fault(sets.exercise.id, name, where, text))
    return found


def _describe_submission(proof: ProofSubmission, exercise: Exercise) -> str:
    """A submission in words: of files that share their name with another the folder, of a slip the file that has it."""
    if not exercise_folders.is_added(exercise.folder):
        return f"{proof.kind} {proof.name}"
    path = proof.told_in or proof.path
    place = path.relative_to(exercise.folder) if path.is_relative_to(exercise.folder) else path
    return f"slip {proof.name} ({place})" if proof.told_in is not None else f"{proof.kind} {place}"


def codes_without_submission(names: set[str]) -> list[Fault]:
    """The codes of the catalogue after which no broken program or slip is named."""
    text = "no broken program and no slip is named after it, so nothing shows that a learner gets it."
    return [Fault("", "codes", "", f"{code}: {text}") for code in catalogue.catalogue() if code not in names]


def describe_report(report: Report) -> str:
    """A report in one line: its score, and each check that is neither passed nor skipped."""
    wrong = [
        f"{check.id} {check.status} ({check.diagnosis or 'no code'}: {check.message[:160]})"
        for check in report.checks
        if check.status not in ("passed", "skipped")
    ]
    points = f"{report.score:g} of {in_points(report.max_score)}, {report.status}"
    return "; ".join([points, *wrong, *([report.problem] if report.problem else [])])


def _not_full_marks(right: tuple[ProofSubmission, ...], reports: Reports) -> Iterator[tuple[ProofSubmission, str]]:
    for proof in right:
        report = reports[proof]
        full = all(check.status == "passed" for check in report.checks) and report.status == "graded"
        if not (full and report.passed and report.score == report.max_score):
            yield proof, f"it should get full marks, and gets: {describe_report(report)}"
        elif sum(check.max_points for check in report.checks) != report.max_score:
            yield proof, f"the points of its checks do not add up to {report.max_score:g}."


def _poor_feedback(report: Report) -> Iterator[str]:
    for check in report.checks:
        if check.status == "error":
            yield f"the grader itself fails in {check.id}: {check.message}"
        if check.status != "failed":
            continue
        for name in ("expected", "got", "hint"):
            if not getattr(check, name):
                yield f"the failed check {check.id} says nothing under '{name}'."


def checks_of(exercise: Exercise, seed: int | None = None) -> Sequence[Check]:
    """The checks of an exercise, as its grader makes them for a seed; for the exercise's own when None."""
    drawn = (exercise.seed or 0) if seed is None else seed
    return exercise_job.checks_of(exercise, drawn)


def find_sentence_faults(exercise: Exercise, checks: Sequence[Check]) -> list[str]:
    """What does not fit between the sentences of a task and the checks of its grader."""
    known = {sentence.id for sentence in exercise.sentences}
    found = [
        f"the check '{check.id}' names the sentence '{name}', which exercise.toml does not have."
        for check in checks
        for name in check.proves
        if name not in known
    ]
    unsaid = [check.id for check in checks if not check.proves]
    found += [f"no sentence of the task says what the check '{name}' tests." for name in unsaid]
    named = {name for check in checks for name in check.proves}
    found += [
        f"no check tests the sentence '{sentence.id}'."
        for sentence in exercise.sentences
        if not sentence.freedom and sentence.id not in named
    ]
    return found


def find_unproven(sets: Corpus, reports: Reports) -> Iterator[str]:
    """The sentences that nothing proves, and what submissions break that no sentence is."""
    known = {sentence.id for sentence in sets.exercise.sentences}
    yield from (
        f"{proof.kind} {proof.name} breaks the sentence '{name}', which exercise.toml does not have."
        for proof in sets.submissions
        for name in proof.breaks
        if name not in known
    )
    checks = {seed: checks_of(sets.exercise, seed) for seed in {proof.seed for proof in sets.submissions} | {None}}
    right = {
        _name(proof)
        for proof in sets.submissions
        if _is_right(proof) and reports[proof].score >= reports[proof].max_score
    }
    for sentence in sets.exercise.sentences:
        own = {seed: [check.id for check in made if sentence.id in check.proves] for seed, made in checks.items()}
        red = any(
            check.status == "failed" and check.id in own[proof.seed]
            for proof in sets.submissions
            if sentence.id in proof.breaks
            for check in reports[proof].checks
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
