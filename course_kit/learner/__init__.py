"""What a learner has of the course: progress, hints, starters, a list, a watched file, their own copy."""
