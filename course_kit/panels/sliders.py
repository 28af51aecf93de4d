"""Sliders, boxes and texts for the parameters of a node, made from what the node itself says about them."""

from __future__ import annotations

import math
import threading
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets
import yaml

from course_kit import lab
from course_kit.interfaces.definition import FieldType
from course_kit.lab.errors import LabError
from course_kit.lab.parameters import full_name
from course_kit.lab.topics import Subscription
from course_kit.panels.base import LatestValue, Panel, draw, of_files, still
from course_kit.ros.filling import fit_value
from course_kit.ros.messages import BadFieldError
from course_kit.ros.parameters import from_message, is_of_every_node

if TYPE_CHECKING:
    from rclpy.node import Node

    from course_kit.lab.parameters import Descriptor, Range
    from course_kit.ros.messages import Message

_STEPS = 100  # about, of a slider whose parameter has no step
_READ_ONLY = "read-only: it keeps the value it got at the start"
_KINDS = {"bool": "flag", "integer": "number", "double": "number", "string": "text"}
_EXAMPLES = {
    "integer": "a whole number such as 3",
    "double": "a number such as 1.5",
    "byte_array": "a list such as [0, 255]",
    "bool_array": "a list such as [true, false]",
    "integer_array": "a list such as [1, 2]",
    "double_array": "a list such as [1.0, 2.5]",
    "string_array": "a list such as [left, right]",
}
_FIELD_TYPES = {"bool": "boolean", "byte": "uint8", "integer": "int64"}  # as messages call them; others as here


def entry(descriptor: Descriptor) -> dict[str, object]:
    """What the page has to know to draw a parameter."""
    kind = _KINDS.get(descriptor.type, "text")
    limits = descriptor.range
    drawn: dict[str, object] = {
        "name": descriptor.name,
        "type": descriptor.type.replace("_", " "),
        "kind": kind,
        "description": " ".join(text for text in (descriptor.description, descriptor.constraints) if text),
        "limits": str(limits) if limits else "",
        "note": _READ_ONLY if descriptor.read_only else "",
    }
    if limits and kind == "number" and limits.lowest < limits.highest:
        drawn |= {"kind": "slider", "lowest": limits.lowest, "highest": limits.highest}
        drawn["step"] = slider_step(limits, whole=descriptor.type == "integer")
    return drawn


def slider_step(limits: Range, *, whole: bool) -> float:
    """The step of a slider: the node's own, else a round one that leads to the upper limit."""
    width = limits.highest - limits.lowest
    if limits.step:
        return limits.step
    exact = width / _STEPS
    power = 10.0 ** math.floor(math.log10(exact))
    step = next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= exact * (1 + 1e-9))
    if whole:
        return max(1, round(step))
    count = width / step
    return float(f"{step:.6g}") if math.isclose(count, round(count), rel_tol=1e-6) else exact


def format_value(value: Any) -> Any:
    """A value as the page holds it: text, so that no digit is lost; a bool as it is."""
    if isinstance(value, bool):
        return value
    if value is None:
        return ""
    if isinstance(value, list):
        return "[" + ", ".join(_element(item) for item in value) + "]"
    return value if isinstance(value, str) else repr(value)


def convert_typed(kind: str, text: Any) -> Any:
    """The value of what the page sent."""
    if kind in {"bool", "string"}:
        return text
    element, array, _ = kind.partition("_array")
    field_type = FieldType(_FIELD_TYPES.get(element, element), "sequence" if array else "")
    try:
        if not array and kind in _EXAMPLES:
            return fit_value(text, field_type, kind)
        value = yaml.safe_load(text)
        if not array:  # a parameter whose type may change
            return value
        fitted = fit_value(value, field_type, kind)
    except (yaml.YAMLError, BadFieldError):
        raise BadFieldError(f"{text!r} is not {_EXAMPLES.get(kind, 'a value')}.") from None
    return [bytes([number]) for number in fitted] if element == "byte" else fitted


def _element(value: object) -> str:
    if isinstance(value, bytes):
        return str(value[0])
    return str(value).lower() if isinstance(value, bool) else repr(value)


_EVENTS = "/parameter_events"
_ENDED = "These sliders have ended. Run their cell again to use them."


class SlidersWidget(anywidget.AnyWidget):
    """The parameters as the page has them."""

    _esm = of_files("dom.js", "sliders.js")
    _css = of_files("frame.css", "sliders.css")
    node = traitlets.Unicode().tag(sync=True)
    entries: traitlets.List[dict[str, object]] = traitlets.List().tag(sync=True)
    values = traitlets.Dict().tag(sync=True)
    outcomes = traitlets.Dict().tag(sync=True)
    ended = traitlets.Unicode().tag(sync=True)


class ParameterSliders(Panel):
    """One widget for each parameter the author of a node has declared."""

    def __init__(self, node: str | Node) -> None:
        self.node = full_name(node)
        descriptors, values = self._ask()
        super().__init__(self.node)
        self._lock = threading.RLock()  # the lab's thread, the page's and the one that shows meet here
        self._descriptors, self._values = descriptors, values
        self._outcomes: dict[str, dict[str, object]] = {}
        self._heard: dict[str, int] = {}  # how often a change was heard of, by name
        self._outdated = False
        self.widget = SlidersWidget(node=self.node)
        self.widget.on_msg(self._handle_message)
        self.at_close(lambda: self.widget.set_trait("ended", _ENDED))
        self._updates = LatestValue(self._update)
        self.at_close(self._updates.close)
        self._listen()
        self._values = self._ask()[1]  # once more: something may have changed before we listened
        self._show()

    @property
    def values(self) -> dict[str, Any]:
        """The node's values, as far as they are known here."""
        with self._lock:
            return dict(self._values)

    def describe(self) -> str:
        """The parameters, their values and what is allowed."""
        lines = [f"Sliders and boxes that set the parameters of {self.node}:"]
        for name, value in self.values.items():
            facts = repr(self._descriptors[name]).splitlines()[0].partition(": ")[2]
            lines.append(f"  {name} = {value!r} ({facts})")
        return "\n".join(lines)

    def still(self) -> str:
        """The sliders and boxes with the node's values."""
        rows = [_row(field, self.widget.values[field["name"]]) for field in self.widget.entries]
        return still(self.describe(), draw("still_sliders.html", node=self.node, rows=rows), "still_panels.css")

    def set(self, name: str, text: str | bool, token: int = 0) -> bool:
        """Set a parameter to what was typed, as the page does."""
        with self._lock:
            heard, kind = self._heard.get(name, 0), self._descriptors[name].type
        state = "refused"
        try:
            value = convert_typed(kind, text)
            outcome = lab.set_parameters_blocking(self.node, {name: value})
            reason = outcome.reasons.get(name, "")
        except BadFieldError as error:
            reason = str(error)
        except LabError as error:  # nobody has answered
            reason, state = str(error), "failed"
        with self._lock:
            if not reason and self._heard.get(name, 0) == heard:  # otherwise the node has sent its value already
                self._values[name] = value
            self._outcomes[name] = {"state": state if reason else "set", "text": reason, "token": token}
        self._show()
        return not reason

    def _listen(self) -> None:
        from rcl_interfaces.msg import ParameterEvent
        from rclpy.qos import qos_profile_parameter_events

        subscription = Subscription(
            lab.current().engine, _EVENTS, ParameterEvent, self._take_event, qos=qos_profile_parameter_events
        )
        self.at_close(subscription.close)

    def _take_event(self, event: Message) -> None:
        """A parameter of some node has changed; on the lab's thread."""
        if event.node != self.node:
            return
        with self._lock:
            self._outdated |= bool(event.new_parameters or event.deleted_parameters)
            for parameter in event.changed_parameters:
                name, value = parameter.name, from_message(parameter.value)
                self._heard[name] = self._heard.get(name, 0) + 1
                if name in self._values and self._values[name] != value:
                    self._values[name] = value
                    token = self._outcomes.get(name, {}).get("token", 0)
                    self._outcomes[name] = {"state": "elsewhere", "text": "", "token": token}
        self._updates.put(None)

    def _update(self, _: None) -> None:
        with self._lock:
            outdated, self._outdated = self._outdated, False
        if outdated:  # the node was started again, or has declared one more
            try:
                descriptors, values = self._ask()
            except LabError:  # it has gone; setting something says so
                return
            with self._lock:
                self._descriptors, self._values, self._outcomes = descriptors, values, {}
        self._show()

    def _ask(self) -> tuple[dict[str, Descriptor], dict[str, Any]]:
        """What the node says about its own parameters, and their values."""
        described = lab.describe_parameters_blocking(self.node)
        own = {parameter.name: parameter for parameter in described if not is_of_every_node(parameter.name)}
        return own, dict(lab.get_parameters_blocking(self.node, *own)) if own else {}

    def _handle_message(self, _: object, content: dict[str, Any], buffers: object) -> None:
        """Somebody has moved or typed something on the page."""
        del buffers
        if not self.widget.ended and content.get("name") in self._descriptors:
            self.set(content["name"], content.get("value", ""), content.get("token", 0))

    def _show(self) -> None:
        # The lock is held while it is sent, so that an older state never comes after a newer one.
        with self._lock, self.widget.hold_sync():
            self.widget.entries = [entry(self._descriptors[name]) for name in self._values]
            self.widget.values = {name: format_value(value) for name, value in self._values.items()}
            self.widget.outcomes = dict(self._outcomes)


def _row(entry: dict[str, Any], value: Any) -> dict[str, Any]:
    """A parameter as the still picture has it; `share` is where the knob of a slider 200 wide stands."""
    facts = [", ".join(text for text in (entry["type"], entry["limits"]) if text), entry["description"], entry["note"]]
    row = {"name": entry["name"], "kind": entry["kind"], "value": value, "share": None}
    if entry["kind"] == "slider":
        share = (float(value) - entry["lowest"]) / (entry["highest"] - entry["lowest"])
        row["share"] = round(8 + 184 * min(max(share, 0.0), 1.0))
    return {**row, "facts": " · ".join(text for text in facts if text)}
