"""A class list as a learning platform exports it, or any other: who is in the class, by which names and numbers."""

from __future__ import annotations

import csv
import re
import unicodedata
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

FULL, FIRST, LAST, EMAIL, LOGIN, NUMBER, CANVAS, MOODLE, GITHUB, GROUP = (
    "full name",
    "first name",
    "last name",
    "e-mail address",
    "login",
    "student number",
    "Canvas user number",
    "Moodle participant",
    "GitHub login",
    "group",
)
_LARGEST = 20 * 1024**2  # bytes
_ASSIGNMENT = re.compile(r".+ \(\d+\)")
_DELIMITERS = ",;\t|"
_TEST_STUDENT = "student, test"  # Canvas's own, with which instructors try things
_NO_STUDENT = "points possible"  # the second row of Canvas's gradebook
_IDENTIFIERS = (LOGIN, EMAIL, NUMBER, CANVAS, GITHUB)
_PLATFORM = {  # see `Entry.platform`
    CANVAS: "canvas_user",
    NUMBER: "sid",
    EMAIL: "email",
    LOGIN: "login",
    GITHUB: "github",
}
_WORDS = {  # headers without accents, signs and capitals
    FULL: "student|student name|full name|fullname|display name|vollstandiger name|nom complet|nombre completo|"
    "nome completo|volledige naam|imie i nazwisko|cele jmeno|fullstandigt namn|"
    "fullt navn|koko nimi|氏名|姓名|フルネーム|"
    "полное имя|фио|teljes nev|ad soyad",
    FIRST: "first name|firstname|first names|given name|given names|forename|vorname|vornamen|prenom|prenoms|voornaam|"
    "imie|krestni jmeno|fornavn|fornamn|etunimi|名|名字|имя|keresztnev|ad|prenume",
    LAST: "last name|lastname|surname|family name|familyname|nachname|familienname|nom de famille|apellido|apellidos|"
    "apellido s|cognome|sobrenome|apelido|apelidos|achternaam|nazwisko|prijmeni|etternavn|efternavn|efternamn|sukunimi|"
    "姓|фамилия|vezeteknev|soyad",
    LOGIN: "sis login id|login|login id|loginname|username|user name|user id|userid|netid|net id|"
    "benutzername|anmeldename|"
    "benutzerkennung|kennung|nutzername|identifiant|nom d utilisateur|usuario|nombre de usuario|nome utente|"
    "nome de usuario|"
    "gebruikersnaam|nazwa uzytkownika|brugernavn|anvandarnamn|用户名|ユーザ名|логин",
    NUMBER: "sis user id|sis id|student id|studentid|sid|student number|id number|idnumber|matrikelnummer|matrikelnr|"
    "matrikel nr|matrikel|numero d identification|numero d etudiant|numero de id|numero de identificacion|matricola|"
    "numero di matricola|matricula|numero de matricula|studentnummer|studienummer|numer albumu|opiskelijanumero|学号|"
    "学籍番号|idナンバー|lms user id|org defined id|orgdefinedid",
    GROUP: "group|groups|group name|team|gruppe|gruppen|groupe|groupes|grupo|grupos|gruppo|gruppi|groep|groepen|grupa|"
    "skupina|组|小组|グループ|группа",
    GITHUB: "github|github username|github login|github user|github name",
}
_NAME = frozenset(("name", "nombre", "nome", "nom", "naam", "namn", "navn", "jmeno", "nimi", "名前"))
_MAIL = ("mail", "courriel", "correo", "メール", "邮箱", "почт")
_ID = "id"
_PARTICIPANT = re.compile(r"(?P<word>\D{2,40})\s(?P<number>\d{1,18})")
_MOST_LOOKED_AT = 50  # rows
_KINDS = {word: kind for kind, words in _WORDS.items() for word in words.split("|")}


@dataclass(frozen=True)
class Person:
    """Somebody of the class."""

    name: str  # as people write it, first name first
    values: dict[str, str] = field(default_factory=dict)  # what the list says, by the kinds of the columns

    def student(self, layout: str) -> str:
        """What they are called where they have handed in nothing."""
        own = {"canvas": CANVAS, "gradescope": NUMBER, "github": GITHUB}.get(layout, "")
        found = (self.values.get(kind, "") for kind in (own, *_IDENTIFIERS))
        return next((value for value in found if value), self.name)

    @property
    def platform(self) -> dict[str, str]:
        """What platforms call them, see `Entry.platform`."""
        return {key: self.values[kind] for kind, key in _PLATFORM.items() if self.values.get(kind)}


@dataclass(frozen=True)
class Roster:
    """A class list."""

    called: str  # the file's name
    people: tuple[Person, ...]  # who is in the class
    # each column's header and what it was taken for; those that were not used are left out
    read_as: tuple[tuple[str, str], ...]
    path: Path | None = None  # the file
    # the assignments of Canvas's gradebook, as its import has to call them: "Title (number)"
    canvas_assignments: tuple[str, ...] = ()


def read_roster(path: Path) -> Roster:
    """Read a class list: of Canvas, Moodle, nbgrader, or any CSV with names or identifiers."""
    rows = [row for row in _rows(path) if any(cell.strip() for cell in row)]
    if not rows:
        raise GradingError(f"{path} is empty. Give --roster a list of students, as CSV.")
    header = rows[0] if _has_header(rows[0]) else [f"column {place}" for place in range(1, len(rows[0]) + 1)]
    body = rows[1:] if header is rows[0] else rows
    kinds = _guess_kinds(header, body)
    if not {FULL, LAST, FIRST, MOODLE, *_IDENTIFIERS} & set(kinds):
        raise GradingError(
            f"Nothing in {path} looks like names, e-mail addresses or student numbers. Its columns are: "
            f"{', '.join(map(one_line, header[:20]))}. Give them headers such as 'name', 'email' or 'login'."
        )
    people = [person for row in body if (person := _person(row, kinds)) is not None]
    if not people:
        raise GradingError(f"{path} lists nobody.")
    read_as = tuple((one_line(head), kind) for head, kind in zip(header, kinds, strict=True) if kind)
    found = [head.strip() for head in header if _ASSIGNMENT.fullmatch(head.strip())] if CANVAS in kinds else []
    return Roster(path.name, _drop_repeated_people(people), read_as, path, tuple(found))


def _rows(path: Path) -> list[list[str]]:
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST + 1)
    except OSError as problem:
        raise GradingError(f"{path} could not be read: {problem.strerror}.") from problem
    if len(data) > _LARGEST:
        raise GradingError(f"{path} is larger than {_LARGEST // 1024**2} MB. Give --roster a list of students.")
    text = _decode_table(data)
    first = text.lstrip().split("\n", 1)[0]
    delimiter = max(_DELIMITERS, key=first.count)
    try:
        return list(csv.reader(text.splitlines(keepends=True), delimiter=delimiter))
    except csv.Error as problem:
        raise GradingError(f"{path} is not a CSV file: {problem}.") from problem


def _decode_table(data: bytes) -> str:
    """A text as Excel and learning platforms save it."""
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", errors="replace")


def _person(row: list[str], kinds: list[str]) -> Person | None:
    """Who a row is; None where it is nobody."""
    values = {kind: one_line(cell) for cell, kind in zip(row, kinds, strict=False) if kind and cell.strip()}
    if (number := _participant(values.get(MOODLE, ""))) or MOODLE in values:
        values[MOODLE] = number
    full = values.get(FULL, "")
    if plain_text(full) == _NO_STUDENT or full.casefold() == _TEST_STUDENT:
        return None
    last, comma, first = full.partition(",")
    name = f"{first.strip()} {last.strip()}" if comma else full
    if not name:
        name = " ".join(filter(None, (values.get(FIRST, ""), values.get(LAST, ""))))
    if not name and not any(values.get(kind) for kind in (*_IDENTIFIERS, MOODLE)):
        return None
    return Person(name.strip(), values)


def _drop_repeated_people(people: list[Person]) -> tuple[Person, ...]:
    """Everybody once, who may be listed in two sections."""
    found: dict[tuple[str, ...], Person] = {}
    for person in people:
        key = tuple(person.values.get(kind, "") for kind in (*_IDENTIFIERS, MOODLE))
        found.setdefault((*key, "" if any(key) else person.name, person.values.get(GROUP, "")), person)
    return tuple(found.values())


def plain_text(text: str) -> str:
    """A text without accents, signs and capitals, words apart by one blank."""
    letters = unicodedata.normalize("NFKD", text.casefold())
    plain = "".join(letter if letter.isalnum() else " " for letter in letters if not unicodedata.combining(letter))
    return unicodedata.normalize("NFC", " ".join(plain.split()))


def _guess_kinds(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """What each column holds, empty where nothing that matters here."""
    words = [plain_text(cell) for cell in header]
    kinds = [_by_word(word) for word in words]
    canvas = words[:1] == ["student"] and any(word.startswith("sis ") or word == "section" for word in words)
    for place, word in enumerate(words):
        cells = [row[place].strip() for row in rows[:_MOST_LOOKED_AT] if place < len(row) and row[place].strip()]
        if kinds[place] != GROUP and _are_participants(cells):
            kinds[place] = MOODLE
        elif word == _ID:
            kinds[place] = CANVAS if canvas else LOGIN
        elif cells and all("@" in cell for cell in cells) and kinds[place] in ("", EMAIL):
            kinds[place] = EMAIL
    for place, word in enumerate(words):
        if word in _NAME:
            kinds[place] = LAST if FIRST in kinds else FIRST if LAST in kinds else FULL
    return [kind if kind not in kinds[:place] else "" for place, kind in enumerate(kinds)]  # the first of a kind counts


def _has_header(row: Sequence[str]) -> bool:
    """Whether a first row names columns and is nobody."""
    words = [plain_text(cell) for cell in row]
    return any(_by_word(word) or word in _NAME or word == _ID for word in words) and "@" not in "".join(row)


def _participant(text: str) -> str:
    """The number of Moodle's `Participant 4711`, in any language; empty if it is something else."""
    match = _PARTICIPANT.fullmatch(text.strip())
    return match["number"] if match else ""


def _by_word(word: str) -> str:
    if any(part in word for part in _MAIL):
        return EMAIL
    return _KINDS.get(word, "")


def _are_participants(cells: Sequence[str]) -> bool:
    """Whether cells are one word, the same in all, with a number each."""
    matches = [_PARTICIPANT.fullmatch(cell) for cell in cells]
    return len(cells) > 1 and all(matches) and len({match["word"] for match in matches if match}) == 1
