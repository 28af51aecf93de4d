"""What a learner got wrong: the catalogue of codes, and how exits, hangs, exceptions and tracebacks lead to them."""
