"""The workspace that the tutorials' commands are run in: programs as their pages print them, and stand-ins.

Python programs, launch files and interfaces are taken out of the pages, unmodified. What the pages start in compiled
packages (turtlesim, demo_nodes_cpp) is stood in for by programs of the same names, topics, services and types.
"""

from __future__ import annotations

import itertools
import re
import subprocess
import textwrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

BRANCH = "jazzy"
BEGINNER, LAUNCH = "Tutorials/Beginner-Client-Libraries/", "Tutorials/Intermediate/Launch/"
ACTIONS = "Tutorials/Intermediate/Writing-an-Action-Server-Client/"
LARGE = f"{LAUNCH}Using-ROS2-Launch-For-Large-Projects"
# file in the workspace: the page that prints it, and what only the right block of code there holds
PRINTED = {
    "py_pubsub/py_pubsub/publisher.py": (
        f"{BEGINNER}Writing-A-Simple-Py-Publisher-And-Subscriber",
        "MinimalPublisher()",
    ),
    "py_pubsub/py_pubsub/listener.py": (
        f"{BEGINNER}Writing-A-Simple-Py-Publisher-And-Subscriber",
        "MinimalSubscriber()",
    ),
    "py_srvcli/py_srvcli/service.py": (f"{BEGINNER}Writing-A-Simple-Py-Service-And-Client", "MinimalService()"),
    "py_srvcli/py_srvcli/client.py": (f"{BEGINNER}Writing-A-Simple-Py-Service-And-Client", "class MinimalClientAsync"),
    "num_pubsub/num_pubsub/publisher.py": (f"{BEGINNER}Custom-ROS2-Interfaces", "def timer_callback(self)"),
    "num_pubsub/num_pubsub/listener.py": (f"{BEGINNER}Custom-ROS2-Interfaces", "def listener_callback(self"),
    "three_srvcli/three_srvcli/service.py": (f"{BEGINNER}Custom-ROS2-Interfaces", "MinimalService()"),
    "three_srvcli/three_srvcli/client.py": (f"{BEGINNER}Custom-ROS2-Interfaces", "class MinimalClientAsync"),
    "python_parameters/python_parameters/node.py": (f"{BEGINNER}Using-Parameters-In-A-Class-Python", "def main"),
    "python_parameters/launch/python_parameters_launch.py": (
        f"{BEGINNER}Using-Parameters-In-A-Class-Python",
        "def generate_launch_description",
    ),
    "python_parameter_event_handler/python_parameter_event_handler/node.py": (
        "Tutorials/Intermediate/Monitoring-For-Parameter-Changes-Python",
        "def main",
    ),
    "turtlesim_mimic_launch.py": (f"{LAUNCH}Creating-Launch-Files", "def generate_launch_description"),
    "turtlesim_mimic_launch.xml": (f"{LAUNCH}Creating-Launch-Files", "<launch>"),
    "turtlesim_mimic_launch.yaml": (f"{LAUNCH}Creating-Launch-Files", "launch:\n"),
    "py_launch_example/launch/my_script_launch.py": (f"{LAUNCH}Launch-system", "def generate_launch_description"),
    "py_launch_example/launch/my_script_launch.xml": (f"{LAUNCH}Launch-system", "<launch>"),
    "py_launch_example/launch/my_script_launch.yaml": (f"{LAUNCH}Launch-system", "launch:\n"),
    "launch_tutorial/launch/example_main_launch.py": (f"{LAUNCH}Using-Substitutions", "IncludeLaunchDescription("),
    "launch_tutorial/launch/example_main_launch.yaml": (f"{LAUNCH}Using-Substitutions", "include:"),
    "launch_tutorial/launch/example_substitutions_launch.py": (f"{LAUNCH}Using-Substitutions", "TimerAction("),
    "launch_tutorial/launch/example_substitutions_launch.yaml": (f"{LAUNCH}Using-Substitutions", "executable:"),
    "launch_tutorial/launch/example_event_handlers_launch.py": (f"{LAUNCH}Using-Event-Handlers", "OnProcessExit("),
    "launch_tutorial/launch/launch_turtlesim_launch.py": (LARGE, "turtlesim_world_1,"),
    "launch_tutorial/launch/turtlesim_world_1_launch.py": (LARGE, "background_r_launch_arg"),
    "launch_tutorial/launch/turtlesim_world_2_launch.py": (LARGE, "'turtlesim.yaml'"),
    "launch_tutorial/launch/broadcaster_listener_launch.py": (LARGE, "'broadcaster1'"),
    "launch_tutorial/launch/mimic_launch.py": (LARGE, "executable='mimic'"),
    "launch_tutorial/launch/turtlesim_rviz_launch.py": (LARGE, "executable='rviz2'"),
    "launch_tutorial/launch/fixed_broadcaster_launch.py": (LARGE, "'node_prefix'"),
    "launch_tutorial/config/turtlesim.yaml": (LARGE, "/turtlesim2/sim:\n   ros__parameters"),
    "fibonacci_action_server.py": (f"{ACTIONS}scripts/server_3.py", ""),
    "fibonacci_action_client.py": (f"{ACTIONS}scripts/client_2.py", ""),
}
FIBONACCI = "int32 order\n---\nint32[] sequence\n---\nint32[] partial_sequence\n"
INTERFACES = {
    "turtlesim/srv/Spawn.srv": "float32 x\nfloat32 y\nfloat32 theta\nstring name\n---\nstring name\n",
    "turtlesim/srv/SetPen.srv": "uint8 r\nuint8 g\nuint8 b\nuint8 width\nuint8 off\n---\n",
    "turtlesim/msg/Pose.msg": "float32 x\nfloat32 y\nfloat32 theta\nfloat32 linear_velocity\n",
    "turtlesim/msg/Color.msg": "uint8 r\nuint8 g\nuint8 b\n",
    "turtlesim/action/RotateAbsolute.action": "float32 theta\n---\nfloat32 delta\n---\nfloat32 remaining\n",
    "tutorial_interfaces/msg/Num.msg": "int64 num\n",
    "tutorial_interfaces/msg/Sphere.msg": "geometry_msgs/Point center\nfloat64 radius\n",
    "tutorial_interfaces/srv/AddThreeInts.srv": "int64 a\nint64 b\nint64 c\n---\nint64 sum\n",
    "custom_action_interfaces/action/Fibonacci.action": FIBONACCI,
    "more_interfaces/msg/AddressBook.msg": "".join(
        f"{field}\n" for field in ("string first_name", "string last_name", "string phone_number", "uint8 phone_type")
    ),
}
PROGRAMS = {
    "py_pubsub": {"talker": "publisher", "listener": "listener"},
    "num_pubsub": {"talker": "publisher", "listener": "listener"},
    "py_srvcli": {"service": "service", "client": "client"},
    "three_srvcli": {"service": "service", "client": "client"},
    "python_parameters": {"minimal_param_node": "node"},
    "python_parameter_event_handler": {"node_with_parameters": "node"},
    "turtlesim": {"turtlesim_node": "sim", "turtle_teleop_key": "teleop", "mimic": "mimic"},
    "turtle_tf2_py": {
        "turtle_tf2_broadcaster": "any",
        "turtle_tf2_listener": "any",
        "fixed_frame_tf2_broadcaster": "any",
    },
    "demo_nodes_cpp": {
        "talker": "talker",
        "listener": "any",
        "parameter_blackboard": "blackboard",
        "introspection_service": "service",
        "introspection_client": "client",
    },
    "py_launch_example": {},
    "launch_tutorial": {},
}
NODE = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState as State
{imports}

class StandIn(Node):
    def __init__(self):
        super().__init__({name!r}{options})
{body}

def main():
    rclpy.init()
    rclpy.spin(StandIn())
"""
SIM = """
self.goal = ActionServer(self, RotateAbsolute, "turtle1/rotate_absolute", self.rotate)
self.clear = [self.create_service(Empty, name, lambda request, response: response) for name in ("clear", "reset")]
self.spawn = self.create_service(Spawn, "spawn", self.spawned)
self.pen = self.create_service(SetPen, "turtle1/set_pen", lambda request, response: response)
for name, value in (("r", 69), ("g", 86), ("b", 255)):
    self.declare_parameter(f"background_{name}", value)
self.twists = self.create_subscription(Twist, "turtle1/cmd_vel", self.moved, 10)
self.poses = self.create_publisher(Pose, "turtle1/pose", 10)
self.colors = self.create_publisher(Color, "turtle1/color_sensor", 10)
self.create_timer(0.1, lambda: (self.poses.publish(Pose(x=5.5)), self.colors.publish(Color(b=255))))
"""
SIM_METHODS = """
def moved(self, twist):
    self.get_logger().info(f"moved by {twist.linear.x}, {twist.angular.z}")
def rotate(self, goal):
    goal.publish_feedback(RotateAbsolute.Feedback(remaining=1.0))
    goal.succeed()
    return RotateAbsolute.Result(delta=-1.5)
def spawned(self, request, response):
    response.name = request.name or "turtle2"
    return response
"""
INTROSPECTED = """
self.declare_parameter("{kind}_configure_introspection", "disabled")
self.side = self.create_{kind}(AddTwoInts, "add_two_ints"{callback})
def configure(parameters):
    states = dict(disabled=State.OFF, metadata=State.METADATA, contents=State.CONTENTS)
    self.side.configure_introspection(self.get_clock(), qos_profile_services_default, states[parameters[0].value])
self.add_post_set_parameters_callback(configure)
configure([self.get_parameter("{kind}_configure_introspection")])
"""
TELEOP = """
self.twist = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
self.turn = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute")
self.create_timer(1.0, lambda: self.twist.publish(Twist()))
"""
ADDING = ", lambda request, response: (setattr(response, 'sum', request.a + request.b), response)[1]"
ASKING = "self.create_timer(0.3, lambda: self.side.call_async(AddTwoInts.Request(a=2, b=3)))"
TURTLE = (
    "from geometry_msgs.msg import Twist\nfrom rclpy.action import ActionClient, ActionServer\n"
    "from std_srvs.srv import Empty\nfrom turtlesim.action import RotateAbsolute\n"
    "from turtlesim.msg import Color, Pose\nfrom turtlesim.srv import SetPen, Spawn"
)
INTS = "from example_interfaces.srv import AddTwoInts"
SAYING = "self.talk = self.create_publisher(String, 'chatter', 10)\nself.create_timer(0.2, self.say)"
SAY = "def say(self):\n    self.get_logger().info(\"Publishing: 'Hello'\")\n    self.talk.publish(String(data='Hello'))"
UNDECLARED = ", allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True"
# module: the node's name, options of it, imports, what it makes, its methods
STAND_INS = {
    "turtlesim.sim": ("turtlesim", "", TURTLE, SIM, SIM_METHODS),
    "turtlesim.mimic": ("mimic", "", "", "pass", ""),
    "turtlesim.teleop": (
        "teleop_turtle",
        "",
        TURTLE,
        TELEOP,
        "",
    ),
    "turtle_tf2_py.any": ("frames", "", "", "pass", ""),
    "demo_nodes_cpp.any": ("listener", "", "", "pass", ""),
    "demo_nodes_cpp.blackboard": ("parameter_blackboard", UNDECLARED, "", "pass", ""),
    "demo_nodes_cpp.talker": ("talker", "", "from std_msgs.msg import String", SAYING, SAY),
    "demo_nodes_cpp.service": (
        "introspection_service", "", INTS, INTROSPECTED.format(kind="service", callback=ADDING), ""
    ),
    "demo_nodes_cpp.client": (
        "introspection_client", "", INTS, INTROSPECTED.format(kind="client", callback="") + ASKING, ""
    ),
}  # fmt: skip
LAUNCHES = """
from launch import LaunchDescription
import launch_ros.actions

def generate_launch_description():
    return LaunchDescription([
        launch_ros.actions.Node(package="{package}", executable=name{more}, output="screen") for name in {names}])
"""
OWN_LAUNCHES = {
    "turtlesim/launch/multisim.launch.py": LAUNCHES.format(
        package="turtlesim", names='["turtlesim_node"] * 2', more=', namespace="turtlesim1"'
    ),
    "demo_nodes_cpp/launch/introspect_services_launch.py": LAUNCHES.format(
        package="demo_nodes_cpp", names='["introspection_service", "introspection_client"]', more=""
    ),
}


def make(folder: Path, documentation: Path) -> None:
    """Write the workspace.

    Args:
        folder: to become the workspace.
        documentation: a clone of ros2/ros2_documentation.
    """
    source = folder / "src"
    make_stand_ins(source)
    for name, text in INTERFACES.items():
        path = folder / "interfaces" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name, (page, needle) in PRINTED.items():
        path = (source if "/" in name else folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(printed(documentation, page, needle))


def make_stand_ins(source: Path) -> None:
    """Write the packages, with the programs that stand in for compiled ones."""
    for package, programs in PROGRAMS.items():
        place = source / package
        (place / package).mkdir(parents=True)
        (place / package / "__init__.py").touch()
        (place / "package.xml").write_text(f"<package><name>{package}</name></package>")
        points = [f"{name} = {package}.{module}:main" for name, module in programs.items()]
        (place / "setup.py").write_text(f"setup(name={package!r}, entry_points={{'console_scripts': {points!r}}})")
    for name, text in OWN_LAUNCHES.items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_text(text)
    for module, (name, options, imports, body, methods) in STAND_INS.items():
        inner = textwrap.indent(body, " " * 8) + "\n" + textwrap.indent(methods, " " * 4)
        package, _, file = module.partition(".")
        text = NODE.format(imports=imports, name=name, options=options, body=inner)
        (source / package / package / f"{file}.py").write_text(text)


def page_text(documentation: Path, page: str) -> str:
    """A page's source, or the text of a file that one includes."""
    path = f"source/{page}" if page.endswith(".py") else f"source/{page}.rst"
    command = ["git", "-C", str(documentation), "show", f"{BRANCH}:{path}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def printed(documentation: Path, page: str, needle: str) -> str:
    """The longest block of code on a page that holds a text.

    Raises:
        ValueError: none does.
    """
    text = page_text(documentation, page)
    if page.endswith(".py"):
        return text
    found = [code for code in blocks(text) if needle in code]
    if not found:
        raise ValueError(f"no code with {needle} on {page}")
    return max(found, key=len)


def blocks(text: str) -> Iterator[str]:
    """The blocks of code of a page: the lines below each directive that are further in than it is."""
    lines = text.expandtabs(8).splitlines()
    for number, line in enumerate(lines):
        if directive := re.match(r"( *)\.\. code-block::", line):
            inside = re.compile(rf" {{{len(directive[1]) + 1},}}|\s*$")
            code = list(itertools.takewhile(inside.match, lines[number + 1 :]))
            options = len(list(itertools.takewhile(str.strip, code)))  # such as :linenos:
            yield textwrap.dedent("\n".join(code[options:])).strip("\n") + "\n"
