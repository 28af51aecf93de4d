"""Launch files where launch and launch_ros are not installed: the part of them that the course uses.

`import launch` and `import launch_ros` find what is here only when no real package of that name exists. What is not
here says so in a sentence.
"""
