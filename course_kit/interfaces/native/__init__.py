"""The C half of the live interfaces, and the Python that loads it."""
