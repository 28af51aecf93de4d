"""The capstone: all together.

- Three programs, `battery.py`, `door.py` and `carrier.py`, each start one node: `battery`, `door` and `carrier`.

| name                 | type                               |                                                        |
|----------------------|------------------------------------|--------------------------------------------------------|
| `/battery`           | `sensor_msgs/msg/BatteryState`     | from `battery` to `carrier`                            |
| `/odometry_distance` | `std_msgs/msg/Float64`             | from `carrier` to `battery`: metres driven so far      |
| `/docked`            | `std_msgs/msg/Bool`                | from `carrier` to `battery`: whether it is at the dock |
| `/door/open`         | `std_srvs/srv/SetBool`             | service of `door`, which `carrier` calls               |
| `/deliver`           | `course_interfaces/action/Deliver` | action of `carrier`                                    |

| parameter          | of        | type         | default |                                                 |
|--------------------|-----------|--------------|---------|-------------------------------------------------|
| `capacity_m`       | `battery` | double       | 100.0   | metres a full battery drives; above 0.0, finite |
| `publish_hz`       | `battery` | double       | 5.0     | messages a second; 1.0 .. 50.0                  |
| `low_fraction`     | `battery` | double       | 0.2     | below it the battery is low; 0.0 .. 1.0         |
| `locked`           | `door`    | bool         | false   |                                                 |
| `opening_s`        | `door`    | double       | 0.5     | seconds                                         |
| `room_names`       | `carrier` | string array | yours   |                                                 |
| `room_distances_m` | `carrier` | double array | yours   | metres from the dock, in the order of the names |
| `speed_mps`        | `carrier` | double       | yours   | metres a second                                 |
| `door_timeout_s`   | `carrier` | double       | yours   | seconds                                         |

- The launch file starts the three programs with `robot.yaml`. Its launch argument `speed` becomes `speed_mps`: `ros2
  launch delivery.launch.py speed:=0.8`.

| in `robot.yaml` |                                                                         |
|-----------------|-------------------------------------------------------------------------|
| `battery`       | `capacity_m` 20.0, `publish_hz` 10.0, `low_fraction` 0.2                |
| `door`          | `locked` false, `opening_s` 0.3                                         |
| `carrier`       | rooms `kitchen` 0.4, `office` 0.8 and `lab` 1.0 m, `door_timeout_s` 2.0 |

- All together deliver, and the battery falls by the metres driven / `capacity_m`. When the door is locked, the next
  delivery ends ABORTED with the door's reason; when `low_fraction` makes the battery low, it is rejected. A delivery
  is cancelled while the door opens.
- The door dies while it opens: the goal ends ABORTED after `door_timeout_s`, as without an answer, and the carrier
  lives on.
- When a door is back, yours or another one, a delivery works again within 5 s. Your launch file may start it again.
- Each program is also run by itself, as a script. It starts its node, spins it and keeps running; `rclpy.init()` sees
  the arguments of the command line.
- A node has to be there within 5 s of the start, after at most 2 s of computing.
- How it is built is up to you: executors, callback groups, names of classes, and modules of your own, `*.py` beside
  the others. The launch file may also start one process with all three nodes; the programs alone still have to work.
- More nodes, topics, services, actions and parameters are allowed.
"""

from pathlib import Path

from launch import LaunchDescription
from launch_ros.actions import Node

FOLDER = Path(__file__).parent
SETTINGS = str(FOLDER / "robot.yaml")


def generate_launch_description():
    # How does the launch argument become a parameter of the carrier?
    return LaunchDescription(
        [
            Node(executable=str(FOLDER / "battery.py"), parameters=[SETTINGS], output="screen"),
            Node(executable=str(FOLDER / "door.py"), parameters=[SETTINGS], output="screen"),
            Node(executable=str(FOLDER / "carrier.py"), parameters=[SETTINGS], output="screen"),
        ]
    )
