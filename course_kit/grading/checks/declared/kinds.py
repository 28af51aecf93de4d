"""The kinds of declared checks: which keys each takes, and of what form their values are."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

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

COMMON = {
    "id": TEXT,
    "kind": TEXT,
    "title": TEXT,
    "points": NUMBER,
    "depends_on": TEXTS,
    "proves": TEXTS,
    "deadline_s": NUMBER,
}
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
        optional: those of them without which it can do.
        keys: its other keys.
        sends: the part of the interface that its inputs are of; also the name of an input in expressions.
        receives: the part that `expect` is about.
        deadline_s: seconds for all its waiting, unless the check says otherwise.
        node: whether it needs the node's name.
    """

    about: str
    keys: Mapping[str, Key]
    endpoints: tuple[str, ...] = ()
    optional: tuple[str, ...] = ()
    sends: str = ""
    receives: str = ""
    deadline_s: float = 6.0
    node: bool = False
    names: tuple[str, ...] = field(default=())

    @property
    def inputs(self) -> str:
        """The key of its inputs: `requests` of one that sends a request."""
        return f"{self.sends}s"


def _exchange(sends: str, receives: str, **more: Key) -> dict[str, Key]:
    """The keys of a kind that sends something and looks at what comes back."""
    return {
        f"{sends}s": Key(INPUTS, sends),
        "cases": Key(CASES, sends),
        "expect": Key(EXPECT, receives),
        "tolerance": Key(TOLERANCE),
        **more,
    }


KINDS: dict[str, Kind] = {
    "offered": Kind(
        "endpoints are there, each with its type",
        {"endpoints": Key(TEXTS), "request": Key(FIELDS, "request")},
        deadline_s=12.0,
    ),
    "node_name": Kind("the node has its name", {"node": Key(TEXT, required=True)}),
    "answers": Kind(
        "a service answers these requests in this way",
        _exchange("request", "response", within_s=Key(NUMBER), clients=Key(COUNT)),
        endpoints=("service",),
        sends="request",
        receives="response",
        deadline_s=10.0,
        names=("request",),
    ),
    "refuses": Kind(
        "a service refuses these requests, gives a reason, and lives on",
        {
            "requests": Key(INPUTS, "request", required=True),
            "refused": Key(FIELDS, "response"),
            "reason": Key(TEXT, "response"),
            "valid": Key(FIELDS, "request"),
        },
        endpoints=("service",),
        sends="request",
        deadline_s=10.0,
    ),
    "topic_answers": Kind(
        "each message on one topic is answered by one on another",
        _exchange("message", "message", exactly_one=Key(TRUTH)),
        endpoints=("subscription", "publisher"),
        sends="message",
        receives="message",
        deadline_s=10.0,
        names=("message", "parameters"),
    ),
}
