"""The kinds of declared checks: which keys each takes, and of what form their values are."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

# Forms of values.
TEXT, TEXTS, NUMBER, COUNT, TRUTH = "text", "texts", "number", "count", "truth"
INPUTS = "inputs"  # tables of fields, or one
CASES = "cases"  # tables, each with an input and what is expected for it
FIELDS = "fields"  # a table of fields
EXPECT = "expect"  # a table of fields whose texts are expressions, or one expression for all of them
TOLERANCE = "tolerance"
SETTINGS = "settings"  # tables of values by the names of parameters, or one
VALUE = "value"  # of a parameter
VALUES = "values"  # a table of values by the names of parameters
TYPES = "types"  # a table of types by the names of parameters
WORDS = "words"  # an expression that gives a text

COMMON = {
    "id": TEXT,
    "kind": TEXT,
    "title": TEXT,
    "points": NUMBER,
    "depends_on": TEXTS,
    "proves": TEXTS,
    "deadline_s": NUMBER,
}
PYTHON = "python"  # marks the place of a check that the grader has in Python
REQUIRED = ("id", "kind", "title", "points")
ORACLE = "oracle"  # the name, in expressions, of what the exercise's solution answers


@dataclass(frozen=True)
class Key:
    """A key of a kind.

    Attributes:
        form: of its value.
        part: of what is described: the part of the interface that its fields are of, such as "request".
        required: whether it has to be there.
    """

    form: str
    part: str = ""
    required: bool = False


@dataclass(frozen=True)
class Kind:
    """A kind of check.

    Attributes:
        about: what it looks at, in a few words.
        endpoints: the keys that name an endpoint, each one of the exercise's `[[endpoints]]` of that kind.
        keys: its other keys.
        sends: the part of the interface that its inputs are of; also the name of an input in expressions.
        receives: the part that `expect` is about.
        deadline_s: seconds for all its waiting, unless the check says otherwise.
        node: whether it needs the node's name.
        names: what expressions may use beside the solution's answer.
        oracle: whether the exercise's solution can be asked what it answers.
    """

    about: str
    keys: Mapping[str, Key]
    endpoints: tuple[str, ...] = ()
    sends: str = ""
    receives: str = ""
    deadline_s: float = 6.0
    node: bool = False
    names: tuple[str, ...] = field(default=())
    oracle: bool = False

    @property
    def inputs(self) -> str:
        """The key of its inputs: `requests` of one that sends a request."""
        return f"{self.sends}s"


def _exchange(sends: str, receives: str, **more: Key) -> dict[str, Key]:
    """The keys of a kind that sends something and looks at what comes back."""
    return {
        f"{sends}s": Key(INPUTS, sends),
        "cases": Key(CASES, sends),
        "expect": Key(EXPECT, receives, required=True),
        "tolerance": Key(TOLERANCE),
        **more,
    }


_ACTS = {
    "set": Key(SETTINGS, required=True),
    "at_start": Key(TRUTH),
    "expect": Key(EXPECT, "message", required=True),
    "tolerance": Key(TOLERANCE),
}
_SERVICE = Kind("", {}, ("service",), "request", deadline_s=10.0, names=("request",))
_ACTION = Kind("", {}, ("action",), "goal", deadline_s=30.0, names=("goal",))
KINDS: dict[str, Kind] = {
    "offered": Kind(
        "endpoints are there, each with its type",
        {"endpoints": Key(TEXTS), "request": Key(FIELDS, "request")},
        deadline_s=12.0,
    ),
    "node_name": Kind("the node has its name", {"node": Key(TEXT, required=True)}),
    "answers": replace(
        _SERVICE,
        about="a service answers these requests in this way",
        keys=_exchange("request", "response", within_s=Key(NUMBER), not_before_s=Key(NUMBER), clients=Key(COUNT)),
        receives="response",
        oracle=True,
    ),
    "refuses": replace(
        _SERVICE,
        about="a service refuses these requests, gives a reason, and lives on",
        keys={
            "requests": Key(INPUTS, "request", required=True),
            "refused": Key(FIELDS, "response"),
            "reason": Key(TEXT, "response"),
            "valid": Key(FIELDS, "request"),
            "what": Key(WORDS),
        },
    ),
    "topic_answers": Kind(
        "each message on one topic is answered by one on another",
        _exchange("message", "message", exactly_one=Key(TRUTH)),
        ("subscription", "publisher"),
        sends="message",
        receives="message",
        deadline_s=10.0,
        names=("message", "parameters"),
        oracle=True,
    ),
    "parameter_declared": Kind(
        "the node has declared parameters, with these types and defaults",
        {
            "parameter": Key(TEXT),
            "type": Key(TEXT),
            "default": Key(VALUE),
            "parameters": Key(TEXTS),
            "types": Key(TYPES),
            "defaults": Key(VALUES),
        },
        node=True,
    ),
    "parameter_acts": Kind(
        "a parameter that is set changes what the node publishes",
        _ACTS,
        ("publisher",),
        receives="message",
        deadline_s=12.0,
        node=True,
        names=("parameters",),
        oracle=True,
    ),
    "parameter_refuses": Kind(
        "these values of parameters are refused, and the old ones stay",
        {"set": Key(SETTINGS, required=True), "reason": Key(TEXTS), "together": Key(TRUTH)},
        deadline_s=10.0,
        node=True,
    ),
    "goal_succeeds": replace(
        _ACTION,
        about="goals are accepted and end SUCCEEDED",
        keys={
            **_exchange("goal", "result", within_s=Key(NUMBER), not_before_s=Key(NUMBER)),
            "expect": Key(EXPECT, "result"),
        },
        receives="result",
        oracle=True,
    ),
    "goal_feedback": replace(
        _ACTION,
        about="feedback comes while a goal runs",
        keys={
            "goals": Key(INPUTS, "goal", required=True),
            "at_least": Key(COUNT),
            "spread": Key(TRUTH),
            "rising": Key(TEXTS, "feedback"),
            "falling": Key(TEXTS, "feedback"),
            "first": Key(EXPECT, "feedback"),
            "each": Key(EXPECT, "feedback"),
            "last": Key(EXPECT, "feedback"),
            "tolerance": Key(TOLERANCE),
            "within_s": Key(NUMBER),
        },
        names=("goal", "feedback"),
    ),
    "goal_refused": replace(
        _ACTION,
        about="goals are rejected",
        keys={
            "goals": Key(INPUTS, "goal", required=True),
            "while_running": Key(FIELDS, "goal"),
            "within_s": Key(NUMBER),
            "what": Key(WORDS),
        },
    ),
    "goal_cancelled": replace(
        _ACTION,
        about="a goal that runs can be cancelled",
        keys={
            "goals": Key(INPUTS, "goal", required=True),
            "after_s": Key(NUMBER),
            "within_s": Key(NUMBER),
            "expect": Key(EXPECT, "result"),
            "tolerance": Key(TOLERANCE),
            "then": Key(FIELDS, "goal"),
        },
        receives="result",
    ),
}
# What a parameter acts on, when that is an answer: by the key of what is sent.
_ANSWERS = {
    "requests": replace(
        KINDS["parameter_acts"],
        keys={**_ACTS, "requests": Key(INPUTS, "request"), "expect": Key(EXPECT, "response", required=True)},
        endpoints=("service",),
        sends="request",
        receives="response",
        names=("request", "parameters"),
    ),
    "messages": replace(
        KINDS["parameter_acts"],
        keys={**_ACTS, "messages": Key(INPUTS, "message")},
        endpoints=("subscription", "publisher"),
        sends="message",
        names=("message", "parameters"),
    ),
}


def kind_of(table: Mapping[str, Any]) -> Kind:
    """The kind of a check, which for `parameter_acts` depends on what is sent.

    Args:
        table: the check, with a `kind` that there is.
    """
    if table["kind"] != "parameter_acts":
        return KINDS[table["kind"]]
    return next((kind for key, kind in _ANSWERS.items() if key in table), KINDS["parameter_acts"])
