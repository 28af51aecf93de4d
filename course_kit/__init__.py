"""ROS 2 course kit."""
