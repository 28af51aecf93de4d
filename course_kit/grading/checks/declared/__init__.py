"""Checks that an exercise declares in its exercise.toml, as `[[checks]]`, instead of writing them in Python.

`loading` turns the tables into `Declaration`s when an exercise is loaded, and finds all mistakes of the author, each
with its line. In the grader process `building` makes a `Check` of each declaration; what one does is in `services`,
`topics`, `parameters` and `goals`, which speak through the same verbs as the checks of a Python module.
"""
