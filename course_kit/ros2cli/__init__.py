"""The `ros2` command of the course: the usual verbs against the live graph, without a ROS installation.

Neither ros2cli nor launch is on PyPI, so this is a subset of them, written for the course. Where a real `ros2`
is installed this one steps aside (`real.py`).
"""
