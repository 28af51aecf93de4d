"""For the author of an exercise: prove its grader, renew its starters, make a student edition."""
