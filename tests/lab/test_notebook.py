"""What a learner sees, in real kernels."""

from __future__ import annotations

import re
from pathlib import Path

import psutil

from tests.lab.kernel import Kernel

SERVER = """
from course_kit import lab
from rclpy.node import Node
from std_srvs.srv import SetBool

class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(SetBool, "ask", self.answer)

    def answer(self, request, response):
        self.get_logger().info("asked")
        print("printed", end=" ")
        print(request.data)
        if not request.data:
            raise ValueError("no")
        return response

started = lab.start(Server)
"""


def test_lines_of_callbacks_land_in_order_in_the_cell_that_caused_them(kernel: Kernel) -> None:
    started = kernel.run(SERVER + "\nstarted")
    assert started.result["text/plain"] == "server (Server)\n    serves /ask [std_srvs/srv/SetBool]"
    for number in range(25):
        cell = kernel.run(
            f"print({number})\nawait lab.call('/ask', SetBool, data=True)\n"
            "print('between')\nanswer = await lab.call('/ask', SetBool, data=True)\nprint('after')"
        )
        lines = "[INFO] [server]: asked\nprinted True\n"
        assert (cell.stdout, cell.stderr) == (f"{number}\n{lines}between\n{lines}after\n", "")


def test_lines_that_another_thread_shows_land_in_the_cell_that_runs(fresh_kernel: Kernel) -> None:
    """A panel's thread, which ipykernel may take for a part of the cell that has started it."""
    fresh_kernel.run(SERVER)
    fresh_kernel.run(
        "import contextvars, threading\n"
        "from course_kit.lab.api import current\n"
        "asked, shown = threading.Event(), threading.Event()\n"
        "def show():\n    asked.wait(10)\n    current().output.drain()\n    shown.set()\n"
        "threading.Thread(target=contextvars.copy_context().run, args=(show,), daemon=True).start()"
    )
    cell = fresh_kernel.run("current().output.put('a log line\\n')\nasked.set()\nassert shown.wait(10)")
    assert (cell.stdout, cell.error) == ("a log line\n", "")


def test_lines_of_the_very_first_cell_without_the_extension(domain: int, tmp_path: Path) -> None:
    assert domain
    with Kernel(cwd=tmp_path) as plain:
        cell = plain.run(SERVER + "\nlab.call_blocking('/ask', SetBool, data=True)\nprint('after')")
        assert "[INFO] [server]: asked\n" in cell.stdout
        cell = plain.run("lab.call_blocking('/ask', SetBool, data=True)\nprint('after')")
        assert cell.stdout == "[INFO] [server]: asked\nprinted True\nafter\n"


def test_lines_stream_while_a_cell_waits(kernel: Kernel) -> None:
    kernel.run("import asyncio\n" + SERVER)
    message = kernel.send("lab.nodes()[0].node.create_timer(0.05, lambda: print('tick'))\nawait asyncio.sleep(30)")
    assert "tick" in kernel.finish(message, until="tick").stdout
    kernel.manager.interrupt_kernel()
    assert kernel.finish(message).ok is False


def test_a_crash_is_three_lines_with_the_learners_own(kernel: Kernel) -> None:
    cell_number = kernel.run(SERVER + "\nprint(len(In) - 1)").stdout.strip()
    cell = kernel.run("await lab.call('/ask', SetBool, data=False)")
    assert cell.stderr == (
        "server: answer raised ValueError: no\n"
        f'  In[{cell_number}], line 15: raise ValueError("no")\n'
        "  The caller gets no answer. In a separate program this would end the server; here it keeps running.\n"
    )
    assert cell.error == (
        f"ServiceFailedError: server sent no response: answer raised ValueError: no (In[{cell_number}], line 15)"
    )
    assert kernel.run("await lab.call('/ask', SetBool, data=True)").ok


def test_errors_of_the_lab_show_without_a_traceback(kernel: Kernel) -> None:
    kernel.run(SERVER)
    assert kernel.run("lab.stop('nobody')").error == ("LabError: 'nobody' is not running in the lab. Running: server.")
    assert kernel.run("await lab.call('/ask', SetBool, date=True)").error.startswith("FieldError: There is no field")


def test_the_class_edited_and_run_again_replaces(kernel: Kernel) -> None:
    kernel.run(SERVER)
    kernel.run(SERVER.replace('"server"', '"renamed"').replace("printed", "edited"))
    assert kernel.run("lab.nodes()").result["text/plain"].startswith("renamed (Server)")
    cell = kernel.run("answer = await lab.call('/ask', SetBool, data=True)")
    assert cell.stdout == "[INFO] [renamed]: asked\nedited True\n"


def test_rclpys_program_functions_say_what_they_mean_here(kernel: Kernel) -> None:
    kernel.run(SERVER)
    cell = kernel.run(
        "import rclpy\nrclpy.init()\nrclpy.spin(lab.nodes()[0].node)\nrclpy.shutdown()\nprint(rclpy.ok())"
    )
    assert cell.stdout.splitlines() == [
        "rclpy.init(): ROS is already running in this notebook; nothing to do.",
        "rclpy.spin(): the lab spins server in the background already; nothing to do.",
        "rclpy.shutdown(): ROS stays up in this notebook. lab.stop() stops the lab's nodes.",
        "True",
    ]


def test_init_says_what_it_ignores(kernel: Kernel) -> None:
    kernel.run(SERVER)
    kernel.run("import os, rclpy\nown = int(os.environ['ROS_DOMAIN_ID'])")
    told = kernel.run("rclpy.init(args=['prog', '--ros-args', '-r', '__node:=other'], domain_id=own + 1)").stdout
    assert told.endswith("its arguments are ignored.\n")
    assert kernel.run("rclpy.init(args=['prog'], domain_id=own)").stdout.endswith("nothing to do.\n")
    assert "unexpected keyword argument" in kernel.run("rclpy.init(domain=3)").error


def test_interrupting_an_await_a_blocking_call_and_a_spin(kernel: Kernel) -> None:
    kernel.run(SERVER + "\nimport rclpy.experimental\nfrom rclpy.callback_groups import ReentrantCallbackGroup\n")
    kernel.run(
        "class Silent(Node):\n"
        "    def __init__(self):\n"
        "        super().__init__('silent')\n"
        "        self.never = self.create_client(SetBool, 'never', callback_group=ReentrantCallbackGroup())\n"
        "        self.create_service(SetBool, 'hush', self.wait)\n"
        "    async def wait(self, request, response):\n"
        "        await self.never.call_async(request)\n"
        "        return response\n"
        "silent = lab.start(Silent)"
    )
    for code in (
        "await lab.call('/hush', SetBool, timeout=60)",
        "lab.call_blocking('/hush', SetBool, timeout=60)",
        "await silent.never.call_async(SetBool.Request())",
        "rclpy.spin_until_future_complete(silent, silent.never.call_async(SetBool.Request()))",
        "node = rclpy.create_node('mine'); rclpy.spin(node)",
        "rclpy.spin(rclpy.create_node('own'), rclpy.experimental.EventsExecutor())",
    ):
        # One statement: IPython itself is at work between two, and shows an interrupt there in its own way.
        message = kernel.send(f"if print('begun', flush=True) is None:\n    {code}")
        kernel.finish(message, until="begun")
        kernel.manager.interrupt_kernel()
        assert kernel.finish(message).error.startswith("Interrupted in In["), code
    assert kernel.run("answer = await lab.call('/ask', SetBool, data=True)").ok


def test_what_stop_interrupts_leaves_the_graph(kernel: Kernel) -> None:
    names = "print(lab.current().engine.node.get_node_names())"
    ticker = "ticker = rclpy.create_node('ticker')\nticker.create_timer(0.01, lambda: print('tick'))\n"
    kernel.run("import rclpy.experimental")
    message = kernel.send(f"{ticker}rclpy.spin(ticker, rclpy.experimental.EventsExecutor())")
    kernel.finish(message, until="tick")
    kernel.manager.interrupt_kernel()
    assert "ticker, which the lab did not run, is gone" in kernel.finish(message).stdout
    assert "ticker" not in kernel.run(names).stdout

    made_last = "rclpy.node.TypeDescriptionService"  # so without it a node is made by half
    half = f"kept = {made_last}\ndel {made_last}\nrclpy.create_node('half')"
    assert "half, which the lab did not run, is gone" in kernel.run(half).stdout
    assert kernel.run(f"{made_last} = kept\n1 / 0").stdout == ""  # it said so for ever


def test_shutdown_and_restart_are_clean(fresh_kernel: Kernel) -> None:
    for _ in range(3):
        fresh_kernel.run("%load_ext course_kit")
        fresh_kernel.run(SERVER)
        fresh_kernel.run("timer = lab.nodes()[0].node.create_timer(0.001, lambda: None)")
        process = psutil.Process(fresh_kernel.pid)
        before = files_mapped_by(process)
        fresh_kernel.client.shutdown(restart=False)
        assert process.wait(timeout=20) in {0, None}
        assert [file for file in before if file.exists()] == []
        fresh_kernel.manager.restart_kernel(now=True)
        fresh_kernel.client.wait_for_ready(timeout=40)


def files_mapped_by(process: psutil.Process) -> list[Path]:
    """The process's own files in shared memory; those named after ports are shared with other processes."""
    mapped = (Path(one.path) for one in process.memory_maps())
    return [path for path in mapped if re.fullmatch("fastrtps_[0-9a-f]{16}", path.name)]


CYCLES = """
import gc, os, psutil, rclpy
process = psutil.Process()

def counted():
    gc.collect()
    return len(process.threads()), process.num_fds(), process.memory_info().rss

def cycle():
    lab.start(Server)
    lab.call_blocking("/ask", SetBool, data=True)
    lab.start(Server)
    class Server2(Server):
        def __init__(self):
            Node.__init__(self, "other")
            self.create_service(SetBool, "ask2", self.answer)
            self.timer = self.create_timer(0.01, lambda: None)
    lab.start(Server2)
    lab.call_blocking("/ask2", SetBool, data=True)
    lab.stop()

for _ in range(40):
    cycle()
before = counted()
for _ in range(200):
    cycle()
after = counted()
names = lab.current().engine.node.get_node_names()
"""


def test_200_cycles_of_start_replace_and_stop_leak_nothing(kernel: Kernel) -> None:
    kernel.run("print = lambda *_, **__: None\n" + SERVER.replace("self.get_logger().info", "str"))
    kernel.run("del print")
    cell = kernel.run(CYCLES)
    assert cell.ok, cell.error
    threads, files, memory = (
        int(number) for number in kernel.run("print(*(a - b for a, b in zip(after, before)))").stdout.split()
    )
    assert (threads, files) == (0, 0)
    assert memory < 4_000_000  # bytes; one participant alone takes 7 MB
    assert kernel.run("print([name for name in names if name in {'server', 'other'}])").stdout == "[]\n"


def test_a_warning_of_rclpy_in_a_callback_is_one_line_without_a_place_in_rclpy(kernel: Kernel) -> None:
    started = """
vars(rclpy.node).pop("__warningregistry__", None)  # what another test of this kernel has seen already
class Forgetful(Node):
    def __init__(self):
        super().__init__("forgetful")
        self.declare_parameter("speed", 1.0)
        self.add_on_set_parameters_callback(lambda parameters: None)
lab.start(Forgetful)
"""
    assert kernel.run("import rclpy.node\nfrom rclpy.node import Node" + started).ok
    refused = kernel.run('await lab.set_parameters("/forgetful", speed=2.0)')
    assert refused.result["text/plain"] == "speed: 2.0 was refused: Callback returned an invalid type"
    assert re.fullmatch(r"UserWarning: Callback returned an invalid type, .*\n", refused.stderr)
