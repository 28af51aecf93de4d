# Read by the terminals of JupyterLab: the user's own set-up first, then the course's Python and the Tab key.
[ -f ~/.bashrc ] && . ~/.bashrc
PATH="$VIRTUAL_ENV/bin:$PATH"
eval "$(register-python-argcomplete ros2)"
