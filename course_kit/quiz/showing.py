"""How a learner sees their scenarios: in a notebook, in a terminal, and as a file to fill in."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.quiz.bank import DEFAULT_SEED, draw_scenarios, reasons_as_shown
from course_kit.text.console import wrap_text
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Mapping


_TEMPLATE = Path(__file__).with_name("templates") / "scenarios.html"
_ASKED = "Which pattern fits best (topic, service or action), and which one of the four reasons decides?"
# The list is that of the exercise's exercise.toml, sentence by sentence; a test compares.
_HEAD = '''"""Exercise 4: which communication pattern fits?

- For each of your ten scenarios you get half a point for the pattern that fits:
  `topic`, `service` or `action`. You get another half point for the reason that
  decides: one of the four below the scenario.
- Several reasons may be true, but only one decides: if that one were not true,
  you would choose another pattern.
- In a few scenarios two patterns can be defended. Then each of the two counts,
  with the reason that belongs to it.
- The answers are a dictionary called `answers`. Each scenario has an entry: the
  id of the scenario, then the pattern and the id of the reason, as in
  `"some_robot": ("topic", "some_reason"),`. Capital letters in these words, and
  spaces around them, do not matter. Keep it a plain dictionary of texts: then
  the grader only reads your file. If your file computes the answers, the grader
  runs it.
- An answer that is missing or malformed earns nothing, and the others count. An
  entry that belongs to no scenario is reported; it costs nothing by itself.
"""
'''


class Questions:
    """The scenarios of one seed; a notebook shows them as HTML, anything else as text."""

    def __init__(self, seed: int = DEFAULT_SEED) -> None:
        self.seed = seed
        self.scenarios = draw_scenarios(seed)

    def form(self) -> str:
        """The answers as Python, one empty pair for each scenario, to be copied."""
        return "\n".join(["answers = {", *(f'    "{scenario.id}": ("", ""),' for scenario in self.scenarios), "}"])

    def sheet(self, answers: Mapping[str, tuple[str, str]] | None = None) -> str:
        """The answers as a Python file: all scenarios and reasons as comments, with a pair under each."""
        lines = [_HEAD, "answers = {"]
        for number, scenario in enumerate(self.scenarios, start=1):
            pattern, reason = (answers or {}).get(scenario.id, ("", ""))
            lines += [f"    # ---- {number}. {scenario.title} ----", *wrap_text(scenario.text, "    # ", "    # ")]
            for name, text in reasons_as_shown(scenario, self.seed):
                lines += wrap_text(f"{name}: {text}", "    #   - ", "    #     ")
            lines.append(f'    "{scenario.id}": ("{pattern}", "{reason}"),')
        return "\n".join([*lines, "}", ""])

    def __repr__(self) -> str:
        parts = ["\n".join(wrap_text(_ASKED))]
        for number, scenario in enumerate(self.scenarios, start=1):
            lines = [f"{number}. {scenario.title}  [{scenario.id}]", *wrap_text(scenario.text, "   ", "   ")]
            for name, text in reasons_as_shown(scenario, self.seed):
                lines += wrap_text(f"{name}: {text}", "   - ", "     ")
            parts.append("\n".join(lines))
        return "\n\n".join(parts)

    def _repr_html_(self) -> str:
        return str(render_template(_TEMPLATE, questions=self, asked=_ASKED, reasons=reasons_as_shown))


def show(seed: int = DEFAULT_SEED) -> Questions:
    """The ten scenarios of a learner, to be the last line of a cell."""
    if not isinstance(seed, int) or isinstance(seed, bool):
        raise TypeError(f"The seed must be a whole number, such as seed=17, not {seed!r}.")
    return Questions(seed)
