"""Each demo has a ROS graph of its own: one fails because a node is missing, and another one's would repair it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

DOMAIN = "%load_ext course_kit\nimport os, subprocess, sys\nprint(os.environ['ROS_DOMAIN_ID'])"
CHILD = (
    "from course_kit import environment\n"
    "program = 'import rclpy, os; print(os.environ[\"ROS_DOMAIN_ID\"])'\n"
    "print(subprocess.run([sys.executable, '-c', program], capture_output=True, text=True).stdout.strip())"
)


def domain_of(notebook: Path, monkeypatch: pytest.MonkeyPatch, *, by_user: str = "") -> set[str]:
    """The domain of a notebook's kernel and of a program that it starts."""
    monkeypatch.setenv("ROS_DOMAIN_ID", by_user)
    monkeypatch.setenv("JPY_SESSION_NAME", str(notebook))
    monkeypatch.delenv("COURSE_KIT_DOMAIN_ID", raising=False)
    with Kernel(cwd=notebook.parent) as kernel:
        return {kernel.run(DOMAIN).stdout.strip(), kernel.run(CHILD).stdout.strip()}


def test_a_demo_has_a_domain_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "demos").mkdir()
    names = ("01_services.ipynb", "demos/01_deadlock.ipynb", "demos/05_wrong_name.ipynb")
    lessons, deadlock, wrong_name = (domain_of(tmp_path / name, monkeypatch) for name in names)
    assert len(lessons | deadlock | wrong_name) == 3
    assert len(deadlock) == len(wrong_name) == 1  # the program joins its notebook's


def test_a_domain_that_the_user_has_chosen_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, domain: int
) -> None:
    (tmp_path / "demos").mkdir()
    assert domain_of(tmp_path / "demos" / "01_deadlock.ipynb", monkeypatch, by_user=str(domain)) == {str(domain)}
