"""What is wrong with the settings of the user."""

from __future__ import annotations


class SettingsError(ValueError):
    """A value the user has set cannot be used."""
