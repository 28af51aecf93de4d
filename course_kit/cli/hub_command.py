"""`course-kit hub-singleuser`: what a JupyterHub starts for each user."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import argparse


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "hub-singleuser",
        help="started by a JupyterHub for each user, as its c.Spawner.cmd",
        usage="course-kit hub-singleuser [OPTIONS]",
        description="Makes the user's folder of lessons, or brings it up to date, then starts jupyterhub-singleuser.",
        epilog="OPTIONS go to `jupyterhub-singleuser`.",
    )
    parser.set_defaults(run=run, others=[])


def run(options: argparse.Namespace) -> int:
    """Start a user's server; 2 when that cannot be done."""
    from course_kit.integrations import hub

    return hub.run(options.others)
