"""What a grader is written in: the context of a check, services, goals, topics, parameters and load."""
