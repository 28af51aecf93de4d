"""The work that all contestants of `class.py` do for a submission: exercise 1's checks, made as simple as they can be.

A notebook's test cell, an Otter test and a fork all call `points` with the class that was handed in:
its node is served on a thread of its own, and asked what our grader asks it, with the same tolerances and patience.
So what is compared is what stands around the checks. Ours does more in the same time: it runs the node in a process
isolated, and says what went wrong.

`python class_work.py FILE...` imports everything once and forks for each, without isolation: the lower bound. A score
is printed for each file.
"""

from __future__ import annotations

import math
import os
import random
import runpy
import signal
import sys
import threading
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from course_kit.graders.temperature_service import ABSOLUTE_ZERO, CELSIUS, FAHRENHEIT, UNITS, Sample, fits

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

LIMIT_S = 6  # for a program that does not end; ours gives it 5 s to start
ANSWER_S = 5.0  # for one answer, as ours
CLIENTS = UNANSWERED = 10
CALLS = 50
CLASS_NAME = "TemperatureService"


class SilentError(Exception):
    """No answer came."""


class Server:
    """The node that was handed in, served on a thread."""

    def __init__(self, node_class: Callable[[], Any]) -> None:
        self.node = node_class()
        self.ended = threading.Event()
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(Exception):  # the callback's, or that of the executor's end
            self._executor.spin()
        self.ended.set()

    def stop(self) -> None:
        """End the thread, if the callback lets it."""
        self._executor.shutdown(timeout_sec=1.0)
        self._thread.join(1.0)


class Asker:
    """The grader's side: a node of its own with ten clients."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self.node = rclpy.create_node("asker")
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._clients = [self.node.create_client(ConvertTemperature, "/convert_temperature") for _ in range(CLIENTS)]

    def until(self, done: Callable[[], bool]) -> None:
        """Spin until it is done, or nothing will come any more."""
        deadline = time.monotonic() + ANSWER_S
        while not done():
            if time.monotonic() > deadline or self._server.ended.is_set():
                raise SilentError
            self._executor.spin_once(timeout_sec=0.02)

    def wait_for_service(self) -> None:
        """Until all clients have found it."""
        self.until(lambda: all(client.service_is_ready() for client in self._clients))

    def ask_all(self, samples: Sequence[Sample]) -> list[Any]:
        """Responses to all, ten on their way at a time."""
        futures: list[Any] = []
        for number, sample in enumerate(samples):
            request = ConvertTemperature.Request(value=sample.value, from_unit=sample.from_unit, to_unit=sample.to_unit)
            self.until(lambda: sum(not future.done() for future in futures) < UNANSWERED)
            futures.append(self._clients[number % CLIENTS].call_async(request))
        self.until(lambda: all(future.done() for future in futures))
        return [future.result() for future in futures]

    def converts(self, *samples: Sample) -> bool:
        """Whether each is converted rightly, asked one after the other."""
        answers = [(sample, self.ask_all([sample])[0]) for sample in samples]
        return all(answer.success and fits(sample, answer.value) for sample, answer in answers)

    def refuses(self, *samples: Sample) -> bool:
        """Whether each is refused with a reason."""
        answers = [self.ask_all([sample])[0] for sample in samples]
        return all(not answer.success and answer.message.strip() for answer in answers)


def points(node_class: Callable[[], Any]) -> float:
    """The score of a class, 0 to 10."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    server = asker = None
    try:
        server = Server(node_class)
        asker = Asker(server)
        return _score(asker)
    finally:
        if server is not None:
            server.stop()
        if asker is not None:
            asker.node.destroy_node()
        rclpy.try_shutdown()


def _score(asker: Asker) -> float:
    """Points of the checks that pass, with the order and the points of our grader."""
    try:
        asker.wait_for_service()
    except SilentError:
        return 0.0
    score = 0.5
    offered = [name for name, _ in asker.node.get_service_names_and_types_by_node("temperature_service", "/")]
    score += 0.5 * ("/convert_temperature" in offered)
    try:
        if not asker.ask_all([Sample(100.0, CELSIUS, FAHRENHEIT)])[0].success:
            return score
        score += 1.0
        for worth, check in _checks(asker):
            score += worth * check()
    except SilentError:
        pass
    return score


def _checks(asker: Asker) -> list[tuple[float, Callable[[], bool]]]:
    def between(from_unit: str, to_unit: str, *fixed: float) -> list[Sample]:
        drawn = [round(random.uniform(-200.0, 500.0), 3) for _ in range(3)]  # noqa: S311 - no secret
        return [Sample(value, from_unit, to_unit) for value in (*fixed, *drawn)]

    small = (1e-3, 1234567.891, 0.25)
    odd = [("kelvin", CELSIUS), (CELSIUS, "kelvin"), ("furlong", "furlong"), ("", FAHRENHEIT)]
    many = [Sample(7.25 * number, *((CELSIUS, FAHRENHEIT)[:: 1 - number % 2 * 2])) for number in range(CALLS)]
    cold = [Sample(ABSOLUTE_ZERO[unit] - by, unit, to) for unit in UNITS for to in UNITS for by in (0.01, 500.0)]
    no_numbers = [Sample(value, CELSIUS, FAHRENHEIT) for value in (math.nan, math.inf, -math.inf)]

    def all_at_once() -> bool:
        return all(
            answer.success and fits(sample, answer.value)
            for sample, answer in zip(many, asker.ask_all(many), strict=True)
        )

    return [
        (1.0, lambda: asker.converts(*between(CELSIUS, FAHRENHEIT, 0.0, 37.0, -40.0))),
        (1.0, lambda: asker.converts(*between(FAHRENHEIT, CELSIUS, 212.0, 98.6, -40.0))),
        (0.5, lambda: asker.converts(*between(FAHRENHEIT, FAHRENHEIT, 0.0), *between(CELSIUS, CELSIUS, 0.0))),
        (
            1.0,
            lambda: asker.converts(
                *(Sample(value, CELSIUS, FAHRENHEIT) for value in (*small, ABSOLUTE_ZERO[CELSIUS] + 0.01)),
                *(Sample(value, FAHRENHEIT, CELSIUS) for value in (*small, ABSOLUTE_ZERO[FAHRENHEIT] + 0.01)),
            ),
        ),
        (1.0, lambda: asker.refuses(*(Sample(20.0, *pair) for pair in odd))),
        (1.0, lambda: asker.refuses(*no_numbers, Sample(math.nan, FAHRENHEIT, CELSIUS))),
        (1.0, lambda: asker.refuses(*cold)),
        (1.5, all_at_once),
    ]


def grade_file(path: str) -> float:
    """The score of a program; 0 when it does not get to its class."""
    try:
        return points(runpy.run_path(path, run_name="submission")[CLASS_NAME])
    except (Exception, SystemExit):  # noqa: BLE001 - whatever a submission raises
        return 0.0


def _end(path: str) -> None:
    """Grade, print the score, and end this process, whatever threads the submission has left."""
    signal.alarm(LIMIT_S)  # ends the process
    print(grade_file(path), flush=True)
    os._exit(0)


def _fork(path: str) -> None:
    child = os.fork()
    if child == 0:
        _end(path)
    os.waitpid(child, 0)


if __name__ == "__main__":
    ConvertTemperature.__class__.__import_type_support__()
    for one in sys.argv[1:]:
        _fork(one)
