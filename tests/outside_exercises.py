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

[[endpoints]]
kind = "service"
name = "/add_three"
type = "three_interfaces/srv/Three"

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
from course_kit.grading.checks.vocabulary import check, endpoints_offered

from .samples import SAMPLES


@check(points=2.0, after=["offered"], proves=["addition"])
def adds(node):
    """It adds."""
    for a, b, c in SAMPLES:
        node.call("/add_three", a=a, b=b, c=c).expect(sum=a + b + c, why="The sum is wrong.")


there = endpoints_offered(points=1.0, proves=["service"], title="The service is there")
CHECKS = [there, adds]
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
