"""What launch files of courses use, found as `launch` and `launch_ros` only where no real package of that name is."""
