"""What students really hand in for one exercise: the files of each accident, which of them counts, and why."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import dataclass, field

from course_kit.grading.model.exercise import load_exercise

SERVICE = load_exercise("temperature_service")
STARTER = (SERVICE.folder / SERVICE.starter).read_bytes()
STARTER_NOTEBOOK = (SERVICE.folder / SERVICE.notebook).read_bytes()
PY, NOTEBOOK = SERVICE.starter, SERVICE.notebook
AS_NAMED = "same name as the starter"
CALLED = "the exercise's name is in its name"
HOLDS = "it holds TemperatureService"
ALONE = "the only program"
DIFFERS = "the only one of 2 files that differs from the starter"
UNCHANGED = "the starter, unchanged"


@dataclass(frozen=True)
class Accident:
    """What one student hands in.

    Attributes:
        files: names and contents, the oldest first.
        chosen: the one that counts, as a path below the student's folder.
        why: the reason in the table.
        left: of the others the reason, by path; `{chosen}` in it stands for what was chosen.
        worry: what the instructor should look at.
        fresh: names of files that are a day newer than the others.
    """

    files: dict[str, bytes]
    chosen: str
    why: str = AS_NAMED
    left: dict[str, str] = field(default_factory=dict)
    worry: str = ""
    fresh: tuple[str, ...] = ()


def program(number: int, above: str = "") -> bytes:
    """A solution, another one for each student."""
    return f"{above}class TemperatureService(Node):\n    number = {number}\n".encode()


def notebook(number: int, above: str = "", output: str = "") -> bytes:
    """A notebook with a solution."""
    source = f"{above}%%submission temperature_service\n{program(number).decode()}"
    outputs = [{"output_type": "stream", "name": "stdout", "text": output}]
    cells = [
        {"cell_type": "markdown", "metadata": {}, "source": "# Exercise"},
        {"cell_type": "code", "metadata": {}, "execution_count": 1, "outputs": outputs, "source": source},
    ]
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}).encode()


def exported(number: int) -> bytes:
    """The same, as Jupyter exports it to a script."""
    cell = repr(program(number).decode())
    text = "#!/usr/bin/env python\n# coding: utf-8\n\n# # Exercise\n\n# In[1]:\n\n\n"
    return f"{text}get_ipython().run_cell_magic('submission', 'temperature_service', {cell})\n".encode()


def zipped(files: dict[str, bytes], separator: str = "/") -> bytes:
    """A zip as a student makes it; on a Mac and on Windows."""
    memory = io.BytesIO()
    with zipfile.ZipFile(memory, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in files.items():
            member = zipfile.ZipInfo("x", (2026, 11, 1, 12, 0, 0))
            member.filename = name.replace("/", separator)
            packed.writestr(member, content)
    return memory.getvalue()


def used(why: str) -> str:
    """What the table says of a file that was not chosen."""
    return f"{why}; {{chosen}} was used instead"


def with_the_kit(number: int) -> dict[str, bytes]:
    """A fork of the course, in which the exercise was solved where it lies."""
    return {
        "course/course_kit/__init__.py": b"",
        "course/course_kit/graders/temperature_service.py": b"class TemperatureService:\n    pass\n",
        "course/solutions/temperature_service/temperature_service.py": program(-1),
        "course/tests/broken/temperature_service/service.no_return.py": program(-2),
        "course/notebooks/01_services.ipynb": STARTER_NOTEBOOK,
        "course/exercises/temperature_service/exercise.toml": b"",
        f"course/exercises/temperature_service/{PY}": program(number),
        f"course/exercises/temperature_service/{NOTEBOOK}": STARTER_NOTEBOOK,
        "course/exercises/move_robot/exercise.toml": b"",
    }


def _of_the_kit(folder: str) -> dict[str, str]:
    parts = dict.fromkeys(list(with_the_kit(0))[:5], "a part of the course kit")
    own = f"course/exercises/temperature_service/{NOTEBOOK}"
    none = "it belongs to none of these exercises"
    rest = dict.fromkeys(
        ("course/exercises/temperature_service/exercise.toml", "course/exercises/move_robot/exercise.toml"), none
    )
    return {f"{folder}{name}": why for name, why in {**parts, **rest, own: used(UNCHANGED)}.items()}


def accidents(number: int) -> list[Accident]:
    """All accidents, as they happen to a student of this number."""
    own = program(number)
    changed_comment = STARTER.replace(b"\n", b"\r\n") + b"\r\n# I looked at it\r\n"
    conversions = b"from conversions import to_kelvin\n" + own
    return [
        Accident({PY: own}, PY),
        Accident({PY: own, NOTEBOOK: STARTER_NOTEBOOK}, PY, f"{DIFFERS}; {AS_NAMED}", {NOTEBOOK: used(UNCHANGED)}),
        Accident({PY: STARTER, NOTEBOOK: notebook(number)}, NOTEBOOK, f"{DIFFERS}; {AS_NAMED}", {PY: used(UNCHANGED)}),
        Accident({PY: STARTER}, PY, f"{AS_NAMED}; it is {UNCHANGED}", worry=f"it is {UNCHANGED}"),
        Accident(
            {PY: changed_comment, NOTEBOOK: notebook(number)}, NOTEBOOK, f"{DIFFERS}; {AS_NAMED}", {PY: used(UNCHANGED)}
        ),
        Accident({"TEMPERATURE_SERVICE.PY": own}, "TEMPERATURE_SERVICE.PY"),
        Accident({f"{PY}.txt": own}, f"{PY}.txt", CALLED),
        Accident({f"{NOTEBOOK}.json": notebook(number)}, f"{NOTEBOOK}.json", CALLED),
        Accident({"temperature_service (1).py": own}, "temperature_service (1).py"),
        Accident(
            {"answer.py": own, "notes.txt": b""},
            "answer.py",
            HOLDS,
            {"notes.txt": "it belongs to none of these exercises"},
        ),
        Accident(
            {"week3.py": b"class Other:\n    pass\n"}, "week3.py", ALONE, worry="it does not hold TemperatureService"
        ),
        Accident({NOTEBOOK: notebook(number, above="# my solution\n\n")}, NOTEBOOK),
        Accident(
            {PY: exported(number), NOTEBOOK: STARTER_NOTEBOOK},
            PY,
            f"{DIFFERS}; {AS_NAMED}",
            {NOTEBOOK: used(UNCHANGED)},
        ),
        Accident({NOTEBOOK: notebook(number, output="x" * 5_000_000)}, NOTEBOOK),
        Accident(
            {PY: conversions, "conversions.py": b"def to_kelvin(x):\n    return x\n"},
            PY,
            f"{AS_NAMED}; it imports conversions.py, and only one file is graded",
            {"conversions.py": "it belongs to none of these exercises"},
            "it imports conversions.py, and only one file is graded",
        ),
        Accident(
            {"temperature_service_old.py": own, "temperature_service_final.py": program(-number)},
            "temperature_service_final.py",
            f"{{newest}} of 2 files; {CALLED}",
            {"temperature_service_old.py": used("{older}")},
            fresh=("temperature_service_final.py",),
        ),
        Accident(
            {"homework.zip": zipped({f"hw/{PY}": own, f"__MACOSX/hw/._{PY}": b"\0"})},
            f"homework.zip.contents/hw/{PY}",
            left={"homework.zip.contents/__MACOSX": "a folder of a tool"},
        ),
        Accident(
            {"homework.zip": zipped({f"hw/{PY}": own, "hw/notes.txt": b""}, "\\")},
            f"homework.zip.contents/hw/{PY}",
            left={"homework.zip.contents/hw/notes.txt": "it belongs to none of these exercises"},
        ),
        Accident(
            {"fork.zip": zipped(with_the_kit(number))},
            f"fork.zip.contents/course/exercises/temperature_service/{PY}",
            f"{DIFFERS}; {AS_NAMED}",
            _of_the_kit("fork.zip.contents/"),
        ),
        Accident(
            {PY: STARTER, "temperature_service.backup-1.py": own},
            "temperature_service.backup-1.py",
            f"{DIFFERS}; {CALLED}",
            {PY: used(UNCHANGED)},
        ),
    ]


def of_student(number: int) -> Accident:
    """What the student of this number hands in."""
    found = accidents(number)
    return found[number % len(found)]
