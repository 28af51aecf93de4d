"""Programs for a Python that is to find every namespace refused, as in many containers."""

WITHOUT_NAMESPACES = """
import sys
from pathlib import Path
from course_kit.grading.sandbox import namespaces
try:
    namespaces.enter(0)
    Path("/proc/sys/user/max_user_namespaces").write_text("0")
except OSError:
    pass  # this machine allows none anyhow
"""
COMMAND_WITHOUT_NAMESPACES = f"""{WITHOUT_NAMESPACES}
from course_kit.cli.main import main
sys.exit(main(sys.argv[1:]))
"""
