"""The programs of mutants.toml."""

from __future__ import annotations

import sys

from tests.robot_parameters.conftest import EXERCISE, ROOT, SOLUTION, Mutant

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

CORRECT = ROOT / "tests" / "grading" / "correct" / EXERCISE
TABLE = tomllib.loads((ROOT / "tests" / EXERCISE / "mutants.toml").read_text(encoding="utf-8"))

MUTANTS = tuple(
    Mutant(
        name=name,
        changes=tuple((change["old"], change["new"]) for change in entry["changes"]),
        failed=frozenset((check, code or None) for check, code in entry["failed"].items()),
        says=entry.get("says", ""),
        base=CORRECT / f"{entry['base']}.py" if "base" in entry else SOLUTION,
    )
    for name, entry in TABLE.items()
)
