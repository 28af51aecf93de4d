"""A whole class in one run: who handed in what, graded side by side, and what is written for whom."""
