"""What the other packages speak of: exercises, submissions, jobs, limits and reports; data, no behaviour."""
