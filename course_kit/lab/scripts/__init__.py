"""Unmodified ROS 2 programs as processes beside the kernel."""
