"""Who of a class list has handed in what: by identifiers first, then by names, and nobody by a guess."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.classroom.intake import roster as columns
from course_kit.classroom.intake.roster import plain_text
from course_kit.classroom.records import Entry

if TYPE_CHECKING:
    from collections.abc import Container, Mapping, Sequence

    from course_kit.classroom.intake.roster import Person, Roster

_BY_PLATFORM = {  # which column holds what a layout tells
    "canvas_user": (columns.CANVAS,),
    "sid": (columns.NUMBER, columns.LOGIN),
    "email": (columns.EMAIL,),
    "login": (columns.GITHUB, columns.LOGIN),
}
_OF_STUDENT = (columns.LOGIN, columns.EMAIL, columns.NUMBER, columns.GITHUB)


@dataclass(frozen=True)
class RosterFit:
    """How a class list fits what was handed in."""

    roster: Roster  # the list
    matched: int  # how many students were found on it
    absent: tuple[Entry, ...]  # everybody on it who has handed in nothing, in entries without exercise and source
    unknown: tuple[tuple[str, str], ...]  # student and reason of those who were not found on it


class Matcher:
    """Finds people on a class list."""

    def __init__(self, roster: Roster) -> None:
        self._by_value: dict[tuple[str, str], list[Person]] = defaultdict(list)
        self._by_name: dict[str, list[Person]] = defaultdict(list)
        self._groups: dict[str, list[Person]] = defaultdict(list)
        for person in roster.people:
            for kind, value in person.values.items():
                self._by_value[kind, value.casefold()].append(person)
            for key in _names(person):
                self._by_name[key].append(person)
            for group in person.values.get(columns.GROUP, "").replace(";", ",").split(","):
                if plain_text(group):
                    self._groups[_join(group)].append(person)

    def person(self, entry: Entry) -> tuple[Person | None, str]:
        """Who an entry is from; nobody, and why, where that is not sure."""
        found = self._by_identifiers(entry)
        if not found and entry.platform.get("moodle_participant"):
            found = self._by_participant(entry)
        if not found:
            found = self._by_name.get(_sort_parts(entry.name or entry.student), []) or self._by_name.get(
                _join(entry.name or entry.student), []
            )
        if len(found) == 1:
            return found[0], ""
        return None, "several on the list have this name" if found else "not on the list"

    def members(self, entry: Entry) -> Sequence[Person]:
        """Who is in the group that an entry is from; nobody where the list has no group of this name."""
        return self._groups.get(_join(entry.name or entry.student), ())

    def _by_identifiers(self, entry: Entry) -> list[Person]:
        keys = [(kind, entry.platform.get(key, "")) for key, kinds in _BY_PLATFORM.items() for kind in kinds]
        if not entry.platform.get("moodle_participant"):  # whose number is no identifier outside of its assignment
            keys += [(kind, entry.student) for kind in _OF_STUDENT]
        return next((found for kind, value in keys if value and (found := self._people_with(kind, value))), [])

    def _by_participant(self, entry: Entry) -> list[Person]:
        """By Moodle's number, which is one of this assignment only if the name is right, too."""
        found = self._people_with(columns.MOODLE, entry.platform["moodle_participant"])
        names = {key for person in found for key in _names(person)}
        return found if not names or _sort_parts(entry.name) in names else []

    def _people_with(self, kind: str, value: str) -> list[Person]:
        return self._by_value.get((kind, value.casefold()), [])


def match_roster(
    roster: Roster, entries: Sequence[Entry], layout: str, empty: Container[str] = (), *, assignments: int = 1
) -> tuple[tuple[Entry, ...], RosterFit]:
    """Give entries the names and identifiers of a class list; the entry of a group becomes one of each member."""
    matcher = Matcher(roster)
    found: list[Entry] = []
    people: dict[int, set[str]] = defaultdict(set)
    unknown: dict[str, str] = {}
    nothing: dict[int, Entry] = {}
    for entry in entries:
        person, why = matcher.person(entry)
        if person and entry.student in empty:
            nothing[id(person)] = _add_name(entry, person)
            continue
        members = () if person else matcher.members(entry)
        if person:
            found.append(_add_name(entry, person))
            people[id(person)].add(entry.student)
        elif members:
            for member in members:
                found.append(_of_member(entry, member, layout))
                people[id(member)].add(entry.student)
        else:
            found.append(entry)
            unknown[entry.student] = why
    unknown.update(_find_double_students(roster, people))
    absent = tuple(
        nothing.get(id(person)) or _entry_without_submission(person, layout, numbered=assignments == 1)
        for person in roster.people
        if id(person) not in people
    )
    return tuple(found), RosterFit(roster, sum(map(bool, people.values())), absent, tuple(sorted(unknown.items())))


def _find_double_students(roster: Roster, people: Mapping[int, set[str]]) -> dict[str, str]:
    """Students who are the same person by the list, and two by what was handed in."""
    names = {id(person): person.name for person in roster.people}
    return {
        student: f"{names[person]} is on the list once, and {' and '.join(sorted(students))} both fit"
        for person, students in people.items()
        if len(students) > 1
        for student in students
    }


def _add_name(entry: Entry, person: Person) -> Entry:
    return replace(entry, name=person.name or entry.name, platform={**person.platform, **entry.platform})


def _entry_without_submission(person: Person, layout: str, *, numbered: bool) -> Entry:
    number = _participant(person) if numbered and layout == "moodle" else {}
    return Entry(person.student(layout), "", "", person.name, platform={**person.platform, **number})


def _participant(person: Person) -> dict[str, str]:
    number = person.values.get(columns.MOODLE, "")
    return {"moodle_participant": number} if number else {}


def _of_member(entry: Entry, person: Person, layout: str) -> Entry:
    of_group = {key: value for key, value in entry.platform.items() if key != "moodle_participant"}
    platform = {**of_group, **_participant(person), **person.platform, "group": entry.name or entry.student}
    return replace(entry, student=person.student(layout), name=person.name, platform=platform)


def _names(person: Person) -> set[str]:
    """How platforms write a name: words in any order, or without blanks and the last name first, as Canvas does."""
    first, last = person.values.get(columns.FIRST, ""), person.values.get(columns.LAST, "")
    full = person.values.get(columns.FULL, person.name)
    forms = {_sort_parts(person.name), _join(full), _join(person.name), _join(last + first), _join(first + last)}
    words = plain_text(person.name).split()
    forms.add("".join([*words[-1:], *words[:-1]]))
    return forms - {""}


def _sort_parts(name: str) -> str:
    return " ".join(sorted(plain_text(name).split()))


def _join(name: str) -> str:
    return plain_text(name).replace(" ", "")
