"""What students really hand in for one exercise: the files of each accident. What counts, and why, is frozen."""

from __future__ import annotations

import io
import json
import zipfile

from course_kit.grading.model.exercise import load_exercise

SERVICE = load_exercise("temperature_service")
STARTER = (SERVICE.folder / SERVICE.starter).read_bytes()
STARTER_NOTEBOOK = (SERVICE.folder / SERVICE.notebook).read_bytes()
PY, NOTEBOOK = SERVICE.starter, SERVICE.notebook
FINAL = "temperature_service_final.py"  # a day newer than all else


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


def accidents(number: int) -> list[dict[str, bytes]]:
    """All accidents, as they happen to a student of this number: names and contents, the oldest first."""
    own = program(number)
    changed_comment = STARTER.replace(b"\n", b"\r\n") + b"\r\n# I looked at it\r\n"
    conversions = b"from conversions import to_kelvin\n" + own
    return [
        {PY: own},
        {PY: own, NOTEBOOK: STARTER_NOTEBOOK},
        {PY: STARTER, NOTEBOOK: notebook(number)},
        {PY: STARTER},
        {PY: changed_comment, NOTEBOOK: notebook(number)},
        {"TEMPERATURE_SERVICE.PY": own},
        {f"{PY}.txt": own},
        {f"{NOTEBOOK}.json": notebook(number)},
        {"temperature_service (1).py": own},
        {"answer.py": own, "notes.txt": b""},
        {"week3.py": b"class Other:\n    pass\n"},
        {NOTEBOOK: notebook(number, above="# my solution\n\n")},
        {PY: exported(number), NOTEBOOK: STARTER_NOTEBOOK},
        {NOTEBOOK: notebook(number, output="x" * 5_000_000)},
        {PY: conversions, "conversions.py": b"def to_kelvin(x):\n    return x\n"},
        {"temperature_service_old.py": own, FINAL: program(-number)},
        {"homework.zip": zipped({f"hw/{PY}": own, f"__MACOSX/hw/._{PY}": b"\0"})},
        {"homework.zip": zipped({f"hw/{PY}": own, "hw/notes.txt": b""}, "\\")},
        {"fork.zip": zipped(with_the_kit(number))},
        {PY: STARTER, "temperature_service.backup-1.py": own},
    ]


def of_student(number: int) -> dict[str, bytes]:
    """What the student of this number hands in."""
    found = accidents(number)
    return found[number % len(found)]
