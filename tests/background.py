"""A command as a script starts it in the background, where Ctrl-C is ignored, by the command's children, too."""

IN_BACKGROUND = ("sh", "-c", 'trap "" INT; exec "$@"', "sh")
