"""The one layer between the course kit and rclpy."""
