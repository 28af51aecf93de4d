"""The work that all contestants of `class.py` do for a submission: exercise 1's checks, made as simple as they can be.

A notebook's test cell and a fork both call `points` with the class that was handed in: its node is served on a thread
of its own, and asked what our grader asks it, with the same tolerances and patience. So what is compared is what stands
around the checks. Ours does more in the same time: it runs the node in a process isolated, and says what went wrong.

`python class_work.py FILE...` imports everything once and forks for each: the lower bound. It prints a score for each.
"""

from __future__ import annotations

import math
import os
import random
import runpy
import signal
import sys
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from course_kit.graders.temperature_service import ABSOLUTE_ZERO, CELSIUS, FAHRENHEIT, UNITS, Sample, has_right_formula

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

LIMIT_S = 6  # for a program that does not end; ours gives it 5 s to start
ANSWER_S = 5.0  # for one answer, as ours
CLIENTS = 10
CALLS = 50
CLASS_NAME = "TemperatureService"


class SilentError(Exception):
    """No answer came."""


class Asked:
    """The node that was handed in, served on a thread of its own beside a node with ten clients."""

    def __init__(self, node_class: Callable[[], Any]) -> None:
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(node_class())
        self.node = rclpy.create_node("asker")
        self._executor.add_node(self.node)
        self._clients = [self.node.create_client(ConvertTemperature, "/convert_temperature") for _ in range(CLIENTS)]
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(Exception):  # the callback's, or that of the executor's end
            self._executor.spin()

    def wait_for_service(self) -> None:
        """Until all clients have found it."""
        if not all(client.wait_for_service(ANSWER_S) for client in self._clients):
            raise SilentError

    def ask_all(self, samples: Sequence[Sample]) -> list[Any]:
        """Responses to all, ten on their way at a time."""
        answers: list[Any] = []
        for start in range(0, len(samples), CLIENTS):
            done = threading.Semaphore(0)
            futures = []
            for client, one in zip(self._clients, samples[start : start + CLIENTS], strict=False):
                request = ConvertTemperature.Request(value=one.value, from_unit=one.from_unit, to_unit=one.to_unit)
                futures.append(client.call_async(request))
                futures[-1].add_done_callback(lambda _, done=done: done.release())
            if not all(done.acquire(timeout=ANSWER_S) for _ in futures):
                raise SilentError
            answers += [future.result() for future in futures]
        return answers

    def converts(self, *samples: Sample) -> bool:
        """Whether each is converted rightly."""
        answers = zip(samples, self.ask_all(samples), strict=True)
        return all(answer.success and has_right_formula(sample, answer.value) for sample, answer in answers)

    def refuses(self, *samples: Sample) -> bool:
        """Whether each is refused with a reason."""
        return all(not answer.success and answer.message.strip() for answer in self.ask_all(samples))

    def stop(self) -> None:
        """End the thread, if the callback lets it."""
        self._executor.shutdown(timeout_sec=1.0)
        self._thread.join(1.0)
        self.node.destroy_node()


def points(node_class: Callable[[], Any]) -> float:
    """The score of a class, 0 to 10."""
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    asked, score = None, 0.0
    try:
        asked = Asked(node_class)
        asked.wait_for_service()
        score += 2.0
        for worth, check in _checks(asked):
            score += worth * check()
    except SilentError:
        pass
    finally:
        if asked is not None:
            asked.stop()
        rclpy.try_shutdown()
    return score


def _checks(asked: Asked) -> list[tuple[float, Callable[[], bool]]]:
    def between(from_unit: str, to_unit: str, *fixed: float) -> list[Sample]:
        drawn = [round(random.uniform(-200.0, 500.0), 3) for _ in range(3)]  # noqa: S311 - no secret
        return [Sample(value, from_unit, to_unit) for value in (*fixed, *drawn)]

    odd = [("kelvin", CELSIUS), (CELSIUS, "kelvin"), ("furlong", "furlong"), ("", FAHRENHEIT)]
    cold = [Sample(ABSOLUTE_ZERO[unit] - by, unit, to) for unit in UNITS for to in UNITS for by in (0.01, 500.0)]
    no_numbers = [Sample(value, CELSIUS, FAHRENHEIT) for value in (math.nan, math.inf, -math.inf)]
    many = [Sample(7.25 * number, *((CELSIUS, FAHRENHEIT)[:: 1 - number % 2 * 2])) for number in range(CALLS)]
    return [
        (1.5, lambda: asked.converts(*between(CELSIUS, FAHRENHEIT, 0.0, 37.0, -40.0, 1e-3, 1234567.891))),
        (1.5, lambda: asked.converts(*between(FAHRENHEIT, CELSIUS, 212.0, 98.6, -40.0, 1e-3, 1234567.891))),
        (0.5, lambda: asked.converts(*between(FAHRENHEIT, FAHRENHEIT, 0.0), *between(CELSIUS, CELSIUS, 0.0))),
        (1.0, lambda: asked.refuses(*(Sample(20.0, *pair) for pair in odd))),
        (1.0, lambda: asked.refuses(*no_numbers, Sample(math.nan, FAHRENHEIT, CELSIUS))),
        (1.0, lambda: asked.refuses(*cold)),
        (1.5, lambda: asked.converts(*many)),
    ]


def grade_file(path: str) -> float:
    """The score of a program; 0 when it does not get to its class."""
    try:
        return points(runpy.run_path(path, run_name="submission")[CLASS_NAME])
    except (Exception, SystemExit):  # noqa: BLE001 - whatever a submission raises
        return 0.0


def fork_for(path: str) -> None:
    """Grade in a fork, which prints the score and ends, whatever threads the submission has left."""
    child = os.fork()
    if child == 0:
        signal.alarm(LIMIT_S)  # ends the process
        print(grade_file(path), flush=True)
        os._exit(0)
    os.waitpid(child, 0)


if __name__ == "__main__":
    ConvertTemperature.__class__.__import_type_support__()
    for one in sys.argv[1:]:
        fork_for(one)
