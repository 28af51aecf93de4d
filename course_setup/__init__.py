"""Makes the Python environments of the course, for `./course`, on the Python that it has found and nothing else.

    .venvs/uv-0.13.9/uv      the installer, where this machine has none
    .venvs/wheels-3f9a1c/    an environment; it is made once and never changed
    .venvs/wheels            link to the one in use where no ROS 2 is sourced
    .venvs/jazzy             link to the one in use where a ROS 2 Jazzy is sourced
    .venvs/lock              locked while a set-up runs
    .venv                    link to the one that `./course` used last, for people and editors

A new environment takes the place of an old one by renaming a link, when it is whole and not before. The old one stays
until the next one is made: a JupyterLab may still run in it.
"""
