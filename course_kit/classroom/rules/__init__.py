"""What the instructor decides: due dates, overrides, comments, seeds; tables with mistakes told by their lines."""
