"""Why a process of the course gets no ROS graph."""

from __future__ import annotations


class DomainError(RuntimeError):
    """This process gets no ROS domain to work in; the message says why and what to do."""

    def _render_traceback_(self) -> list[str]:
        """IPython's hook for exceptions that print themselves: in a notebook the message alone matters."""
        return [f"{type(self).__name__}: {self}"]


class SettingsError(DomainError, ValueError):
    """A value the user has set cannot be used."""
