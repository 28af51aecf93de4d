"""Uses the lab where a name of the table is missing: reads names, one a line, and answers each with a line of JSON.

Everything is imported once; each name is taken away in a process of its own, forked from there.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import sys
import traceback
from typing import Any

from course_kit import environment
from tests.ros.renaming import take_away


def main() -> None:
    import rclpy.action
    from IPython.core import compilerop
    from nbval import plugin

    import course_kit.lab.runtime.engine
    from course_kit.cli import doctor

    del rclpy, compilerop, plugin, course_kit, doctor
    for line in sys.stdin:
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.write(writing, json.dumps(_outcome(line.strip())).encode())
            sys.stdout.flush()
            os._exit(0)
        os.close(writing)
        with os.fdopen(reading) as told:
            sys.stdout.write(told.read() + "\n")
            sys.stdout.flush()
        os.waitpid(child, 0)


def _outcome(path: str) -> dict[str, Any]:
    from course_kit.cli import doctor

    said = io.StringIO()
    outcome: dict[str, Any] = {"problem": ""}
    try:
        with environment.exclusive_domain() as domain:
            os.environ["ROS_DOMAIN_ID"] = str(domain)
            if path:
                take_away(path)
            outcome["doctor"] = doctor.rclpy_names().found
            with contextlib.redirect_stderr(said):
                outcome |= _use_the_lab()
    except BaseException:  # noqa: BLE001 - whatever it is, the test shows it
        outcome["problem"] = traceback.format_exc()
    return {**outcome, "said": said.getvalue()}


def _use_the_lab() -> dict[str, Any]:
    from example_interfaces.action import Fibonacci
    from example_interfaces.srv import AddTwoInts
    from std_msgs.msg import String

    from course_kit import lab
    from tests.ros.nodes import Everything

    lab.record()
    node = lab.start(Everything)
    sums = [lab.call_blocking("/add_two_ints", AddTwoInts, a=2, b=3).sum for _ in range(2)]
    goal = lab.send_goal_blocking("/fibonacci", Fibonacci, order=4)
    sequence = list(goal.result_blocking().sequence)
    lab.publish("/words", String, data="hello")
    node.heard.wait(5)
    diagram = str(lab.diagram())
    lab.start(Everything)
    again = lab.call_blocking("/add_two_ints", AddTwoInts, a=2, b=3).sum
    lab.current().close()
    return {"sums": [*sums, again], "sequence": sequence, "words": node.words, "diagram": diagram}


if __name__ == "__main__":
    main()
