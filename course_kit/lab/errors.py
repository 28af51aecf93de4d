"""The lab's errors: each says what happened, why, and what to do now.

In a notebook they show as their message alone; a traceback through our code would hide the one line that matters.
"""

from __future__ import annotations


class CallbackStopped(BaseException):
    """Raised inside a callback that runs on although its node was stopped; no `except Exception` may keep it."""


def error_text(error: BaseException) -> str:
    """What an error says of itself. A class of the learner's may fail even at that, which must not hide the error."""
    try:
        return str(error)
    except CallbackStopped:
        raise
    except BaseException as failed:  # noqa: BLE001 - see above
        return f"(its __str__ raised {type(failed).__name__})"


class LabError(RuntimeError):
    """Something the lab was asked for cannot be done; the message says why and what to do."""

    def _render_traceback_(self) -> list[str]:
        return [f"{type(self).__name__}: {self}"]


class ServiceNotFoundError(LabError):
    """No server offers a service of this name and type."""


class ActionNotFoundError(LabError):
    """No server runs an action of this name and type."""


class NodeNotFoundError(LabError):
    """No node of this name has parameters."""


class ParameterNotFoundError(LabError):
    """The node has not declared a parameter of this name."""


class FieldError(LabError):
    """A message field was given by a wrong name or with a value of the wrong type."""


class NoAnswerError(LabError, TimeoutError):
    """Nothing came back within the time given."""


class ServiceFailedError(LabError):
    """The service's callback raised, or returned something that is not a response."""


class DeadlockError(LabError):
    """A callback was about to wait for something only the thread it runs on could do."""


class CallbackError(LabError, TypeError):
    """Something that cannot be called was given as a callback."""


class InputError(LabError):
    """A callback has asked for input, which would stop every node until somebody types."""


class ScriptError(LabError):
    """A script could not be started, or is not there to be stopped."""
