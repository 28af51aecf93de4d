# Read by the terminals of JupyterLab: the user's own set-up first, then the course's Python and the Tab key.
[ -f ~/.bashrc ] && . ~/.bashrc
[ -n "${COURSE_KIT_SCRIPTS:-}" ] && PATH="$COURSE_KIT_SCRIPTS:$PATH"
command -v register-python-argcomplete >/dev/null && eval "$(register-python-argcomplete ros2)"
