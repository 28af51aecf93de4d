"""What the grader's processes tell each other arrives as it was."""

from __future__ import annotations

import json

import msgspec

from course_kit.grading.model.job import Isolation, Job
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import convert_record
from course_kit.grading.model.submission import Facts, Submission, SyntaxFault
from course_kit.grading.sandbox.file_view import FileView
from course_kit.grading.sandbox.start_order import Program, StartOrder


def through_json(thing: object) -> dict[str, object]:
    read: dict[str, object] = json.loads(json.dumps(msgspec.to_builtins(thing)))
    return read


def test_a_job_arrives_with_all_its_parts() -> None:
    facts, files = Facts(awaits=True, functions=((1, 3, True),)), {"b.py": Submission("b.py", "b.py", "")}
    fault, literal = SyntaxFault(1, "x", "no"), {"entries": [["a", "b"]]}
    text = Submission(
        "answer.ipynb", "answer.py", "x", (("In[1]", 4), ("cell 3", 2)), fault, facts, literal, "A", files
    )
    isolation, limits = Isolation(network=True, reason="none"), Limits(memory_mb=99)
    job = Job("a.grader", "run", 7, text, command=("ros2",), limits=limits, isolation=isolation, hidden=("/a", "/b"))
    assert convert_record(through_json(job), Job) == job


def test_an_order_to_start_a_program_arrives() -> None:
    program = Program("a.py", "text", arguments=("-p", "x"), files={"f": "text"}, command=("sh",))
    view = FileView(("/usr",), ("/usr/x",), ("/bin",))
    order = StartOrder(program, Limits(tasks=9), Isolation(files=True), "/scratch", view, {"A": "b"})
    assert convert_record(through_json(order), StartOrder) == order
