"""The solution with one thing wrong each, and which checks see it."""

from __future__ import annotations

from tests.robot_parameters.conftest import EXERCISE, ROOT, Mutant

CORRECT = ROOT / "tests" / "grading" / "correct" / EXERCISE
FORMULA, READ_ONCE = "math.formula", "parameter.read_once"
BAD_CALLBACK, IGNORED = "parameter.bad_callback", "parameter.override_ignored"
MISSING, NO_REASON = "validation.missing", "validation.no_reason"
LIMIT = "            command.linear.x = min(max(command.linear.x, -highest), highest)\n"
WHEEL = "        self.wheel_speed.publish(Float64(data=command.linear.x / radius))\n"
LINE = '        self.status.publish(String(data=f"{name}: {highest} m/s"))\n'
JUDGE = "        self.add_on_set_parameters_callback(self.judge)\n"
LAST = '        self.create_subscription(Twist, "cmd_vel_in", self.limit, 10)\n'
ACCEPTS = "        return SetParametersResult(successful=True)\n"
NAME = '        self.declare_parameter("robot_name", "default_robot")\n'


def mutant(name: str, *changes: tuple[str, str], says: str = "", base: str = "", **failed: str | None) -> Mutant:
    others = {"base": CORRECT / f"{base}.py"} if base else {}
    return Mutant(name, changes, frozenset(failed.items()), says, **others)


MUTANTS = (
    mutant("no_wheel_speed", (WHEEL, ""), says="none on /wheel_speed", reacts="topic.silent"),
    mutant("sleeps", (LIMIT, "            import time; time.sleep(60)\n"), says="stands still in line", reacts=None),
    mutant("never_returns", (LIMIT, "            while True: pass\n"), says="still computing", reacts="limit.time"),
    mutant("raises", (LIMIT, "            raise ValueError(highest)\n"), says="ValueError: 1.0", reacts=None),
    mutant("exits", (LIMIT, "            raise SystemExit\n"), says="SystemExit", reacts=None),
    mutant("one_sided", (LIMIT, LIMIT.replace("max(command.linear.x, -highest)", "command.linear.x")), limits=FORMULA),
    mutant("no_limit", (LIMIT, ""), says="beyond max_velocity=1", limits=FORMULA),
    mutant("sign_lost", (LIMIT, "            command.linear.x = min(abs(command.linear.x), highest)\n"), limits=FORMULA),
    mutant("rest_lost", (LIMIT, f"{LIMIT}            command.angular.z = 0.0\n"), says="look at angular.z", limits=None),
    mutant("wheel_of_input", (LIMIT, f"            asked = command.linear.x\n{LIMIT}"),
           (WHEEL, WHEEL.replace("command.linear.x", 'locals().get("asked", 0.0)')),
           says="the command that came in", wheel_speed=FORMULA),
    mutant("wheel_turns_on", (WHEEL, WHEEL.replace("command.linear.x / radius", "0.5 / radius if "
           'not self.get_parameter("enabled").value else command.linear.x / radius')),
           says="its wheels as well", change_enabled=FORMULA),
    mutant("twice", (WHEEL, WHEEL * 2), says="once for each command", one_each=None),
    mutant("other_form", (LINE, LINE.replace("{name}: ", "{name} ")), says="<name>: <max_velocity> m/s", status=None),
    mutant("no_status", (LINE, ""), says="by a timer", status="topic.silent"),
    mutant("too_slow", ("STATUS_PERIOD = 0.5", "STATUS_PERIOD = 1.0"), says="half a second", status_rate=None),
    mutant("too_fast", ("STATUS_PERIOD = 0.5", "STATUS_PERIOD = 0.25"), says="half a second", status_rate=None),
    mutant("old_status", (LINE, LINE.replace("{name}", "{self.name}")), (LAST, f"        self.name = self.get_parameter("
           f'"robot_name").value\n{LAST}'), says="The line begins with", change_status=None),
    mutant("dynamic_type", (NAME, NAME.replace('robot"', 'robot", ParameterDescriptor(dynamic_typing=True)')),
           says="accepted robot_name=7", wrong_type="parameter.type"),
    mutant("anything_goes", ('"velocity_limiter")', '"velocity_limiter", allow_undeclared_parameters=True)'),
           says="accepted wheel_count_", undeclared="parameter.undeclared"),
    mutant("not_a_number", ("not 0.0 < parameter.value < math.inf", "parameter.value <= 0.0"),
           (", between(0.0, 5.0, \"greatest speed, m/s\")", ""), says="accepted max_velocity=", refuses=MISSING,
           atomic=MISSING),
    mutant("half_a_reason", ('reason="robot_name must not be empty"', 'reason="must not be empty"'),
           says="does not name the parameter", refuses=NO_REASON),
    mutant("keeps_too_soon", ("        for parameter in parameters:\n", "        for parameter in parameters:\n"
           "            if parameter.name == 'wheel_diameter': self.kept = parameter.value\n"),
           ('radius = self.get_parameter("wheel_diameter").value / 2.0', "radius = max(self.kept, 0.001) / 2.0"),
           (", between(0.01, 1.0, \"diameter of a wheel, m\")", ""),
           (ACCEPTS, "        if any(p.name == 'wheel_diameter' and not 0.01 <= p.value <= 1.0 for p in parameters):\n"
           "            return SetParametersResult(successful=False, reason='wheel_diameter: 0.01 .. 1.0')\n" + ACCEPTS),
           says="yet your node acts on it", refuses="parameter.not_atomic", atomic="parameter.not_atomic"),
    mutant("returns_true", (JUDGE, ""), (LAST, JUDGE + LAST), (ACCEPTS, "        return True\n"),
           says="no SetParametersResult", change_velocity=BAD_CALLBACK, change_diameter=BAD_CALLBACK,
           change_enabled=BAD_CALLBACK, change_status=BAD_CALLBACK, atomic=BAD_CALLBACK),
    mutant("returns_nothing_at_once", (ACCEPTS, ""), says="on each declaration", node_up=BAD_CALLBACK),
    mutant("arguments_dropped", ("    rclpy.init()\n", "    rclpy.init(args=[])\n"), says="have others",
           start_arguments=IGNORED, start_file=IGNORED),
    mutant("late_callback", ("        self.add_on_set_parameters_callback(self.on_set)\n", ""),
           ("            if not lowest <= given <= highest:\n", "            if False:\n"),
           ("        self.publisher = ", "        self.add_on_set_parameters_callback(self.on_set)\n        "
           "self.publisher = "), says="would have to refuse", base="main_unguarded", start_invalid=MISSING),
    mutant("silent_fallback", ('            self.get_logger().warning(f"{name}={given} is outside {lowest}..{highest}, '
           'taking {default}")\n', ""), says="Nobody learns", base="main_unguarded", start_invalid=NO_REASON),
    mutant("silent_end", ('        raise SystemExit(f"velocity_limiter cannot start: {problem}") from None\n',
           "        raise SystemExit(1) from problem\n"), says="Nobody learns", start_invalid=NO_REASON),
    mutant("ends_with_a_valid_value", ("0.0 < parameter.value < math.inf", "0.0 < parameter.value <= 2.0"),
           says="Started with values that are valid", change_velocity="validation.overzealous",
           start_arguments="validation.overzealous"),
)  # fmt: skip
