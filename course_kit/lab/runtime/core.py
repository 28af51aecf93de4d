"""The lab: live nodes behind a notebook or a program, and the verbs for them."""

from __future__ import annotations

import atexit
import sys
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_kit.lab import graph
from course_kit.lab.errors import LabError
from course_kit.lab.notebook.cells import Notebook
from course_kit.lab.notebook.output import Output
from course_kit.lab.recording.events import EventStream
from course_kit.lab.runtime.callback_errors import where_is
from course_kit.ros import graph as ros_graph

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator

    from course_kit.lab.awaiting import Pending
    from course_kit.lab.recording.recording import Recording
    from course_kit.lab.runtime.callback_errors import Locate
    from course_kit.lab.runtime.engine import Engine
    from course_kit.lab.runtime.neighbours import OtherNotebook
    from course_kit.lab.runtime.nodes import NodeList
    from course_kit.lab.scripts.running import Script, Scripts
    from course_kit.lab.topics import Subscription
    from course_kit.ros.messages import Message


class Lab:
    """Nodes, scripts and calls of one process."""

    def __init__(self) -> None:
        self.events = EventStream()
        self.output = Output()
        self._notebook = Notebook.of_this_process(self.output)
        self._notebook.nodes_run = lambda: bool(self.nodes())
        self._notebook.on_end = self._end_strays
        self._engine: Engine | None = None
        self._scripts: Scripts | None = None
        self._recorder: Recording | None = None
        self._panels: dict[Hashable, Callable[[], None]] = {}
        self._told: set[str] = set()
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
        """The programs that run as child processes."""
        with self._lock:
            if self._scripts is None:
                from course_kit.lab.scripts.running import Scripts

                self._notebook.watch_output()
                self._scripts = Scripts(self)
                _at_exit(self.close)
            return self._scripts

    def watch_output(self) -> None:
        """In a notebook: see to it from now on that lines land in the right cell; otherwise from the first node on."""
        self._notebook.watch_output()

    def expect(self, verb: Pending[Any], *, awaited: bool = False) -> None:
        """A verb was called, or awaited; a cell that ends without having awaited it is told so."""
        self._notebook.expect(verb, awaited=awaited)

    def start(self, node_class: type, /, *arguments: Any, **options: Any) -> Any:
        """See `course_kit.lab.start`."""
        self._not_in_callback("lab.start()")
        __tracebackhide__ = True  # IPython: the learner's own lines are what matters
        engine = self.engine
        with told_if_slow(node_class, self._notebook.locate, engine.note):
            node = engine.nodes.start(node_class, arguments, options)
        engine.neighbours.node_started()
        self.output.drain()
        return node

    def stop(self, target: object = None, /) -> None:
        """See `course_kit.lab.stop`."""
        if self._engine is None:
            nodes = []
        else:
            nodes = list(self._engine.nodes) if target is None else self._engine.nodes.find(target)
        if not nodes and target is not None:
            running = ", ".join(sorted(live.name.lstrip("/") for live in self.engine.nodes)) or "none"
            raise LabError(f"{_shown(target)} is not running in the lab. Running: {running}.")
        for live in nodes:
            self.engine.nodes.stop(live)
        if target is None:
            while self._subscriptions:
                self._subscriptions.pop().close()
            if self._engine is not None:
                self._engine.clients.forget_all()
        self.output.drain()

    def subscribe(self, topic: str, message_type: type[Message], callback: Callable[[Message], None], qos: Any) -> Any:
        """See `course_kit.lab.subscribe`."""
        from course_kit.lab.topics import Subscription

        self._subscriptions = [one for one in self._subscriptions if one.is_open]
        subscription = Subscription(self.engine, topic, message_type, callback, qos)
        self._subscriptions.append(subscription)
        return subscription

    def others(self) -> list[OtherNotebook]:
        """See `course_kit.lab.others`."""
        return self.engine.neighbours.others()

    def stop_others(self, title: str | None) -> None:
        """See `course_kit.lab.stop_others`."""
        self._not_in_callback("lab.stop_others()")
        others = [one for one in self.others() if title is None or one.title == title]
        if title is not None and not others:
            known = ", ".join(one.title for one in self.others()) or "none"
            raise LabError(f"{title} runs no nodes on this graph. Other notebooks that do: {known}.")
        if left := self.engine.neighbours.stop(others):
            raise LabError(
                f"{left[0].title} has not stopped its nodes: a callback of theirs does not end. Restart its kernel."
            )

    def nodes(self) -> NodeList:
        """See `course_kit.lab.nodes`."""
        from course_kit.lab.runtime.nodes import NodeList

        live = sorted(self._engine.nodes, key=lambda one: one.name) if self._engine else []
        found = NodeList(live)
        found.others = self.others() if self._engine else []
        return found

    def script(self, name: str, source: str, arguments: tuple[str, ...], mode: str) -> Script:
        """See `course_kit.lab.script`."""
        return self.scripts.run(name, source, arguments, mode)

    def wait_for_nodes(self, names: list[str], *, there: bool) -> None:
        """Wait until the nodes of a script are on the graph as this process sees it, or are not; with a deadline."""
        if self._engine is not None and not self._engine.in_callback():
            graph.wait_for_nodes(self._engine.node, names, {live.name for live in self._engine.nodes}, there=there)

    @property
    def mark(self) -> str:
        """By what other notebooks know the processes of this one."""
        from course_kit.lab.runtime.neighbours import mark_of

        return mark_of(self._notebook.title)

    @property
    def recorder(self) -> Recording | None:
        """What keeps the events, if anything does."""
        return self._recorder

    def attach(self, recorder: Recording) -> None:
        """Have a recorder told what crosses from now on, and `diagram` answered by it."""
        self._recorder = recorder
        self.events.listen(recorder.observe)

    def record(self) -> None:
        """See `course_kit.lab.record`."""
        self._require_recorder().restart()

    def diagram(self, last: int | None) -> object:
        """See `course_kit.lab.diagram`."""
        recorder = self._require_recorder()
        self.output.drain()  # also takes in what scripts have reported
        return recorder.diagram(last)

    def timeline(self) -> object:
        """See `course_kit.lab.timeline`."""
        recorder = self._require_recorder()
        self.output.drain()  # also takes in what scripts have reported
        return recorder.timeline()

    def tell_once(self, sentences: Iterable[str]) -> None:
        """Say what is off in this lab, each sentence once."""
        for sentence in sentences:
            if sentence not in self._told:
                self._told.add(sentence)
                self.output.put(sentence + "\n", "stderr")

    def attach_panel(self, key: Hashable, close: Callable[[], None]) -> None:
        """Have a panel closed with the lab, or before another one of the same key is attached."""
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
            self._notebook.detach()

    def _start_engine(self) -> Engine:
        from course_kit import environment

        environment.apply_settings()
        from course_kit.lab.runtime.engine import Engine
        from course_kit.ros import compat

        found = compat.check_features()
        engine = Engine(self.events, self.output, self._notebook, found)
        engine.on_server_gone = self._let_scripts_end
        engine.neighbours.on_stop_asked = self._stop_for
        engine.neighbours.script_nodes = self._script_nodes
        self._notebook.attach(engine.executor_thread.thread_id, found)
        self.tell_once(found.sentences())
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

    def _script_nodes(self) -> dict[str, str]:
        return self._scripts.nodes() if self._scripts is not None else {}

    def _stop_for(self, title: str) -> None:
        """Another notebook asks that this one stops its nodes."""
        self.stop()
        if self._scripts is not None:
            self._scripts.stop(None)
        self.engine.note(f"{title} has stopped this notebook's nodes.")

    def _let_scripts_end(self) -> None:
        if self._scripts is not None and self._engine is not None:
            node = self._engine.node
            self._scripts.wait_for_end_of_those_without_node(set(ros_graph.node_names(node)))

    def _require_recorder(self) -> Recording:
        if self._recorder is None:
            raise LabError(
                "Nothing is being recorded. In a notebook run `%load_ext course_kit` first; in a program, "
                "`from course_kit.lab.recording import attaching`, and `attaching.attach()` before nodes are started."
            )
        return self._recorder

    def _not_in_callback(self, what: str) -> None:
        if self._engine is not None:
            self._engine.not_in_callback(what)


def _shown(target: object) -> str:
    return target.__name__ if isinstance(target, type) else repr(target) if isinstance(target, str) else "This node"


def _at_exit(function: Callable[[], None]) -> None:
    """Run a function at interpreter exit, before Python takes away its threads."""
    register = getattr(threading, "_register_atexit", None)
    try:
        if register is None:
            raise RuntimeError  # noqa: TRY301 - both cases have the same way out
        register(function)
    except RuntimeError:  # the interpreter is ending already
        atexit.register(function)


_SLOW = 3.0  # seconds


@contextmanager
def told_if_slow(node_class: object, locate: Locate, tell: Callable[[str], None]) -> Iterator[None]:
    """Say where `__init__` is when it takes longer than any needs."""
    starting = threading.get_ident()

    def look() -> None:
        at = where_is(sys._current_frames().get(starting), locate)  # noqa: SLF001 - the documented way to look
        where = f" ({at[0]}: {at[1]})" if at else ""
        name = getattr(node_class, "__name__", "The class")
        tell(
            f"{name}.__init__ has not ended after {_SLOW:g} s{where}. lab.start() waits for it. Is it a loop? Press "
            "Stop, and move what repeats into a timer: self.create_timer(seconds, self.method)."
        )

    timer = threading.Timer(_SLOW, look)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
