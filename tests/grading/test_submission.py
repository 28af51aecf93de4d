"""Files from strangers: text when there is one, one clear sentence when there is none."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import copy_file
from course_kit.reader.text import LARGEST
from tests.reading import read

if TYPE_CHECKING:
    from pathlib import Path

EXERCISE = "temperature_service"


def notebook(*cells: object) -> str:
    return json.dumps({"cells": [{"cell_type": "code", "source": cell} for cell in cells]})


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.py", b"", "is empty"),
        ("a.py", b" \r\n\t\n", "is empty"),
        ("a.py", b"x = '\xff'", "not UTF-8 text (byte 6)"),
        ("a.py", b"# coding: utf8mb4\nx = 1", "names the encoding utf8mb4, which Python does not know"),
        ("a.py", b"# coding: rot13\nx = 1", "names the encoding rot13, which Python does not know"),
        ("a.py", b"\n# coding: ascii\nx = '\xe4'", "names the encoding ascii and is not written in it (byte 23)"),
        ("a.py", b"\xef\xbb\xbf# coding: latin-1\nx = 1", "begins as UTF-8 does and names the encoding latin-1"),
        ("a.py", b"x = 1\n# coding: latin-1\nx = '\xff'", "not UTF-8 text (byte 30)"),
        ("a.py", b"x = 1\0", "null bytes"),
        ("a.py", b"#" * (LARGEST + 1), "larger than 1024 kB"),
        ("a.txt", b"x = 1", "neither a .py nor an .ipynb"),
        ("a.ipynb", b"x = 1", "is not a Jupyter notebook"),
        ("a.ipynb", b"[]", "is not a Jupyter notebook"),
        ("a.ipynb", b'{"cells": 3}', "is not a Jupyter notebook"),
        ("a.ipynb", b'{"cells": [{"cell_type": "code", "source": 3}]}', "is not a Jupyter notebook"),
        ("a.ipynb", b"[" * 100_000, "is not a Jupyter notebook"),
        ("a.ipynb", notebook("x = 1").encode(), "'%%submission temperature_service'"),
        ("a.ipynb", notebook("%%submission other\nx = 1").encode(), "It has cells for: other"),
        ("a.ipynb", notebook(f"%%submission {EXERCISE}\n\n").encode(), "no code cell that begins"),
    ],
)
def test_unreadable(name: str, data: bytes, said: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(data)
    with pytest.raises(UnreadableError) as caught:
        read(path, EXERCISE)
    assert said in str(caught.value)
    assert name in str(caught.value)


def test_missing_folder_pipe_and_loop(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="There is no file"):
        read(tmp_path / "no.py", EXERCISE)
    with pytest.raises(UnreadableError, match=r"^\w+ is a folder. Name the .py or .ipynb file in it.$"):
        read(tmp_path, EXERCISE)
    os.mkfifo(tmp_path / "pipe.py")
    with pytest.raises(UnreadableError, match=r"^pipe.py is not an ordinary file. Hand in a .py or .ipynb file.$"):
        read(tmp_path / "pipe.py", EXERCISE)
    (tmp_path / "loop.py").symlink_to("loop.py")
    with pytest.raises(UnreadableError, match="cannot be read"):
        read(tmp_path / "loop.py", EXERCISE)


def test_a_file_that_is_closed_to_whoever_grades_is_nobody_s_zero(tmp_path: Path) -> None:
    closed = tmp_path / "closed.py"
    closed.write_text("x = 1\n")
    closed.chmod(0)
    user = os.geteuid()
    os.seteuid(user or 65534)  # root may read everything
    try:
        with pytest.raises(GradingError, match=r"^closed.py cannot be read: Permission denied.$"):
            copy_file(closed)
    finally:
        os.seteuid(user)


def test_link_out_of_its_folder_is_refused_and_one_inside_is_followed(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    inner.mkdir()
    (tmp_path / "secret.py").write_text("x = 1\n")
    (inner / "out.py").symlink_to("../secret.py")
    with pytest.raises(UnreadableError, match=r"^out.py is a link to a file outside"):
        read(inner / "out.py", EXERCISE)
    (inner / "real.py").write_text("y = 2\n")
    (inner / "near.py").symlink_to("real.py")
    assert read(inner / "near.py", EXERCISE).source == "y = 2\n"


@pytest.mark.parametrize("above", ["", "#!/usr/bin/env python3\n", "\n"])
def test_a_coding_line_is_read_as_python_reads_it(above: str, tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_bytes(f"{above}# -*- coding: latin-1 -*-\ny = 'ä'\n".encode("latin-1"))
    assert read(path, EXERCISE).source == f"{above}# -*- coding: utf-8 -*-\ny = 'ä'\n"


PROGRAM = """class Node{number}:
    pass

def main():
    print({number})

if __name__ == "__main__":
    main()"""


def test_of_two_whole_programs_in_two_cells_the_last_one_starts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.ipynb"
    mark = f"%%submission {EXERCISE}\n"
    path.write_text(notebook(mark + PROGRAM.format(number=1), mark + PROGRAM.format(number=2), f"{mark}last = 3"))
    found = read(path, EXERCISE)
    assert found.note == "several cells define main: the last one counts"
    assert found.describe_line(found.source[: found.source.index("class Node2")].count("\n") + 1) == "cell 2, line 2"
    names: dict[str, object] = {"__name__": "__main__"}
    exec(found.source, names)  # noqa: S102 - it is ours
    assert capsys.readouterr().out == "2\n"
    assert names["last"] == 3
    path.write_text(notebook(f"{mark}class A: pass\ndef main(): pass", f"{mark}class A: x = 1\ndef main(): pass"))
    assert read(path, EXERCISE).note == "several cells define A: the last one counts"
    path.write_text(notebook(mark + PROGRAM.format(number=1)))
    assert (read(path, EXERCISE).note, read(path, EXERCISE).source) == ("", PROGRAM.format(number=1) + "\n")


def test_notebook_cells_are_joined_in_order_and_lines_are_found_again(tmp_path: Path) -> None:
    path = tmp_path / "a b.ipynb"
    cells = (
        f"%%submission {EXERCISE}\na = 1\nb = 2",
        "!rm -rf /",
        [f"%%submission  {EXERCISE} \r\n", "c = 3\r\n"],
        f"# %%submission {EXERCISE}\nd = 4",
    )
    path.write_text(notebook(*cells))
    found = read(path, EXERCISE)
    assert found.source.split() == ["a", "=", "1", "b", "=", "2", "c", "=", "3"]
    assert found.program == "a b.py"
    assert (found.describe_line(1), found.describe_line(2), found.describe_line(3)) == (
        "cell 1, line 2",
        "cell 1, line 3",
        "cell 3, line 2",
    )


EXPORTED = f"""#!/usr/bin/env python
# In[1]:
get_ipython().run_line_magic('load_ext', 'course_kit')
# In[7]:
get_ipython().run_cell_magic('submission', '{EXERCISE}', 'x = 1\\ny = "\\\\n"\\n')
# In[8]:
get_ipython().run_cell_magic('time', '', 'z = 3\\n')
"""


def test_a_notebook_that_was_exported_as_a_script_is_its_marked_cell(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text(EXPORTED)
    found = read(path, EXERCISE)
    assert found.source.split("\n")[:2] == ["x = 1", 'y = "\\n"']
    assert found.describe_line(2) == "In[7], line 3"
    with pytest.raises(UnreadableError, match=f"cells for: {EXERCISE}"):
        read(path, "move_robot")
    path.write_text("print('run_cell_magic')\n")
    assert read(path, EXERCISE).source == "print('run_cell_magic')\n"


@pytest.mark.parametrize("name", ["a.PY", "a.py.txt", "A.Py.TXT", "a.py.json"])
def test_endings_that_windows_and_browsers_make(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text("x = 1\n")
    found = read(tmp_path / name, EXERCISE)
    assert (found.source, found.program.lower()) == ("x = 1\n", "a.py")
    for ending in ("IPYNB", "ipynb.json", "ipynb.txt"):
        (tmp_path / f"a.{ending}").write_text(notebook(f"%%submission {EXERCISE}\nx = 1"))
        assert read(tmp_path / f"a.{ending}", EXERCISE).source == "x = 1\n"


def test_syntax_fault_has_line_and_text(tmp_path: Path) -> None:
    path = tmp_path / "a.py"
    path.write_text("x = 1\nif x\n    pass\n")
    fault = read(path, EXERCISE).fault
    assert fault is not None
    assert (fault.line, fault.text) == (2, "if x")
    path.write_text("x = " + "(" * 5000 + ")" * 5000)
    assert read(path, EXERCISE).fault is not None
