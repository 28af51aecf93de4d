"""For those who work on the course itself: the whole test suite in one command."""
