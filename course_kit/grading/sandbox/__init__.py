"""Where a submission runs: its supervisor, process 1 of its sandbox, what isolates it, and its limits."""
