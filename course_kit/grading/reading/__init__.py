"""How a file that somebody has handed in becomes a `Submission`."""
