"""The lab: live nodes behind a notebook or a program, and the verbs for them."""

from __future__ import annotations

import atexit
import os
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.lab.errors import LabError
from course_kit.lab.notebook.cells import Notebook
from course_kit.lab.notebook.output import Output
from course_kit.lab.recording.events import EventStream, Recording
from course_kit.ros import graph

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable

    from course_kit.lab.runtime.engine import Engine
    from course_kit.lab.runtime.neighbours import Neighbours
    from course_kit.lab.runtime.nodes import LiveNode
    from course_kit.lab.scripts.running import Scripts
    from course_kit.lab.topics import Subscription

_SETTLING = 3.0  # seconds; a killed participant's lease lasts 2
_POLL = 0.01


class Lab:
    """What the verbs of one process work on: its nodes, scripts, panels and recording."""

    def __init__(self) -> None:
        self.events = EventStream()
        self.output = Output()
        self.notebook = Notebook(self.output)
        self.notebook.nodes_run = lambda: bool(self.live_nodes())
        self.notebook.on_end = self._end_strays
        self._engine: Engine | None = None
        self._neighbours: Neighbours  # made with the engine
        self._scripts: Scripts | None = None
        self.recorder: Recording | None = None
        self._panels: dict[Hashable, Callable[[], None]] = {}
        self._subscriptions: list[Subscription] = []
        self._closed = False
        self._lock = threading.RLock()

    @property
    def engine(self) -> Engine:
        """The half of the lab that needs ROS, started on first use."""
        with self._lock:
            if self._closed:
                raise LabError("This lab is closed.")
            if self._engine is None:
                self._engine = self._start_engine()
            return self._engine

    @property
    def scripts(self) -> Scripts:
        with self._lock:
            if self._scripts is None:
                from course_kit.lab.runtime.neighbours import mark_of
                from course_kit.lab.scripts.running import Scripts

                self.notebook.watch_output()
                self._scripts = scripts = Scripts(self.output, self.events.forward, mark_of(self.notebook.title))
                scripts.wait_for_nodes = self._wait_for_nodes
                _at_exit(self.close)
            return self._scripts

    @property
    def neighbours(self) -> Neighbours:
        self.engine  # noqa: B018 - it makes them
        return self._neighbours

    def live_nodes(self) -> list[LiveNode]:
        """The started nodes, by name."""
        return sorted(self._engine.nodes.live, key=lambda live: live.name) if self._engine is not None else []

    def keep(self, subscription: Subscription) -> Subscription:
        self._subscriptions = [*(other for other in self._subscriptions if other.is_open), subscription]
        return subscription

    def stop(self) -> None:
        """Take all nodes off the graph, and close the subscriptions."""
        for live in self.live_nodes():
            self.engine.nodes.stop(live)
        while self._subscriptions:
            self._subscriptions.pop().close()
        if self._engine is not None:
            self._engine.clients.forget()
        self.output.drain()

    def record(self) -> Recording:
        """Begin a recording, which `lab.diagram` draws; what was recorded before is forgotten."""
        if self.recorder is None:
            self.recorder = Recording()
            self.events.listen(self.recorder.observe)
        self.output.drain()  # also takes in what scripts have reported
        self.recorder.restart()
        return self.recorder

    def require_recorder(self) -> Recording:
        """What keeps the events; raises LabError where nothing does."""
        if self.recorder is None:
            raise LabError("Nothing is being recorded. Run lab.record() before nodes are started.")
        self.output.drain()
        return self.recorder

    def attach_panel(self, key: Hashable, close: Callable[[], None]) -> None:
        """Have a panel closed with the lab, or before a new one with the same key is attached."""
        before = self._panels.pop(key, None)
        if before is not None:
            before()
        self._panels[key] = close

    def close(self) -> None:
        """End everything: panels, scripts, nodes, the thread, the context. Safe to call twice."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            while self._panels:
                self._panels.popitem()[1]()
            if self._scripts is not None:
                self._scripts.close()
            if self._engine is not None:
                self._engine.close()
            self.output.drain()
            self.notebook.detach()

    def _start_engine(self) -> Engine:
        from course_kit import environment

        environment.apply_settings()
        from course_kit.lab.overrides import rclpy_functions
        from course_kit.lab.runtime.engine import Engine
        from course_kit.lab.runtime.neighbours import Neighbours
        from course_kit.ros import compat

        found = compat.check_features()
        engine = Engine(self.events, self.output, self.notebook, found)
        rclpy_functions.replace_functions(engine)
        self._neighbours = Neighbours(engine, self.notebook.title, self._stop_for, self._script_nodes)
        engine.before_call = self._neighbours.tell_who_answers
        self.notebook.attach(engine.executor_thread.thread_id, found)
        for sentence in found.sentences():
            self.output.put(f"{sentence}\n", "stderr")
        _at_exit(self.close)
        return engine

    def _end_strays(self, named: Iterable[object], *, stopped: bool, failed: bool) -> None:
        """A cell has ended. One that was stopped or has failed takes the nodes along that it has made by itself."""
        if "rclpy.node" not in sys.modules:
            return
        ended = []
        if self._engine is None:  # rclpy.init() shuts ROS down at the press of Stop, under every node
            from course_kit.lab.runtime import nodes

            ended = nodes.end_strays(lambda node: not node.context.ok())
        elif stopped or failed:
            ended = self._engine.end_strays(() if stopped else named)
        if ended:
            verb = "are" if len(ended) > 1 else "is"
            self.output.put(f"{', '.join(ended)}, which the lab did not run, {verb} gone, as when a program ends.\n")

    def _wait_for_nodes(self, names: list[str], there: bool) -> None:
        """Wait until every node of a script is on the graph as this process sees it, or none is; 3 s at most."""
        engine = self._engine
        if engine is None or engine.in_callback():
            return
        own = {live.name for live in engine.nodes.live}
        deadline = time.monotonic() + _SETTLING
        pause = threading.Event()  # rclpy has no event for changes of the graph
        while time.monotonic() < deadline:
            seen = graph.node_names(engine.node)
            counts = [seen.count(name) - (name in own) for name in names]
            if all(count > 0 for count in counts) if there else not any(count > 0 for count in counts):
                break
            pause.wait(_POLL)
        if there:
            self._neighbours.node_started()

    def rename_notebook(self, name: str) -> None:
        """The page has given the notebook another name."""
        os.environ["JPY_SESSION_NAME"] = str(Path(os.environ.get("JPY_SESSION_NAME", "")).parent / name)
        if self._engine is not None:
            self._neighbours.rename(name)

    def _script_nodes(self) -> dict[str, str]:
        return self._scripts.nodes() if self._scripts is not None else {}

    def _stop_for(self, title: str) -> None:
        self.stop()
        if self._scripts is not None:
            self._scripts.stop(None)
        self.engine.note(f"{title} has stopped this notebook's nodes.")


def _at_exit(function: Callable[[], None]) -> None:
    """Run a function at interpreter exit, before Python takes away its threads."""
    try:
        threading._register_atexit(function)  # type: ignore[attr-defined] # noqa: SLF001 - Python has no other way to it
    except (AttributeError, RuntimeError):  # it is gone, or the interpreter is ending already
        atexit.register(function)
