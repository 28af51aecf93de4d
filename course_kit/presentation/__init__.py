"""Demos and lessons in front of a class: a projected page, and a second window with the speaker's notes.

The projected page is JupyterLab, because that is what the course installs; Notebook 7 comes only with the test tools.
"""
