"""What the instructor decides: due dates, overrides, comments, seeds; mistakes are reported with their lines."""
