"""What a learner got wrong: how exits and tracebacks lead to a code; hangs lie in checks, codes in model."""
