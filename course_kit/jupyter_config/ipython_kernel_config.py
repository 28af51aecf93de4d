"""Read by every IPython kernel of this environment, as `etc/ipython/ipython_kernel_config.py`: see `at_start`."""

c = get_config()  # type: ignore[name-defined] # noqa: F821 - IPython's own way to give a configuration to its file
c.InteractiveShellApp.extensions.append("course_kit.integrations.at_start")
