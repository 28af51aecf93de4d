"""What went wrong in a callback that no client waits for: of a topic or a timer, or the one that checks parameters.

An exception in one of these ends a spinning rclpy program just as in a service callback, but what it means for the
others on the graph is different, and so is what the learner is told.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.diagnosis import exits
from course_kit.grading.diagnosis.tracebacks import TracebackException, last_exception

if TYPE_CHECKING:
    from course_kit.grading.model.job import Job
    from course_kit.grading.model.process_status import ProcessStatus

# Where rclpy (Node in node.py) calls the callbacks of add_on_set_parameters_callback, on declaration as well.
_JUDGES = "_set_parameters_atomically_common"
# What rclpy says for a callback that returns something else than a SetParametersResult.
INVALID_RESULT = "Callback returned an invalid type"


def explain_end(process: ProcessStatus, job: Job) -> exits.Cause:
    """Why a submission ended that was up."""
    if cause := exits.explain_limit(process, job):
        return cause
    if process.notes.get("exit_in_callback"):
        return None, "One of your callbacks ended the whole program (SystemExit)."
    return explain_logged(process.stderr, job) or exits.explain_exit(process)


def explain_start(process: ProcessStatus, job: Job) -> exits.Cause:
    """Why a submission ended before it was up, mistakes with its parameters told apart."""
    if exits.explain_limit(process, job) is None:
        if INVALID_RESULT in process.stderr:  # rclpy warns of it, whoever catches the exception that follows
            message = (
                "Your set-parameters callback also runs on each declaration, and it did not return a "
                "SetParametersResult."
            )
            return "parameter.bad_callback", message
        raised = last_exception(process.stderr, job.programs)
        if raised is not None and (cause := _explain_parameters(raised, job)):
            return cause
    return exits.explain_start(process, job)


def explain_logged(stderr: str, job: Job) -> exits.Cause | None:
    """What the last exception in a program's output means, None without one."""
    raised = last_exception(stderr, job.programs)
    if raised is None:
        return None
    cause = exits.explain_respin(raised, job) or _explain_parameters(raised, job) or exits.explain_field(raised, job)
    where = exits.name_line(job, raised.own)
    return cause or (None, f"Your program raised {raised.describe()}{where}, and nothing caught it.")


def _explain_parameters(raised: TracebackException, job: Job) -> exits.Cause | None:
    where = exits.name_line(job, raised.own)
    if raised.type == "ParameterNotDeclaredException":
        return "parameter.undeclared", f"{raised.text}{where}."
    functions = [frame.function for frame in raised.frames]
    judging = _JUDGES in functions and any(
        frame.file in job.programs for frame in raised.frames[functions.index(_JUDGES) + 1 :]
    )
    if judging:
        message = (
            f"Your set-parameters callback raised {raised.describe()}{where}: the caller who set the "
            "value gets no answer."
        )
        return "parameter.bad_callback", message
    if raised.type == "InvalidParameterTypeException":
        return "parameter.type", f"{raised.text}{where}."
    return None
