"""A small exercise in a folder of an instructor's: a service with an interface of its own, checked by a file."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

ID = "add_three"
TOML = """\
format_version = 1
id = "add_three"
title = "A service that adds three numbers"
order = 5
points = 3.0
pass_mark = 2.0
class_name = "AddThree"
starter = "add_three.py"
notebook = "add_three.ipynb"
solution = "solution/add_three.py"
grader = "checks.py"

[[sentences]]
id = "service"
text = "A node offers the service `/add_three`."

[[sentences]]
id = "addition"
text = "It answers with the sum of the three numbers."

[[hints]]
for = ["offered"]
text = "Its name is add_three."

[[hints]]
for = ["adds"]
text = "A sum has three parts here."
"""
INTERFACE = "int64 a\nint64 b\nint64 c\n---\nint64 sum\n"
CHECKS = '''\
from three_interfaces.srv import Three

from course_kit.grading.checks.check import Evidence, Failed, check
from course_kit.grading.checks.discovery import expect_offered
from course_kit.grading.checks.services import Service, call

from .samples import SAMPLES

INTERFACES = (Three,)
SERVICE = Service("/add_three", Three)


@check(points=1.0, deadline_s=12.0, proves=["service"])
def offered(context):
    """The service is there."""
    return expect_offered(context, SERVICE, Three.Request())


@check(points=2.0, depends_on=["offered"], proves=["addition"])
def adds(context):
    """It adds."""
    for a, b, c in SAMPLES:
        sent, expected = f"{a}, {b}, {c}", str(a + b + c)
        got = call(context, SERVICE, Three.Request(a=a, b=b, c=c), sent, expected).response.sum
        if got != a + b + c:
            raise Failed(Evidence(sent, expected, str(got)), "The sum is wrong.")
    return Evidence(sent, expected, str(got))


CHECKS = [offered, adds]
'''
SAMPLES = "SAMPLES = [(1, 2, 3), (40, 1, 1)]\n"
SOLUTION = """\
import rclpy
from rclpy.node import Node
from three_interfaces.srv import Three


class AddThree(Node):
    def __init__(self):
        super().__init__("add_three")
        self.create_service(Three, "add_three", self.answer)

    def answer(self, request, response):
        response.sum = request.a + request.b + request.c
        return response


def main():
    rclpy.init()
    rclpy.spin(AddThree())


if __name__ == "__main__":
    main()
"""
STARTER = SOLUTION.replace("request.a + request.b + request.c", "0")


def notebook(name: str) -> str:
    """Its notebook: one cell to fill in, and one that grades it."""
    metadata = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    texts = ["%load_ext course_kit", f"%%submission {name}\n{STARTER}", f"%grade {name}"]
    cells = [
        {
            "cell_type": "code",
            "id": f"cell-{number}",
            "metadata": {},
            "source": text,
            "outputs": [],
            "execution_count": None,
        }
        for number, text in enumerate(texts)
    ]
    return json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": metadata, "cells": cells})


def write(folder: Path, name: str = ID) -> Path:
    """Make the exercise in `folder`; returns its own folder."""
    made = folder / name
    texts = {
        "exercise.toml": TOML.replace(f'id = "{ID}"', f'id = "{name}"'),
        "checks.py": CHECKS,
        "samples.py": SAMPLES,
        "add_three.py": STARTER,
        "add_three.ipynb": notebook(name),
        "solution/add_three.py": SOLUTION,
        "interfaces/three_interfaces/srv/Three.srv": INTERFACE,
    }
    for place, text in texts.items():
        path = made / place
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return made
