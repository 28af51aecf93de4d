"""Programs to compare: an original, and what becomes of it on its way round the class."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from tests.classroom.exports.books import SERVICE, good

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import GradeRecord

ORIGINAL = """
import math

class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.table = {("celsius", "fahrenheit"): (1.8, 32.0), ("fahrenheit", "celsius"): (1 / 1.8, -32 / 1.8)}
        self.asked = self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(self, request, response):
        lowest = -273.15 if request.from_unit == "celsius" else -459.67
        if not math.isfinite(request.value) or request.value < lowest:
            response.message = f"{request.value} is impossible"
            return response
        try:
            factor, shift = self.table[request.from_unit, request.to_unit]
        except KeyError:
            response.message = "unknown unit"
        else:
            response.success, response.value = True, request.value * factor + shift
        return response
"""
OTHER = '''
from math import isnan, isinf

LIMITS = dict(celsius=-273.15, fahrenheit=-459.67)

def convert(value, source, target):
    """Somebody else's own way."""
    if source == target:
        return value
    if source == "celsius":
        return 32 + value * 9 / 5
    return (value - 32) * 5 / 9

class TemperatureService(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "/convert_temperature", self.answer)

    def answer(self, request, response):
        for unit in request.from_unit, request.to_unit:
            if unit not in LIMITS:
                return self.refuse(response, unit)
        if isnan(request.value) or isinf(request.value):
            return self.refuse(response, "not a number")
        if LIMITS[request.from_unit] > request.value:
            return self.refuse(response, "too cold")
        response.value = convert(request.value, request.from_unit, request.to_unit)
        response.success = True
        return response

    def refuse(self, response, why):
        response.success = False
        response.message = str(why)
        return response
'''


def disguised(text: str) -> str:
    """Other names, other values, comments between the lines, wider indentation."""
    for name in ("asked", "convert", "lowest", "factor", "shift", "table"):
        text = re.sub(rf"\b{name}\b", f"my_{name[::-1]}", text)
    text = text.replace("is impossible", "geht nicht").replace("273.15", "273.150")
    return "\n".join(f"{line}  # line\n" for line in text.replace("    ", "      ").split("\n"))


def moved(text: str) -> str:
    """Its methods in another order."""
    head, first, second = re.split(r"(?=    def )", text)
    return head + second + "\n" + first


def starter() -> str:
    return (SERVICE.folder / SERVICE.starter).read_text(encoding="utf-8")


def class_of(root: Path, **programs: str) -> list[GradeRecord]:
    """Records of students with these programs, which lie in `root`."""
    records = []
    for student, text in programs.items():
        path = root / student / SERVICE.starter
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
        records.append(good(student, digest=str(hash(text))))
    return records
