"""A form generated from a service type, that calls the real service."""

from __future__ import annotations

import io
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from course_kit import lab
from course_kit.interfaces.comments import comments_of
from course_kit.lab.errors import FieldError, LabError
from course_kit.panels.base import Panel, form, of_files, still
from course_kit.panels.message_form import FormError, MessageForm, Values, fields_in_words
from course_kit.ros.messages import type_name
from course_kit.ros.showing import Plain, copy_message, describe_element

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros.messages import Message, ServiceType


class FormWidget(anywidget.AnyWidget):
    """The form as the page has it."""

    _esm = of_files("dom.js", "message_form.js", "form_view.js")
    _css = of_files("frame.css", "panels.css")
    title = traitlets.Dict().tag(sync=True)
    entries: traitlets.List[dict[str, object]] = traitlets.List().tag(sync=True)
    values = traitlets.Dict().tag(sync=True)
    outcome = traitlets.Dict().tag(sync=True)
    ended = traitlets.Unicode().tag(sync=True)


class ServiceForm(Panel):
    """A form for one service."""

    def __init__(self, service: str, service_type: ServiceType, timeout: float) -> None:
        if not isinstance(service, str) or not hasattr(service_type, "Request"):
            raise FieldError(
                'A form needs a name and a service type: panels.service_form("/add_two_ints", AddTwoInts).'
            )
        super().__init__(service)
        self.service, self.service_type, self.timeout = service, service_type, timeout
        self._form = MessageForm(service_type.Request)
        self.widget = FormWidget(
            title={"name": service, "type": type_name(service_type)},
            entries=self._form.entries(),
            values=self._form.defaults(),
            outcome={"state": "new"},
        )
        self.widget.on_msg(self._handle_message)
        self.at_close(lambda: self.widget.set_trait("ended", "This form has ended. Run its cell again to use it."))

    def describe(self) -> str:
        """What can be asked and what comes back."""
        return (
            f"A form that calls {self.service} [{type_name(self.service_type)}].\n"
            f"Request: {fields_in_words(self.service_type.Request)}.\n"
            f"Response: {fields_in_words(self.service_type.Response)}."
        )

    def still(self) -> str:
        """The form with what is in its fields, and what came last."""
        outcome = self.widget.outcome
        lines = [f"{name}: {value}" for name, value in outcome.get("rows", ())] or [outcome.get("text", "")]
        picture = form(self.widget, "Request", "Send request", said=lines)
        return still(self.describe(), picture, "still_panels.css")

    def fill(self, values: Values) -> None:
        """Type into fields, by path, such as {"target.x": "1.5"}; the others stay."""
        self.widget.values = {**self.widget.values, **values}

    def send(self) -> Message:
        """Send what the fields hold, as the button does."""
        self._show("waiting", "")  # first of all: the page waits for the next outcome, whatever it is
        try:
            request = self._form.read(self.widget.values)
        except FormError as error:
            self._show("invalid", str(error), errors=error.fields)
            return None
        with _catch_prints() as printed:
            outcome, response = self._call(request)
        self.widget.outcome = {**outcome, "printed": printed.getvalue().rstrip()}
        return response

    def _call(self, request: Message) -> tuple[dict[str, object], Message]:
        """What to show of a call, and the response if there is one."""
        try:
            response = lab.call_blocking(self.service, self.service_type, request, timeout=self.timeout)
        except LabError as error:
            return {"state": "failed", "text": f"{type(error).__name__}: {error}"}, None
        except BaseException:
            self._show("failed", "The call was interrupted.")
            raise
        rows = field_rows(copy_message(response))
        text = "" if rows else "The response has no fields; it only says that the server is done."
        return {"state": "answered", "text": text, "rows": rows, "comments": comments_of(type(response))}, response

    def _handle_message(self, _: object, content: dict[str, Any], buffers: object) -> None:
        """The page wants something done."""
        del buffers
        if self.widget.ended:
            return
        self.fill(content.get("values", {}))
        if content.get("do") == "send":
            self.send()

    def _show(self, state: str, text: str, **more: object) -> None:
        self.widget.outcome = {"state": state, "text": text, **more}


def field_rows(value: Plain, path: str = "") -> list[list[str]]:
    """Path and value of each field of a copied message, messages inside it taken apart."""
    if not isinstance(value, dict):
        return [[path, describe_element(value)]]
    return [row for name, part in value.items() for row in field_rows(part, f"{path}.{name}" if path else name)]


@contextmanager
def _catch_prints() -> Iterator[io.StringIO]:
    """What nodes print and log meanwhile: outside of a cell there is no place where a notebook would show it."""
    output = io.StringIO()
    with redirect_stdout(output), redirect_stderr(output):
        yield output
        lab.current().output.drain()
