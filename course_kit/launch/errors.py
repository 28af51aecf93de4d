"""What goes wrong with a launch file, as a sentence."""

from __future__ import annotations

import inspect
import traceback
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self

_KIT = str(Path(__file__).parent)


class LaunchError(Exception):
    """A launch file cannot be run as it is."""

    def __init__(self, message: str, place: str = "") -> None:
        super().__init__(message)
        self.place = place

    def __str__(self) -> str:
        return f"{self.place}: {self.args[0]}" if self.place else str(self.args[0])

    def add_place(self, place: str) -> Self:
        """The same error with its place, unless a more exact one is known."""
        self.place = self.place or place
        return self


class ProgramError(LaunchError):
    """One program cannot be started; the rest of the launch can."""


def calling_place() -> str:
    """File and line of the code outside of this package that is running now, such as "robot.launch.py, line 9"."""
    frame = inspect.currentframe()
    while frame is not None and frame.f_back is not None and frame.f_code.co_filename.startswith(_KIT):
        frame = frame.f_back
    return "" if frame is None else f"{Path(frame.f_code.co_filename).name}, line {frame.f_lineno}"


def place_in(file: Path, error: Exception) -> str:
    """The line of a file that an exception has come through last."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    return f"{file.name}, line {lines[-1]}" if lines else file.name


def in_a_sentence(error: Exception, file: Path) -> LaunchError:
    """What a launch file, or a function in it, has raised, with the line of the file it comes from."""
    if isinstance(error, SyntaxError):
        return LaunchError(f"{type(error).__name__}: {error.msg}", f"{file.name}, line {error.lineno}")
    place = place_in(file, error)
    if type(error).__name__ == "PackageNotFoundError":  # of ament_index_python, which says where it has looked, too
        return LaunchError(f"{str(error.args[0]).partition(',')[0].capitalize()}.", place)
    text = str(error) if isinstance(error, ImportError) else f"{type(error).__name__}: {error}"
    return LaunchError(text, place)
