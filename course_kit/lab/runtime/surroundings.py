"""What surrounds a notebook's nodes: other notebooks, and whoever offers what this one's nodes offer, too.

Two servers of one name both answer every request, and a server left in another notebook answers where this one's has
been forgotten. Both look like success, so the learner is told.
"""

from __future__ import annotations

import contextlib
import threading
from typing import TYPE_CHECKING

from course_kit.lab.runtime.describe import actions_of
from course_kit.lab.runtime.neighbours import Neighbours
from course_kit.ros import graph
from course_kit.ros.names import is_of_every_node, short_name

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from course_kit.lab.runtime.engine import Engine
    from course_kit.lab.runtime.nodes import LiveNode

_PAUSE = 0.1  # seconds between two looks. What follows counts looks: a machine that sleeps or is busy takes none
_LOOKING = 60  # another program is found within ten of them, unless the machine is busy
_UNANNOUNCED = 40  # a program that was killed stays visible for 2 s
_ANNOUNCED_LATE = 150  # in which a notebook tells of a node that is its own, on a machine that is very busy
_ENDING = 6.0  # seconds for a look to end
_GOALS = "/_action/send_goal"


class Surroundings:
    """Tells other notebooks of this one's nodes, and the learner of theirs."""

    def __init__(self, lab: Engine, title: str) -> None:
        self.on_stop_asked: Callable[[str], None] = lambda _: None
        self.script_nodes: Callable[[], dict[str, str]] = dict
        self.neighbours = Neighbours(lab.node, title, self._asked_to_stop)
        self._lab = lab
        self._told: set[tuple[str, str]] = set()
        self._seen: dict[tuple[str, str], int] = {}  # in how many looks
        self._left = 0  # looks
        self._news = threading.Event()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    def announce(self) -> None:
        """Tell other notebooks which nodes this one has."""
        self.neighbours.announce([*(live.name for live in self._lab.nodes), *self.script_nodes()])

    def tell_who_answers(self, role: graph.Role, name: str) -> None:
        """Say so where another notebook's node answers, in place of one that this notebook has forgotten to start."""
        if who := self.neighbours.answering(role, name):
            self._lab.note(
                f"{name} is answered by {who}, not by a node of this notebook. "
                "lab.stop_others() stops what other notebooks run."
            )

    def node_started(self) -> None:
        """A node was started: tell others, and look now, and for some seconds, who offers the same."""
        self.announce()
        self._told.clear()
        self._seen.clear()
        self._left = _LOOKING
        self._look()
        self._news.set()
        if self._thread is None:
            self._thread = threading.Thread(target=self._watch, name="lab-surroundings", daemon=True)
            self._thread.start()

    def close(self) -> None:
        """Look no more."""
        self._ended.set()
        self._news.set()
        if self._thread is not None:
            self._thread.join(_ENDING)

    def _asked_to_stop(self, by: str) -> None:
        self.on_stop_asked(by)

    def _watch(self) -> None:
        while not self._ended.is_set():
            self._news.wait()
            self._news.clear()
            while self._left > 0 and not self._ended.wait(_PAUSE):
                self._left -= 1
                with contextlib.suppress(Exception):  # a node that is destroyed at this very moment
                    self._look()

    def _look(self) -> None:
        for name, role in list(self._doubled()):
            for node in self._offering(name, role):
                self._tell_once(node, f"{name} is also offered by {{}}: both answer every request.")
        running = graph.nodes(self._lab.node)
        for name in {live.name for live in self._lab.nodes}:
            if running.count(name) > 1:
                self._tell_once(name, f"Two nodes have the name {short_name(name)}. The other one is {{}}.")

    def _tell_once(self, node: str, sentence: str) -> None:
        """Say it with whose node it is; what nobody has announced may do so by and by, or have been killed just now."""
        key = (node, sentence)
        self._seen[key] = looks = self._seen.get(key, 0) + 1
        whose = self._whose(node)
        if key in self._told or (not whose and self._may_be_announced(node, looks)):
            return
        self._told.add(key)
        who, remedy = whose or (f"{short_name(node)} in another program", "")
        self._lab.note(f"{sentence.format(who)} {remedy}".rstrip())

    def _may_be_announced(self, node: str, looks: int) -> bool:
        """Whether some notebook may still tell that a node, seen so often, is its own; it is looked at once more."""
        if looks > (_ANNOUNCED_LATE if self.neighbours.may_announce(node) else _UNANNOUNCED):
            return False
        self._left = max(self._left, 2)
        return True

    def _doubled(self) -> Iterable[tuple[str, graph.Role]]:
        """What this lab's nodes offer and somebody else as well."""
        own: dict[tuple[str, graph.Role], int] = {}
        for live in self._lab.nodes:
            for name, role in _offered_by(live):
                own[name, role] = own.get((name, role), 0) + 1
        for (name, role), count in own.items():
            if self._lab.node.count_services(name if role == graph.SERVES else f"{name}{_GOALS}") > count:
                yield name, role

    def _offering(self, name: str, role: graph.Role) -> list[str]:
        own = {live.name for live in self._lab.nodes} | self._lab.own_names
        names = set(graph.nodes(self._lab.node)) - own
        return [
            one for one in sorted(names) if any(use.channel == name for use in graph.uses_of(self._lab.node, one, role))
        ] or sorted(own & {node for other in self.neighbours.others() for node in other.nodes})

    def _whose(self, node: str) -> tuple[str, str] | None:
        """Whose node it is, and what stops it; None where nobody has announced it."""
        shown = short_name(node)
        if script := self.script_nodes().get(node):
            return f"{shown} of your script {script}", f"%ros_stop {script} stops it."
        for other in self.neighbours.others():
            if node in other.nodes:
                return f"{shown} of {other.title}", "lab.stop_others() stops what other notebooks run."
        return None


def _offered_by(live: LiveNode) -> Iterable[tuple[str, graph.Role]]:
    for node in (live.node, *live.helpers):
        for service in node.services:
            if not is_of_every_node(service.service_name):
                yield service.service_name, graph.SERVES
        for action in actions_of(node):
            yield action, graph.RUNS
