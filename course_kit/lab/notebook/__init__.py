"""The lab in a Jupyter kernel: output lands in the right cell, interrupts arrive, ROS futures can be awaited."""
