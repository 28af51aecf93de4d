"""What an author is told about mistakes in an exercise.toml: all of them, each with its line."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.grading import exercise, exercise_job
from course_kit.grading.checks.declared.lines import Lines
from course_kit.grading.errors import GradingError
from tests.grading.checks.declared.conftest import HEAD, HINTS, written

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from course_kit.grading.exercise import Exercise

ADDS = """
[[checks]]
id = "adds"
kind = "answers"
title = "It adds."
points = 1.0
service = "/add"
requests = [{a = 1, b = 2}]
expect = {sum = "request.a + request.b"}
"""
LIMITS = """
[[checks]]
id = "limits"
kind = "topic_answers"
title = "It limits."
points = 1.0
node = "all_kinds"
publisher = "/cmd_out"
messages = [
  {linear.x = 0.5},
  {linear = {x = {draw = [-1.0, 1.0], count = 3}}},
]
expect = {linear.x = "message.linear.x"}
"""
DECLARED = """
[[checks]]
id = "declared"
kind = "parameter_declared"
title = "It is declared."
points = 1.0
node = "all_kinds"
parameter = "limit"
default = 1.0
"""
ACTS = """
[[checks]]
id = "acts"
kind = "parameter_acts"
title = "It acts."
points = 1.0
node = "all_kinds"
publisher = "/beat"
set = {limit = 0.5}
expect = {data = "parameters.limit"}
"""
GOAL = """
[[checks]]
id = "goal"
kind = "goal_feedback"
title = "It tells."
points = 1.0
action = "/fib"
goals = {order = 5}
rising = ["sequence"]
"""
REFUSES = """
[[checks]]
id = "refuses"
kind = "refuses"
title = "It refuses."
points = 1.0
service = "/convert"
requests = [{from_unit = "kelvin", to_unit = "celsius"}]
refused = {success = false}
reason = "message"
"""
SENTENCE = '[[sentences]]\nid = "one"\ntext = "One."\n'
# The checks, what is changed in them, what stands on the line that is named, and what is said.
MISTAKES = [
    (ADDS, ('kind = "answers"', 'kind = "answer"'), 'kind = "answer"', "no kind 'answer'. Did you mean 'answers'?"),
    (ADDS, ('kind = "answers"', "kind = 3"), "[[checks]]", "'kind' is missing"),
    (ADDS, ("requests = [", "request = ["), "request = [", "no key 'request'. Did you mean requests?"),
    (ADDS, ("expect = ", "hz = 3\nexpect = "), "hz = 3", "no key 'hz'"),
    (ADDS, ('title = "It adds."\n', ""), "[[checks]]", "'title' is missing"),
    (ADDS, ('title = "It adds."', "title = 3"), "title = 3", "'title' has to be a text, not 3"),
    (ADDS, ("points = 1.0", "points = true"), "points = true", "'points' has to be a number above 0"),
    (ADDS, ("points = 1.0", "points = -1"), "points = -1", "'points' has to be a number above 0"),
    (ADDS, ('expect = {sum = "request.a + request.b"}\n', ""), "[[checks]]", "'expect' is missing"),
    (ADDS, ("requests = [{a = 1, b = 2}]\n", ""), "[[checks]]", "either 'requests' with one 'expect'"),
    (ADDS, ("{a = 1, b = 2}", "{a = 1, c = 2}"), "c = 2", "no field 'c' in the request of example_interfaces"),
    (ADDS, ("{a = 1, b = 2}", "{a = 1, b = 2.5}"), "b = 2.5", "The field 'b' is an int64; 2.5 is a number"),
    (ADDS, ("{a = 1, b = 2}", "{a = 1, b = {draw = [3, 1]}}"), "draw = [3, 1]", "the lowest and the highest number"),
    (ADDS, ("b = 2}", "b = {draw = [0.5, 1]}}"), "draw = [0.5", "The field 'b' is an int64; 0.5 is a number"),
    (ADDS, ("b = 2}", "b = {choice = [1, 'x']}}"), "choice = [1", "'x' is a text"),
    (ADDS, ("b = 2}", "b = {draw = [0, 9], count = 500}}"), "count = 500", "whole number from 1 to 50"),
    (
        ADDS,
        ("b = 2}]", "b = {draw = [0, 9], count = 30}}, {b = {draw = [0, 9], count = 30}}]"),
        "count = 30",
        "more than 50",
    ),
    (ADDS, ("b = 2}", "b = {draw = [0, 9], times = 5}}"), "times = 5", "A drawn value is"),
    (ADDS, ("{sum =", "{summ ="), "summ", "no field 'summ' in the response of example_interfaces/srv/AddTwoInts"),
    (ADDS, ("{sum =", "{total ="), "total", "it has sum."),
    (ADDS, ('"request.a + request.b"', '"request.a + request.c"'), "request.c", "no field 'c'"),
    (ADDS, ('"request.a + request.b"', '"requst.a"'), "requst.a", "no 'requst' here. Did you mean request?"),
    (ADDS, ('"request.a + request.b"', '"request.a +"'), "request.a +", "it is no expression"),
    (ADDS, ('"request.a + request.b"', '"hello"'), "hello", "write \"'hello'\""),
    (ADDS, ('"request.a + request.b"', "true"), "sum = true", "The field 'sum' is an int64; True is a truth value"),
    (ADDS, ("expect = ", 'tolerance = "none"\nexpect = '), 'tolerance = "none"', "'tolerance' has to be"),
    (ADDS, ('service = "/add"', 'service = "/addd"'), "/addd", "No service is called '/addd'. Did you mean '/add'?"),
    (ADDS, ('service = "/add"\n', ""), "[[checks]]", "'service' is missing: one of /add, /convert"),
    (ADDS, ('id = "adds"', 'id = "adds"\ndepends_on = ["ofered"]'), "[[checks]]", "depends on 'ofered', but no check"),
    (ADDS, ('id = "adds"', 'id = "adds"\ndepends_on = ["adds"]'), "[[checks]]", "in a circle: adds -> adds"),
    (LIMITS, ("{linear.x = 0.5}", "{linear.w = 0.5}"), "{linear.w", "no field 'w' in geometry_msgs/msg/Vector3"),
    (LIMITS, ("{linear.x = 0.5}", "{linear = 0.5}"), "{linear = 0.5}", "takes a table of that one's fields"),
    (LIMITS, ("draw = [-1.0, 1.0]", "draw = -1.0"), "draw = -1.0", "the lowest and the highest number"),
    (LIMITS, ('"message.linear.x"', '"message.linear.w"'), "message.linear.w", "no field 'w'"),
    (LIMITS + DECLARED, ('"message.linear.x"', '"parameters.limt"'), "parameters.limt", "Did you mean limit?"),
    (LIMITS, ('publisher = "/cmd_out"\n', ""), "[[checks]]", "'publisher' is missing: one of /cmd_out, /beat"),
    (DECLARED, ("default = 1.0", 'default = 1.0\ntype = "integer"'), "default = 1.0", "'type' is integer"),
    (DECLARED, ("default = 1.0", 'type = "float"'), 'type = "float"', "A parameter has no type 'float'"),
    (DECLARED, ('node = "all_kinds"\n', ""), "[[checks]]", "'node' is missing"),
    (
        ACTS + DECLARED,
        ("set = {limit", "set = {limitt"),
        "limitt",
        "declares a parameter 'limitt'. Did you mean limit?",
    ),
    (ACTS + DECLARED, ("set = {limit = 0.5}", "set = {limit = 2}"), "limit = 2", "2 a integer: write 2.0"),
    (GOAL, ('rising = ["sequence"]', 'rising = ["progress"]'), 'rising = ["progress"]', "no field 'progress'"),
    (GOAL, ("goals = {order = 5}", "goals = {oder = 5}"), "goals = {oder", "no field 'oder'"),
    (REFUSES, ('reason = "message"', 'reason = "why"'), 'reason = "why"', "no field 'why'"),
    (REFUSES, ("refused = {success = false}", "refused = {ok = false}"), "refused = {ok", "no field 'ok'"),
]


def told(load: Callable[..., Exercise], checks: str, **more: str) -> str:
    with pytest.raises(GradingError) as found:
        load(checks, **more)
    return str(found.value)


@pytest.mark.parametrize("checks", [ADDS, LIMITS, DECLARED, ACTS + DECLARED, GOAL, REFUSES], ids=str.split)
def test_what_is_right_is_loaded(load: Callable[..., Exercise], checks: str) -> None:
    task = load(checks)
    assert [one.id for one in task.declared] == re.findall(r'id = "(\w+)"', checks)
    assert task.grader == ""


@pytest.mark.parametrize("case", MISTAKES, ids=[case[3] for case in MISTAKES])
def test_a_mistake_is_told_with_its_line(
    load: Callable[..., Exercise], tmp_path: Path, case: tuple[str, tuple[str, str], str, str]
) -> None:
    checks, change, line, said = case
    assert change[0] in checks
    text = told(load, checks.replace(*change, 1))
    path = tmp_path / "exercises" / "all_kinds" / "exercise.toml"
    assert said in text
    number = next(int(found[1]) for found in re.finditer(r"line (\d+): ([^\n]*)", text) if said in found[2])
    assert line in path.read_text().splitlines()[number - 1]
    assert str(path) in text


def test_all_mistakes_are_told_at_once(load: Callable[..., Exercise]) -> None:
    checks = ADDS.replace('"answers"', '"answer"') + LIMITS.replace("linear.x = 0.5", "linear.w = 0.5").replace(
        '"message.linear.x"', '"message."'
    )
    text = told(load, checks, head=HEAD.replace("{points}", "9.0"))
    assert "has 4 mistakes" in text
    numbers = [int(number) for number in re.findall(r"line (\d+):", text)]
    assert len(numbers) == 4
    assert numbers == sorted(numbers)


@pytest.mark.parametrize(
    "case",
    [
        (HINTS, HEAD.replace("{points}", "3.0"), "points = 3.0", "the points of the checks are 1 + 1 = 2"),
        (HINTS.replace('"*"', '"adds"'), HEAD, "[[checks]]", "The check 'limits' has no hint"),
        (
            HINTS.replace('"*"', '"*", "topic.slient"'),
            HEAD,
            "[[hints]]",
            "for 'topic.slient', but no check and no diagnosis",
        ),
        (f"{HINTS}{SENTENCE}", HEAD, "[[checks]]", "The check 'adds' proves no sentence"),
        (f"{HINTS}{SENTENCE}", HEAD, "[[sentences]]", "No check proves the sentence 'one'"),
    ],
    ids=["points", "hint", "hint for nothing", "check without a sentence", "sentence without a check"],
)
def test_parts_that_do_not_agree_are_told(
    load: Callable[..., Exercise], tmp_path: Path, case: tuple[str, str, str, str]
) -> None:
    more, head, line, said = case
    text = told(load, ADDS + LIMITS, more=more, head=head)
    lines = (tmp_path / "exercises" / "all_kinds" / "exercise.toml").read_text().splitlines()
    number = next(int(found[1]) for found in re.finditer(r"line (\d+): ([^\n]*)", text) if said in found[2])
    assert line in lines[number - 1]


def test_an_unknown_sentence_and_a_circle_are_told(load: Callable[..., Exercise]) -> None:
    checks = ADDS.replace('id = "adds"', 'id = "adds"\nproves = ["sum"]\ndepends_on = ["limits"]')
    checks += LIMITS.replace('id = "limits"', 'id = "limits"\nproves = ["sums"]\ndepends_on = ["adds"]')
    text = told(load, checks, more=HINTS + '[[sentences]]\nid = "sums"\ntext = "It adds."\n')
    assert "proves the sentence 'sum', but the task has none of this id. Did you mean sums?" in text
    assert "in a circle: adds -> limits -> adds" in text
    assert "has 2 mistakes" in text


def test_a_sentence_that_grants_a_freedom_needs_no_check(load: Callable[..., Exercise]) -> None:
    sentences = '[[sentences]]\nid = "sums"\ntext = "It adds."\n[[sentences]]\nid = "free"\ntext = "x"\nfreedom = "y"\n'
    task = load(ADDS.replace('id = "adds"', 'id = "adds"\nproves = ["sums"]'), more=HINTS + sentences)
    assert task.declared[0].proves == ("sums",)


def test_two_checks_of_one_id_are_told(load: Callable[..., Exercise]) -> None:
    assert "Two checks have the id 'adds'" in told(load, ADDS + ADDS)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("example_interfaces/srv/AddTwoInts", "example_interfaces/srv/AddTwoIntss"), "AddTwoInts"),
        (("example_interfaces/srv/AddTwoInts", "example_interfaces/AddTwoInts"), "package/srv/Name"),
        (('kind = "service"', 'kind = "servic"'), "no kind of endpoint 'servic'. Did you mean 'service'?"),
        (('type = "example_interfaces/srv/AddTwoInts"\n', ""), "It lacks a key"),
    ],
)
def test_a_wrong_endpoint_is_told(tmp_path: Path, change: tuple[str, str], said: str) -> None:
    path = written(tmp_path, ADDS)
    path.write_text(path.read_text().replace(*change, 1))
    with pytest.raises(GradingError) as found:
        exercise.load("all_kinds", path.parent.parent)
    assert said in str(found.value)


PYTHON = '''
from course_kit.grading.checks.check import Evidence, check


@check(points={points}, depends_on=["adds"], proves=["sums"])
def more(context):
    """More."""
    return Evidence()


CHECKS = (more,)
'''


@pytest.mark.parametrize(("points", "fits"), [("1.0", True), ("2.0", False)])
def test_the_points_of_python_checks_count_as_well(tmp_path: Path, points: str, fits: bool) -> None:
    path = written(tmp_path / "other", ADDS)  # to know where the file goes
    folder = tmp_path / "exercises" / "all_kinds"
    folder.mkdir(parents=True)
    text = path.read_text().replace("points = 1.0\npass", "points = 2.0\npass")
    text = text.replace('class_name = "AllKinds"', 'class_name = "AllKinds"\ngrader = "checks.py"')
    (folder / "exercise.toml").write_text(text)
    (folder / "checks.py").write_text(PYTHON.replace("{points}", points))
    if fits:
        assert exercise.load("all_kinds", folder.parent).points == 2.0
        return
    with pytest.raises(GradingError, match=r"'points' is 2, but the points of the checks are 1 \+ 2 = 3"):
        exercise.load("all_kinds", folder.parent)


MARK = """
[[checks]]
id = "{id}"
kind = "python"
"""


def mixed(tmp_path: Path, checks: str) -> Exercise:
    """An exercise with these checks and the one in Python, `more`, which depends on `adds`."""
    path = written(tmp_path, checks)
    text = path.read_text().replace('class_name = "AllKinds"', 'class_name = "AllKinds"\ngrader = "checks.py"')
    declared = checks.count("points =")
    path.write_text(re.sub(r"^points = .*$", f"points = {declared + 1}.0", text, count=1, flags=re.MULTILINE))
    (path.parent / "checks.py").write_text(PYTHON.replace("{points}", "1.0"))
    return exercise.load("all_kinds", path.parent.parent)


@pytest.mark.parametrize(
    ("checks", "order"),
    [
        (ADDS + MARK.format(id="more") + ADDS.replace('"adds"', '"again"'), ["adds", "more", "again"]),
        (ADDS + ADDS.replace('"adds"', '"again"'), ["adds", "again", "more"]),
    ],
)
def test_checks_in_python_stand_where_they_are_marked_else_last(checks: str, order: list[str], tmp_path: Path) -> None:
    assert [one.id for one in exercise_job.checks_of(mixed(tmp_path, checks), 1)] == order


@pytest.mark.parametrize(
    ("checks", "said"),
    [
        (ADDS + MARK.format(id="mroe"), "No check in Python is called 'mroe'. Did you mean more?"),
        (ADDS + MARK.format(id="more") * 2, "The check 'more' stands here twice."),
        (ADDS + MARK.format(id="more") + "points = 2.0\n", "'points' of a check in Python stands beside its function"),
        (ADDS + '\n[[checks]]\nkind = "python"\n', "'id' is missing: the name of the check's function."),
    ],
)
def test_a_mark_that_fits_no_check_in_python_is_told(checks: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(GradingError) as found:
        mixed(tmp_path, checks)
    assert said in str(found.value)


def test_a_mark_without_any_check_in_python_is_told(load: Callable[..., Exercise]) -> None:
    assert "No check in Python is called 'more'. Name the file or module" in told(load, ADDS + MARK.format(id="more"))


def test_the_course_marks_a_check_that_its_module_lacks() -> None:
    task = replace(exercise.load("temperature_service"), check_order=("offered", "no_such"))
    with pytest.raises(GradingError, match="names the check 'no_such', and the grader has none of this id"):
        exercise_job.checks_of(task, 1)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("type = 'double'", "'type' is of one 'parameter', which is missing."),
        ("", "'parameter' is missing, or several: 'parameters', 'types' or 'defaults'."),
        ("types = { limit = 'doubel' }", "A parameter has no type 'doubel'. Did you mean double?"),
        (
            "types = { limit = 'double' }\ndefaults = { limit = 1 }",
            "The type of limit is double, but the default 1 is an integer.",
        ),
    ],
)
def test_mistakes_with_several_parameters_are_told(load: Callable[..., Exercise], keys: str, said: str) -> None:
    check = f'\n[[checks]]\nid = "d"\nkind = "parameter_declared"\ntitle = "D"\npoints = 1.0\nnode = "n"\n{keys}\n'
    assert said in told(load, check)


def test_variables_of_the_environment_travel_with_the_job(tmp_path: Path) -> None:
    path = written(tmp_path, ADDS, more='\n[[hints]]\nfor = ["*"]\ntext = "Think."\n\n[environment]\nSCALE = 0.1\n')
    task = exercise.load("all_kinds", path.parent.parent)
    assert exercise_job.of_running(task, 1).variables == {"SCALE": "0.1"}


TEXT = '''\
a = 1
text = """
[[checks]]
b = 2
"""
[[checks]] # one
c = [ # with a bracket ]
  {x = "]"},
  {y = 3},
]
"quoted" = 4
[other]
d = 5
[[checks]]
c = 6
[checks.expect]
e = 7
[[checks.cases]]
f = 8
[[checks.cases]]
f = 9
'''


@pytest.mark.parametrize(
    ("found", "wanted"),
    [
        (Lines(TEXT).of_key("a"), 1),
        (Lines(TEXT).of_key("text"), 2),
        (Lines(TEXT).of_table("checks"), 6),
        (Lines(TEXT).of_table("checks", 1), 14),
        (Lines(TEXT).within("checks", 0, "c"), 7),
        (Lines(TEXT).within("checks", 0, "c", "y"), 9),
        (Lines(TEXT).within("checks", 0, "c", "nothing"), 7),
        (Lines(TEXT).within("checks", 0, "quoted"), 11),
        (Lines(TEXT).within("checks", 1, "c"), 15),
        (Lines(TEXT).within("checks", 1, "z"), 14),
        (Lines(TEXT).within("checks", 1, "expect", "e"), 17),
        (Lines(TEXT).within("checks", 1, "cases", "f", "9"), 21),
        (Lines(TEXT).within("none", 1, "z"), 1),
    ],
)
def test_lines_are_found(found: int, wanted: int) -> None:
    assert found == wanted
