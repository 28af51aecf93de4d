# Read by the terminals of JupyterLab: the user's own set-up first, then the course's Python and the Tab key. They start
# in the learner's folder, where the commands that the course names are meant; `course` is `./course` anywhere.
[ -f ~/.bashrc ] && . ~/.bashrc
[ -n "${COURSE_KIT_SCRIPTS:-}" ] && PATH="$COURSE_KIT_SCRIPTS:$PATH"
command -v register-python-argcomplete >/dev/null && eval "$(register-python-argcomplete ros2)"
course() { course-kit "$@"; }
case "$PWD/" in
  "${COURSE_KIT_FOLDER:-}/notebooks/") cd "$COURSE_KIT_FOLDER" || : ;; # where the launcher is at first
  "${COURSE_KIT_FOLDER:-}"/*) ;;                                       # chosen in the file browser
  *) cd "${COURSE_KIT_FOLDER:-.}" || : ;;
esac
