"""Reads the `[[checks]]` of an exercise.toml: every mistake is found at once, each with its line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from course_kit.grading.checks.declared import kinds, rules, values
from course_kit.grading.checks.declared.declaration import Declaration
from course_kit.grading.checks.declared.definitions import Fields
from course_kit.grading.checks.declared.endpoints import AN_ENDPOINT, ENDPOINTS, choice, endpoints_of, part_of
from course_kit.ros.names import did_you_mean, from_root

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from course_kit.grading.checks.declared.declaration import WantedEndpoint
    from course_kit.grading.checks.declared.kinds import Kind
    from course_kit.grading.checks.declared.lines import Lines
    from course_kit.grading.checks.declared.mistakes import MistakeList
    from course_kit.grading.plain_data import Record
    from course_kit.interfaces.field_types import FieldType

CHECKS = "checks"


def read(table: Record, lines: Lines, mistakes: MistakeList) -> tuple[Declaration, ...]:
    """The declared checks of an exercise, in their order; those with mistakes are left out.

    Args:
        table: the whole exercise.toml.
        lines: where its parts stand.
        mistakes: gets what is wrong.
    """
    reading = _Reading(table, lines, mistakes)
    numbers = [number for number, one in enumerate(tables_of(table, CHECKS)) if one.get("kind") != kinds.PYTHON]
    return tuple(one for number in numbers if (one := reading.check(number)) is not None)


def order_of(table: Record) -> tuple[str, ...]:
    """The ids of an exercise's `[[checks]]` in their order, those that mark the place of a check in Python included."""
    return tuple(str(one.get("id", "")) for one in tables_of(table, CHECKS))


def tables_of(table: Record, name: str) -> list[Record]:
    """The tables of an array of tables; none where it is something else, which is told elsewhere."""
    found = table.get(name, [])
    return [one if isinstance(one, dict) else {} for one in found] if isinstance(found, list) else []


class _Reading:
    """One exercise that is being read."""

    def __init__(self, table: Record, lines: Lines, mistakes: MistakeList) -> None:
        self._checks = tables_of(table, CHECKS)
        self._lines, self._mistakes = lines, mistakes
        self._endpoints = endpoints_of(tables_of(table, ENDPOINTS), lines, mistakes)
        self.types = rules.types_of(self._checks)
        named = [one.get("node") for one in self._checks if one.get("kind") == "node_name"]
        self._node = next((name for name in named if isinstance(name, str)), "")

    def check(self, number: int) -> Declaration | None:
        """The check of this number; None when it has a mistake."""
        return _OneCheck(self, number).read()

    @property
    def lines(self) -> Lines:
        """Where things stand."""
        return self._lines

    @property
    def mistakes(self) -> MistakeList:
        """What is wrong."""
        return self._mistakes

    @property
    def endpoints(self) -> list[WantedEndpoint]:
        """Those without mistakes."""
        return self._endpoints

    @property
    def node(self) -> str:
        """The node's name as a check of it says; empty when none does."""
        return self._node

    def table(self, number: int) -> Record:
        """A check as it is written."""
        return self._checks[number]

    def parameters(self) -> Fields | None:
        """The parameters that checks declare, as fields whose values may be anything; None when none does."""
        known = dict.fromkeys(self.types, cast("FieldType", None))  # which nobody looks at
        return _Parameters("the node's parameters", known) if known else None


class _Parameters(Fields):
    """Parameters, as expressions look them up."""

    def inside(self, name: str) -> Fields | None:
        """A parameter holds no fields."""
        del name
        return None


def _may_need_node(kind: Kind) -> bool:
    return kind.node or "node" in kind.keys or "parameters" in kind.names


class _OneCheck:
    """One check that is being read."""

    def __init__(self, around: _Reading, number: int) -> None:
        self._around, self._number, self._table = around, number, around.table(number)
        self._sound = True

    def read(self) -> Declaration | None:
        """The check, None with mistakes."""
        kind = self._kind()
        if kind is None:
            return None
        self._look_over_keys(kind)
        endpoints, node = self._endpoints(kind), self._node(kind)
        if not self._sound:
            return None
        self._look_over_values(kind, endpoints, node)
        for problem, key in rules.problems(self._table, self._around.types):
            self._tell(problem, key)
        table = self._table
        own = {key: value for key, value in table.items() if key in kind.keys and key != "node"}
        texts = {key: tuple(table.get(key, [])) for key in ("depends_on", "proves")}
        declaration = Declaration(
            id=table["id"],
            kind=table["kind"],
            title=table["title"].rstrip(". "),
            points=float(table["points"]),
            deadline_s=float(table.get("deadline_s", kind.deadline_s)),
            endpoints=endpoints,
            node=node,
            keys=own,
            **texts,
        )
        return declaration if self._sound else None

    def _tell(self, text: str, key: str = "", *words: str) -> None:
        self._sound = False
        name = self._table.get("id")
        before = f"The check '{name}': " if isinstance(name, str) and name else ""
        self._around.mistakes.add(self._around.lines.within(CHECKS, self._number, key, *words), before + text)

    def _kind(self) -> Kind | None:
        name = self._table.get("kind")
        if not isinstance(name, str):
            self._tell(f"'kind' is missing. There are {', '.join((*kinds.KINDS, kinds.PYTHON))}.")
            return None
        if name not in kinds.KINDS:
            self._tell(f"There is no kind '{name}'.{choice(name, kinds.KINDS)}", "kind")
            return None
        return kinds.kind_of(self._table)

    def _look_over_keys(self, kind: Kind) -> None:
        forms = {**kinds.COMMON, **{key: one.form for key, one in kind.keys.items()}}
        forms |= dict.fromkeys((*kind.endpoints, *(["node"] if _may_need_node(kind) else [])), kinds.TEXT)
        required = [*kinds.REQUIRED, *(key for key, one in kind.keys.items() if one.required and key != "expect")]
        for key in required:
            if key not in self._table:
                self._tell(f"'{key}' is missing.")
        for key, value in self._table.items():
            if key not in forms:
                told = did_you_mean(key, forms) or f" It has {', '.join(forms)}."
                self._tell(f"The kind '{self._table['kind']}' has no key '{key}'.{told}", key)
            elif problem := values.problem_of_form(forms[key], value):
                self._tell(f"'{key}' has to be {problem}, not {value!r}.", key)
        if kind.inputs in kind.keys and kind.receives:
            self._look_over_cases(kind)

    def _look_over_cases(self, kind: Kind) -> None:
        given, cases = kind.inputs in self._table, "cases" in self._table
        if given == cases and "cases" in kind.keys:
            self._tell(f"It needs either '{kind.inputs}' with one 'expect' for all, or 'cases' with one each.")
        if cases and "expect" in self._table:
            self._tell("With 'cases' each case has its own 'expect'.", "expect")
        if given and kind.keys["expect"].required and "expect" not in self._table:
            self._tell("'expect' is missing: what is to come back.")
        for case in self._table.get("cases", []):
            if isinstance(case, dict) and set(case) != {kind.sends, "expect"}:
                self._tell(f"A case is {{{kind.sends} = {{...}}, expect = {{...}}}}.", "cases")
            elif isinstance(case, dict) and not isinstance(case[kind.sends], dict):
                self._tell(f"'{kind.sends}' of a case is a table of fields.", "cases", kind.sends)

    def _endpoints(self, kind: Kind) -> dict[str, WantedEndpoint]:
        if "endpoints" in kind.keys:
            return self._all_endpoints()
        found = {key: self._endpoint(key) for key in kind.endpoints}
        return {key: one for key, one in found.items() if one is not None}

    def _all_endpoints(self) -> dict[str, WantedEndpoint]:
        known = {one.name: one for one in self._around.endpoints}
        wanted = self._table.get("endpoints")
        if not known:
            self._tell(f"The exercise has no [[endpoints]]. {AN_ENDPOINT}")
        if not isinstance(wanted, list):
            return {f"{one.kind} {one.name}": one for one in self._around.endpoints}
        found = {}
        for name in map(from_root, map(str, wanted)):
            if name in known:
                found.update({f"{one.kind} {one.name}": one for one in self._around.endpoints if one.name == name})
            else:
                self._tell(f"No endpoint is called '{name}'.{choice(name, known)}", "endpoints", name)
        return found

    def _endpoint(self, key: str) -> WantedEndpoint | None:
        known = {one.name: one for one in self._around.endpoints if one.kind == key}
        name = self._table.get(key)
        if isinstance(name, str):
            if from_root(name) not in known:
                told = choice(from_root(name), known) if known else f" The exercise's [[endpoints]] have no {key}."
                self._tell(f"No {key} is called '{name}'.{told}", key)
                return None
            return known[from_root(name)]
        if len(known) != 1:
            which = f"one of {', '.join(known)}" if known else f"but the exercise's [[endpoints]] have no {key}"
            self._tell(f"'{key}' is missing: {which}.")
            return None
        return next(iter(known.values()))

    def _node(self, kind: Kind) -> str:
        if not _may_need_node(kind):
            return ""
        name = self._table.get("node", self._around.node)
        if not name and not kind.node:
            return ""
        if not isinstance(name, str) or not name:
            self._tell("'node' is missing: the name of the node, here or in a check of the kind 'node_name'.")
            return ""
        return from_root(name)

    def _look_over_values(self, kind: Kind, endpoints: Mapping[str, WantedEndpoint], node: str) -> None:
        names = self._names(kind, endpoints, node)
        for key, spec in kind.keys.items():
            if key not in self._table:
                continue
            value, fields = self._table[key], part_of(spec.part, key, endpoints)

            def tell(text: str, *words: str, of: str = key) -> None:
                self._tell(text, of, *words)

            if spec.form in (kinds.EXPECT, kinds.WORDS):
                values.look_over_expected(value, fields, names, tell)
            elif spec.form == kinds.CASES:
                self._look_over_each(kind, endpoints, names, tell)
            elif fields is not None:
                _look_over_plain(spec.form, value, fields, tell)

    def _look_over_each(
        self,
        kind: Kind,
        endpoints: Mapping[str, WantedEndpoint],
        names: Mapping[str, Fields | None],
        tell: Callable[..., None],
    ) -> None:
        sent, received = part_of(kind.sends, kind.inputs, endpoints), part_of(kind.receives, "expect", endpoints)
        for case in self._table["cases"]:
            if sent is not None:
                values.look_over_fields(case[kind.sends], sent, tell)
            values.look_over_expected(case["expect"], received, names, tell)

    def _names(self, kind: Kind, endpoints: Mapping[str, WantedEndpoint], node: str) -> dict[str, Fields | None]:
        """The names of expressions in this check."""
        found: dict[str, Fields | None] = {name: part_of(name, kind.inputs, endpoints) for name in kind.names}
        if "parameters" in found and node:
            found["parameters"] = self._around.parameters()
        elif "parameters" in found:
            del found["parameters"]  # of whom is not known
        if kind.oracle:
            found[kinds.ORACLE] = part_of(kind.receives, "expect", endpoints)
        return found


def _look_over_plain(form: str, value: Any, fields: Fields, tell: Callable[..., None]) -> None:
    """Look over fields with their values, or names of fields."""
    for one in values.as_list(value):
        if form in (kinds.INPUTS, kinds.FIELDS):
            values.look_over_fields(one, fields, tell)
        elif problem := fields.problem_of_path(tuple(str(one).split("."))):
            tell(problem, one)
