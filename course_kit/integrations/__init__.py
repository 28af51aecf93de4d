"""Where the course meets others: IPython, JupyterLab, nbgrader and Otter-Grader."""
