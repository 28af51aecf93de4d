from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil
import pytest

from course_kit import environment, lab
from course_kit.lab.scripts import running as running_scripts
from course_kit.process.child import Child
from tests.waiting import wait_until

if TYPE_CHECKING:
    from tests.lab.kernel import Kernel

PROGRAMS = Path(__file__).parent.parent / "lesson_programs"
SERVER = (PROGRAMS / "minimal_service.py").read_text()
CLIENT = (PROGRAMS / "minimal_client.py").read_text()
DEAF = "import rclpy, time\nrclpy.init()\ntry:\n    rclpy.spin(rclpy.create_node('d'))\nfinally:\n    time.sleep(600)\n"
EXCHANGE = (
    "1. minimal_client -> minimal_service  /add_two_ints request: a=1, b=2\n"
    "2. minimal_service -> minimal_client  /add_two_ints response: sum=3"
)
CLIENT_LINES = (
    "[INFO] [minimal_service]: Incoming request\na: 1 b: 2\n[INFO] [minimal_client]: Result of add_two_ints: 3\n"
)


def test_the_seeds_programs_in_a_notebook(kernel: Kernel) -> None:
    started = kernel.run(f"%%ros_script server\n{SERVER}")
    assert (started.stdout, started.stderr) == ("server is running in the background (node minimal_service).\n", "")
    for _ in range(3):
        kernel.run("from course_kit import lab\nlab.record()")
        asked = kernel.run(f"%%ros_script client 1 2\n{CLIENT}")
        assert (asked.stdout, asked.stderr) == (CLIENT_LINES, "")
        assert kernel.run("lab.diagram()").result["text/plain"] == EXCHANGE
    mixed = kernel.run(
        "from example_interfaces.srv import AddTwoInts\n"
        "print((await lab.call('/add_two_ints', AddTwoInts, a=3, b=4)).sum)"
    )
    assert mixed.stdout == "[INFO] [minimal_service]: Incoming request\na: 3 b: 4\n7\n"
    stopped = kernel.run("%ros_stop --ctrl-c server").stdout
    assert stopped.startswith(
        "server is stopped.\nIn a terminal, Ctrl-C ends it with exit code 1. Its last line is: rclpy."
    )
    gone = kernel.run("await lab.call('/add_two_ints', AddTwoInts, a=3, b=4, timeout=0.3)")
    assert gone.error.startswith("ServiceNotFoundError: No node serves /add_two_ints")


def test_a_server_that_returns_nothing_shows_why(kernel: Kernel) -> None:
    kernel.run(f"%%ros_script server\n{SERVER.replace('return response', 'pass')}")
    called = kernel.run(
        "from course_kit import lab\nfrom example_interfaces.srv import AddTwoInts\n"
        "await lab.call('/add_two_ints', AddTwoInts, a=3, b=4, timeout=30)"
    )
    assert called.error.startswith("NoAnswerError: The server of /add_two_ints went away: its program ended")
    assert called.stdout.endswith("TypeError: the service callback returned nothing. End it with `return response`.\n")
    assert 'File "server.py", line' in called.stdout
    assert "--x lab  /add_two_ints no answer: the service callback" in kernel.run("print(lab.diagram())").stdout


def test_running_again_replaces_and_bugs_show_as_a_short_traceback(kernel: Kernel) -> None:
    kernel.run(f"%%ros_script server\n{SERVER}")
    again = kernel.run(f"%%ros_script server\n{SERVER}")
    assert again.stdout == "server is running in the background (node minimal_service).\n"
    kernel.run("lab.current().engine.node\nlab.current().wait_for_nodes(['/minimal_service'], there=True)")
    count = "print(lab.current().engine.node.get_node_names().count('minimal_service'))"
    wait_until(lambda: kernel.run(count).stdout == "1\n", lambda: kernel.run(count).stdout)  # the first one's end
    assert kernel.run("%%ros_script bug\nimport rclpy\ndef f():\n    raise ValueError('x')\ny = f() + 1").stdout == (
        'Traceback (most recent call last):\n  File "bug.py", line 4, in <module>\n    y = f() + 1\n'
        "  File \"bug.py\", line 3, in f\n    raise ValueError('x')\nValueError: x\n"
    )
    typo = kernel.run("%%ros_script typo\nx = = 2").stdout
    assert typo.startswith('  File "typo.py", line 1\n')
    assert typo.endswith("SyntaxError: invalid syntax\n")


@pytest.mark.usefixtures("own_lab")
def test_an_error_in_a_thread_shows_as_a_short_traceback_without_colours(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")  # as Jupyter's kernels do; Python 3.13 heeds it
    failing = "import subprocess, sys, threading\ndef work():\n    return 1 / 0\n"
    child = "subprocess.run([sys.executable, '-c', 'x'])\nimport os\nprint(os.environ['PYTHON_COLORS'])\n"
    lab.script("bug", f"{failing}one = threading.Thread(target=work, name='one')\none.start()\none.join()\n{child}")
    shown = capfd.readouterr().out
    assert shown.startswith(
        'Exception in thread one:\nTraceback (most recent call last):\n  File "bug.py", line 3, in work\n'
        "    return 1 / 0\nZeroDivisionError: division by zero\nTraceback"
    )
    assert shown.endswith("\nNameError: name 'x' is not defined\n0\n")  # 0 asks for none on each Python
    assert "\x1b" not in shown


@pytest.mark.usefixtures("own_lab")
def test_a_script_that_another_notebook_saves_meanwhile_runs_as_it_was(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    saved = environment.run_dir(environment.paths.CELL_PROGRAMS) / "twin.py"

    def start_late(*arguments: Any, **options: Any) -> Child:
        saved.write_text("print('theirs')")
        return Child(*arguments, **options)

    monkeypatch.setattr(running_scripts, "Child", start_late)
    lab.script("twin", "print('mine', __name__, __file__.endswith('twin.py'))")
    assert capfd.readouterr().out == "mine __main__ True\n"


@pytest.mark.parametrize(
    ("cell", "message"),
    [
        ("%%ros_script\nx", "MagicError: Write %%ros_script NAME"),
        ("%%ros_script --fast x\nx", "MagicError: There is no option --fast."),
        ("%%ros_script 'a\nx", "MagicError: A quote in the line is not closed"),
        ("%%ros_script ../a\nx", "ScriptError: '../a' cannot name a script"),
        ("%ros_stop nobody", "ScriptError: No script called 'nobody' is running. Running: none."),
        ("%ros_stop a b", "MagicError: Write %ros_stop NAME"),
        ("%%interface\nint32 a", "MagicError: Write %%interface PACKAGE/srv/NAME"),
        ("%%interface my_interfaces/srv/Wrong\nstrin name\n---\n", "MagicError: "),
        ("%%interface Wrong\nstring name", "MagicError: "),
    ],
)
def test_usage_errors_are_sentences(cell: str, message: str, kernel: Kernel) -> None:
    shown = kernel.run(cell).error
    assert shown.startswith(message)
    assert "\n" not in shown.strip() or "Wrong" in cell
    assert "Traceback" not in shown


def test_interface_defines_and_redefines(kernel: Kernel) -> None:
    definition = "%%interface h2_test_interfaces/srv/Person\nstring name\n---\nbool success"
    assert kernel.run(definition).stdout == (
        "h2_test_interfaces/srv/Person is defined. In programs: from h2_test_interfaces.srv import Person\n"
    )
    assert kernel.run("print(Person.Request(name='Ada'))").ok
    kernel.run(definition.replace("string name", "string name\nint32 age"))
    assert kernel.run("from h2_test_interfaces.srv import Person\nprint(Person.Request(age=3).age)").stdout == "3\n"


def test_a_live_node_answers_with_the_redefined_type(kernel: Kernel) -> None:
    node = (
        "from course_kit import lab\nfrom rclpy.node import Node\n"
        "from h2_test_interfaces.srv import Greet\n"
        "class Greeter(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('greeter')\n"
        "        self.create_service(Greet, 'greet', self.greet)\n"
        "    def greet(self, request, response):\n"
        "        names = request.get_fields_and_field_types()\n"
        "        response.text = ' '.join(str(getattr(request, name)) for name in names)\n"
        "        return response\n"
        "lab.start(Greeter)\n"
    )
    kernel.run("%%interface h2_test_interfaces/srv/Greet\nstring name\n---\nstring text")
    assert kernel.run(node + "print((await lab.call('/greet', Greet, name='Ada')).text)").stdout == "Ada\n"
    kernel.run("%%interface h2_test_interfaces/srv/Greet\nint32 age\nstring name\n---\nstring text")
    shown = kernel.run(node + "print((await lab.call('/greet', Greet, name='Ada', age=36)).text)")
    assert (shown.stdout, shown.error) == ("36 Ada\n", "")


def test_interrupting_a_cell_stops_its_script(kernel: Kernel) -> None:
    message = kernel.send("%%ros_script --wait sleeper\nprint('begun')\nimport time\ntime.sleep(60)")
    kernel.finish(message, until="begun")
    kernel.manager.interrupt_kernel()
    assert kernel.finish(message).stdout == "sleeper was interrupted.\n"
    assert psutil.Process(kernel.pid).children() == []


@pytest.mark.parametrize(("how", "text"), [(signal.SIGKILL, SERVER), (signal.SIGTERM, SERVER), (signal.SIGKILL, DEAF)])
def test_scripts_die_with_the_kernel(how: signal.Signals, text: str, fresh_kernel: Kernel) -> None:
    fresh_kernel.run(f"%%ros_script server\n{text}")
    below = psutil.Process(fresh_kernel.pid).children(recursive=True)
    children = [child for child in below if "child_main" in " ".join(child.cmdline())]
    assert len(children) == 1
    os.kill(fresh_kernel.pid, how)
    wait_until(lambda: not any(running(child.pid) for child in children), "the end of the script")


@pytest.mark.usefixtures("own_lab")
def test_a_script_that_ignores_the_interrupt_is_killed_with_its_children(tmp_path: Path) -> None:
    pid_file = tmp_path / "pids"
    stubborn = (
        "import os, rclpy, signal, subprocess, sys\nfrom rclpy.node import Node\n"
        "child = subprocess.Popen([sys.executable, '-c', 'import time; time.sleep(60)'])\n"
        f"open({str(pid_file)!r}, 'w').write(f'{{os.getpid()}} {{child.pid}}')\n"
        "rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)\nnode = Node('stubborn')\n"
        "for number in (signal.SIGINT, signal.SIGTERM):\n    signal.signal(number, signal.SIG_IGN)\n"
        "rclpy.spin(node)\n"
    )
    lab.script("stubborn", stubborn)
    pids = [int(pid) for pid in pid_file.read_text().split()]
    lab.stop_script("stubborn")
    wait_until(lambda: not any(map(running, pids)), "the end of a script and its child")


def running(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


@pytest.mark.usefixtures("own_lab")
def test_what_cannot_be_a_script() -> None:
    with pytest.raises(lab.ScriptError, match="The mode is one of auto, wait, background, not 'fast'"):
        lab.script("a", "", mode="fast")
    with pytest.raises(lab.LabError, match="Nothing is being recorded"):
        lab.diagram()


def test_a_coding_line_in_a_cell_does_not_spoil_its_letters(kernel: Kernel) -> None:
    assert kernel.run('%%ros_script greet\n# -*- coding: latin-1 -*-\nprint("grüße")').stdout == "grüße\n"
