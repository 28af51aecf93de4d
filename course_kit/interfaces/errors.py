"""What goes wrong with interfaces, in words for the person who wrote the definition."""

from __future__ import annotations


class InterfaceDefinitionError(ValueError):
    """A definition is not valid .msg, .srv or .action text (see "Interfaces" among the ROS 2 concepts).

    Attributes:
        type_name: the interface being defined, such as "my_interfaces/srv/PersonInfo".
        line: number of the line at fault, from 1; 0 when the fault is in the name or in the text as a whole.
        text: that line as written, or "".
        expected: what was expected there, a sentence.
    """

    def __init__(self, type_name: str, line: int, text: str, expected: str) -> None:
        self.type_name, self.line, self.text, self.expected = type_name, line, text, expected
        where = f"{type_name}, line {line}: {text.strip()!r}. " if line else f"{type_name}: "
        super().__init__(where + expected)

    def __reduce__(self) -> tuple[type[InterfaceDefinitionError], tuple[str, int, str, str]]:
        return type(self), (self.type_name, self.line, self.text, self.expected)


class InterfaceNotFoundError(LookupError):
    """No interface of that name is installed, comes with the course, or has been defined.

    Attributes:
        type_name: the name that was asked for.
        nearest: the most similar name there is, or None.
    """

    def __init__(self, type_name: str, nearest: str | None = None, reason: str = "") -> None:
        self.type_name, self.nearest, self._reason = type_name, nearest, reason
        message = reason or f"There is no interface {type_name!r}."
        if nearest:
            message += f" Did you mean {nearest!r}?"
        elif not reason:
            message += " Define it first, or check the package's name."
        super().__init__(message)

    def __reduce__(self) -> tuple[type[InterfaceNotFoundError], tuple[str, str | None, str]]:
        return type(self), (self.type_name, self.nearest, self._reason)


class NativeHelperError(ImportError):
    """The native helper of the live interfaces cannot be used on this machine; says what to do."""
