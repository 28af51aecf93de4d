"""What every action of a launch file can do, and how actions are run one after the other."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from course_kit.launch.description import LaunchDescription
from course_kit.launch.entity import LaunchEntity
from course_kit.launch.errors import LaunchError, in_a_sentence

if TYPE_CHECKING:
    from course_kit.launch.context import LaunchContext
    from course_kit.launch.substitutions import Condition


class Action(LaunchEntity):
    """Something a launch file does."""

    condition: Condition | None = None

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def visit(self, context: LaunchContext) -> object:
        """Do it if its condition holds; what is to be done after it, as `execute` returns it."""
        if self.condition is not None and not self.condition.evaluate(context):
            return None
        return self.execute(context)

    def execute(self, context: LaunchContext) -> object:
        """Do it."""
        raise NotImplementedError(type(self).__name__)

    def sub_entities(self) -> Iterable[object]:
        """Actions that may come of it, as far as is known before it is done."""
        return ()


def execute_all(entities: object, context: LaunchContext) -> None:
    """Run actions in order."""
    for entity in as_entities(entities):
        if isinstance(entity, LaunchDescription):
            execute_all(entity.entities, context)
        elif isinstance(entity, Action):
            execute_all(_done(entity, context), context)
        else:
            raise LaunchError(f"{entity!r} is not part of the course kit's subset of launch.")


def as_entities(entities: object) -> list[object]:
    """One or many of them, as a list."""
    if entities is None:
        return []
    if isinstance(entities, Iterable) and not isinstance(entities, str):
        return list(entities)
    return [entities]


def _done(action: Action, context: LaunchContext) -> object:
    try:
        return action.visit(context)
    except LaunchError as error:
        raise error.at(action.place) from None
    except Exception as error:
        raise in_a_sentence(error, context.file) from error
