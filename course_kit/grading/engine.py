"""The one way to a grade, for the command line, the notebook and class runs alike."""

from __future__ import annotations

import hashlib
import json
import secrets
import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model import catalogue, submission
from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.model.report import CheckReport, CheckResult, Report
from course_kit.grading.reading import Reader, copy_file
from course_kit.grading.sandbox import needs
from course_kit.grading.workers import exercise_job
from course_kit.grading.workers.worker import WarmProcess, Worker, start_workers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.model.job import GradingOutcome, Job
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.model.submission import Submission

_NOT_STARTED = ("start.", "limit.")
_SEED_BITS = 31
# How much is kept of what a submission sends and says: enough for a person to read, whatever comes.
_TEXTS = ("sent", "expected", "got", "message")  # of a check's result
_LONGEST = 3000  # bytes of each of them, as JSON
_TOGETHER = 160_000  # bytes of those of all checks
_MOST_STEPS, _LONGEST_STEP = 12, 400  # of an exchange
_MOST_IN_GRAPH = 100  # nodes, and things that they do
_PER_CHARACTER = 6  # bytes at most, as JSON
_DOTS = "..."


@dataclass(frozen=True)
class GradingRequest:
    """One grading, as it travels to where it is done."""

    exercise: Exercise  # the exercise
    text: Submission  # the submission
    shown: str  # what the report calls it
    seed: int  # what the checks draw their random values from
    # folders the submission must not see, wherever they lie: what others have handed in, and their results
    hidden: tuple[str, ...] = ()
    # stop at the first failed check that costs points; the report has those that were run by then
    first_failure: bool = False
    only: str = ""  # the part whose checks are run; empty for all
    require_isolation: bool = False  # refuse to run it where it would not be fully isolated, wherever the worker is


def grade(  # noqa: PLR0913 - the options of one verb
    exercise_id: str,
    path: str | Path | None = None,
    *,
    seed: int | None = None,
    only: str = "",
    attach: bool = False,
    exec_command: str | None = None,
    worker: Worker | None = None,
    exercises: Path | None = None,
    require_isolation: bool = False,
) -> Report:
    """Grade one submission.

    Safe to call from a Jupyter kernel: everything that forks does so in a separate process.

    Args:
        exercise_id: which exercise.
        path: the submission, a .py or .ipynb file; None with `attach` or `exec_command`.
        seed: what the checks draw their random values from; when None the exercise's own, if it has one, else made of
            the submission's text: the same program is asked the same. Of a running node it is drawn.
        only: run the checks of one part alone, such as "door": those whose ids begin with it, and what they need.
        attach: grade the node that runs on the ROS graph of this environment.
        exec_command: start this command and grade its node.
        worker: a running worker to use; one is started and ended when None.
        exercises: the folder of exercises, the course's own when None.
        require_isolation: refuse to run a submission where it would not be fully isolated.

    Raises:
        GradingError: usage, an unknown exercise or part, a broken installation, or a machine that lacks something,
            such as isolation; the text is for the user.
        DomainError: there is no ROS domain to look for a running node in; as above.
    """
    exercise = load_exercise(exercise_id, exercises)
    if sum((path is not None, attach, exec_command is not None)) != 1:
        raise GradingError("Name one thing to grade: a file, --attach for a running node, or --exec with a command.")
    if exercise.variable and path is None:
        raise GradingError(f"The exercise {exercise.id} is answered in a file, not by a running node. Name the file.")
    needs.require_machine(exercise.limits)
    seed = exercise.seed if seed is None else seed
    if path is not None:
        name = submission.decode_name(str(path))
        try:
            with copy_file(Path(path), several=bool(exercise.files)) as copy, Reader() as reader, ExitStack() as stack:
                number = 1 if only else max(1, min(len(exercise.parts), needs.count_side_by_side(exercise.limits)))
                new = () if worker else start_workers(number, [exercise])  # they get warm while the file is read
                workers = [worker] if worker else [stack.enter_context(each) for each in new]
                text = reader.read(copy, exercise)
                seed = _make_seed(text) if seed is None else seed
                request = GradingRequest(exercise, text, name, seed, only=only, require_isolation=require_isolation)
                return grade_submission(request, *workers)
        except submission.UnreadableError as problem:
            return report_unreadable(exercise, name, submission.decode_name(str(problem)))
    if attach and require_isolation:
        raise GradingError(
            "A node that is already running (--attach) is not isolated. Leave --require-isolation out, or grade a file."
        )
    name = f"the node on ROS domain {environment.apply_settings().domain_id}" if exec_command is None else exec_command
    with Worker(WarmProcess(whole=exec_command is not None, own_graph=not attach)) as used:
        seed = secrets.randbits(_SEED_BITS) if seed is None else seed
        job = replace(exercise_job.make_job_of_node(exercise, seed, exec_command), only=only)
        return _grade(exercise, job, name, (used,), require_isolation)


def _make_seed(text: Submission) -> int:
    """The same for the same program, whoever grades it and wherever."""
    digest = hashlib.sha256(text.source.encode(errors="surrogatepass")).digest()
    return int.from_bytes(digest, "big") % (1 << _SEED_BITS)


def grade_submission(request: GradingRequest, *workers: Worker) -> Report:
    """Grade a submission that has been read; several workers grade the parts of an exercise at the same time."""
    job = exercise_job.make_job_of_node(request.exercise, request.seed)
    job = replace(job, mode="run", text=request.text, hidden=(*job.hidden, *request.hidden))
    job = replace(job, first_failure=request.first_failure, only=request.only)
    missing = [name for name in request.exercise.files if name not in request.text.files]
    note = f"missing: {', '.join(missing)}" if missing else request.text.note
    title = f"{request.shown} ({note})" if note else request.shown
    return _grade(request.exercise, job, title, workers, request.require_isolation)


def report_unreadable(exercise: Exercise, shown: str, problem: str, status: str = "unreadable") -> Report:
    """The report of a submission that could not be graded at all."""
    made = Report(exercise.id, exercise.title, shown, status, max_score=exercise.points)
    return replace(made, practice=exercise.practice, problem=problem)


def _grade(exercise: Exercise, job: Job, shown: str, workers: Sequence[Worker], require_isolation: bool) -> Report:
    began = time.monotonic()
    found = workers[0].ready()
    if require_isolation:
        found.require()
    isolation = found.describe()
    if job.mode == "attach":
        isolation = "none: the node was running already, and the grader only talked to it"
    elif job.mode == "exec":
        isolation += ". The command saw your environment variables and worked in your folder"
    outcome = _grade_parts(exercise, job, workers)
    if job.only and not outcome["results"]:  # a slip of whoever asks
        raise GradingError(outcome["problem"] or "No check was run.")
    report, took = _report(exercise, shown, outcome, job.only), time.monotonic() - began
    return replace(report, duration_s=took, isolation=isolation, seed=job.seed)


def _grade_parts(exercise: Exercise, job: Job, workers: Sequence[Worker]) -> GradingOutcome:
    """Grade each part of an exercise by itself, as many at a time as there are workers; other jobs have one."""
    waiting = list((exercise.parts if job.mode == "run" and not job.only else ()) or (job.only,))
    whole: GradingOutcome = {"results": [], "stdout": "", "stderr": "", "problem": "", "again": False}
    while waiting:
        asked = [(worker, waiting.pop(0)) for worker in workers[: len(waiting)]]
        for worker, part in asked:
            worker.send(replace(job, only=part))
        for worker, _ in asked:
            outcome = worker.receive(job)
            whole["results"] += outcome["results"]
            whole["stdout"] += outcome["stdout"]
            whole["stderr"] += outcome["stderr"]
            whole["problem"] = whole["problem"] or outcome["problem"]
        if job.first_failure and any(one["status"] == "failed" and one["max_points"] for one in whole["results"]):
            return whole
    return whole


def _report(exercise: Exercise, shown: str, outcome: GradingOutcome, part: str) -> Report:
    checks = tuple(_check(exercise, result) for result in bound_results(outcome["results"]))
    problem, broken = cut_text(outcome["problem"]), next((check for check in checks if check.status == "error"), None)
    if problem or not checks:
        problem = f"The grading did not finish: {problem.rstrip('.') or 'no check was run'}."
    elif broken:
        problem = f'The grading did not finish: it stopped at the check "{broken.title}". {broken.message}'
    crashed = checks and checks[0].status == "failed" and (checks[0].diagnosis or "").startswith(_NOT_STARTED)
    status = "error" if problem else "crashed" if crashed else "graded"
    score = 0.0 if problem else sum(check.points for check in checks)
    most, enough = exercise.points, exercise.pass_mark
    if part:  # its checks are full marks, and all of them pass it
        most = enough = sum(check.max_points for check in checks)
    return replace(
        report_unreadable(exercise, shown, problem, status),
        passed=status != "error" and score >= enough,
        score=score,
        max_score=most,
        part=part,
        checks=checks,
        stdout=outcome["stdout"],
        stderr=outcome["stderr"],
    )


def cut_text(text: str, longest: int = _LONGEST) -> str:
    """A text that takes at most so many bytes as JSON, and that UTF-8 can hold; of a longer one the beginning."""
    whole = text[:longest].encode("utf-8", errors="replace").decode("utf-8")
    if len(text) == len(whole) and _size(whole) <= longest:
        return whole
    room = longest - len(_DOTS)
    return (whole[:room] if _size(whole[:room]) <= room else whole[: room // _PER_CHARACTER]) + _DOTS


def _size(text: str) -> int:
    return len(json.dumps(text, ensure_ascii=False).encode()) - 2


def bound_results(found: Sequence[Record]) -> list[Record]:
    """Results of checks as plain data, in which no text is too long, nor all of them together."""
    longest = min(_LONGEST, _TOGETHER // (len(_TEXTS) * max(len(found), 1)))
    bounded = []
    for each in found:
        texts = {name: cut_text(str(each[name]), longest) for name in _TEXTS}
        steps = [{**step, "text": cut_text(str(step["text"]), _LONGEST_STEP)} for step in each["steps"][:_MOST_STEPS]]
        graph = [part[:_MOST_IN_GRAPH] for part in each.get("graph") or ()] or None
        bounded.append({**each, **texts, "steps": steps, "graph": graph})
    return bounded


def _check(exercise: Exercise, record: Record) -> CheckReport:
    result = convert_record(record, CheckResult)
    failed = result.status == "failed"
    found = exercise.diagnosis(result.diagnosis) if failed else None
    hints = exercise.hints_for(result.id, found) if failed else ()
    return CheckReport(
        **{**vars(result), "message": catalogue.complete_message(result.message, found)},
        points=result.max_points if result.status == "passed" else 0.0,
        hint=hints[0] if hints else None,
        told=result.message,
        more_hints=hints[1:],
        known=found,
    )
