"""Actions that hold for those after them, and groups that say where this ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.launch.action import Action, execute_all
from course_kit.launch.node import joined_namespace
from course_kit.launch.parameters import value_of
from course_kit.launch.substitutions import Text, as_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from course_kit.launch.conditions import Condition
    from course_kit.launch.context import LaunchContext


class GroupAction(Action):
    """Actions with a scope of their own."""

    def __init__(
        self,
        actions: Iterable[object],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Text, Text] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.actions, self._scoped, self._forwarding = list(actions), scoped, forwarding
        self._values = dict(launch_configurations or {})

    def execute(self, context: LaunchContext) -> None:
        """Run the actions."""
        values = {as_text(name, context): as_text(value, context) for name, value in self._values.items()}
        inner = context.scoped(forwarding=self._forwarding) if self._scoped else context
        inner.launch_configurations |= values
        execute_all(self.actions, inner)

    def sub_entities(self) -> Iterable[object]:
        """The actions."""
        return self.actions


class SetLaunchConfiguration(Action):
    """A value for LaunchConfiguration."""

    def __init__(self, name: Text, value: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.launch_configurations[as_text(self._name, context)] = as_text(self._value, context)


class UnsetLaunchConfiguration(Action):
    """Takes the value away."""

    def __init__(self, name: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name = name

    def execute(self, context: LaunchContext) -> None:
        """Unset it."""
        context.launch_configurations.pop(as_text(self._name, context), None)


class SetEnvironmentVariable(Action):
    """An environment variable for the processes after it."""

    def __init__(self, name: Text, value: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.environment[as_text(self._name, context)] = as_text(self._value, context)


class UnsetEnvironmentVariable(Action):
    """Takes a variable away from the processes after it."""

    def __init__(self, name: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name = name

    def execute(self, context: LaunchContext) -> None:
        """Unset it."""
        context.environment.pop(as_text(self._name, context), None)


class AppendEnvironmentVariable(Action):
    """A value at the end of an environment variable, such as a path."""

    def __init__(
        self,
        name: Text,
        value: Text,
        prepend: bool | Text = False,
        separator: Text | None = None,
        *,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._name, self._value, self._prepend, self._separator = name, value, prepend, separator

    def execute(self, context: LaunchContext) -> None:
        """Add it."""
        name, value = as_text(self._name, context), as_text(self._value, context)
        separator = ":" if self._separator is None else as_text(self._separator, context)
        parts = [part for part in (context.environment.get(name), value) if part]
        if as_text(self._prepend, context).lower() in {"true", "1"}:
            parts.reverse()
        context.environment[name] = separator.join(parts)


class PushROSNamespace(Action):
    """A namespace for the nodes after it, within the one there is."""

    def __init__(self, namespace: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._namespace = namespace

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.namespace = joined_namespace(context.namespace, as_text(self._namespace, context))


class SetParameter(Action):
    """A parameter for all nodes after it."""

    def __init__(self, name: Text, value: object, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        name = as_text(self._name, context)
        context.parameters[name] = value_of(name, self._value, context)


class SetRemap(Action):
    """A remapping for all nodes after it."""

    def __init__(self, src: Text, dst: Text, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._names = (src, dst)

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        old, new = (as_text(name, context) for name in self._names)
        context.remappings.append((old, new))
