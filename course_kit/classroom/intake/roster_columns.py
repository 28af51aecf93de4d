"""What the columns of a class list hold: told by their headers, in several languages, and else by what is in them."""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

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
_IDENTIFIERS = (LOGIN, NUMBER, CANVAS, MOODLE, GITHUB, EMAIL)
_LOGIN_CELL = re.compile(r"(?=[\d_.@+-]*[^\W\d_])[\w.@+-]*")  # one word with a letter
_NUMBER_CELL = re.compile(r"\d{4,20}")  # longer than one that counts the rows
_KINDS = {word: kind for kind, words in _WORDS.items() for word in words.split("|")}


def plain(text: str) -> str:
    """A text without accents, signs and capitals, words apart by one blank."""
    letters = unicodedata.normalize("NFKD", text.casefold())
    kept = "".join(one if one.isalnum() else " " for one in letters if not unicodedata.combining(one))
    return unicodedata.normalize("NFC", " ".join(kept.split()))


def guess(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """What each column holds, empty where nothing that matters here."""
    words = [plain(one) for one in header]
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
    if {FULL, FIRST, LAST} & set(kinds) and not set(_IDENTIFIERS) & set(kinds):
        kinds = _with_identifier(kinds, rows)
    return _each_once(kinds)


def _with_identifier(kinds: list[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The same with a login or number where the header is of no language known here, told by its cells."""
    for place, kind in enumerate(kinds):
        cells = [row[place].strip() if place < len(row) else "" for row in rows]
        if kind or len(cells) < 2 or len(set(cells)) < len(cells):  # noqa: PLR2004 - of one nothing can be told
            continue
        for found, fits in ((NUMBER, _NUMBER_CELL.fullmatch), (LOGIN, _LOGIN_CELL.fullmatch)):
            if all(map(fits, cells)):
                return [*kinds[:place], found, *kinds[place + 1 :]]
    return kinds


def has_header(row: Sequence[str]) -> bool:
    """Whether a first row names columns and is nobody."""
    words = [plain(one) for one in row]
    return any(_by_word(word) or word in _NAME or word == _ID for word in words) and not any("@" in one for one in row)


def participant(text: str) -> str:
    """The number of Moodle's `Participant 4711`, in any language; empty when there is none."""
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


def _each_once(kinds: Sequence[str]) -> list[str]:
    """Of two columns of a kind the first counts."""
    return [kind if kind not in kinds[:place] else "" for place, kind in enumerate(kinds)]
