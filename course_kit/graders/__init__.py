"""Graders, one module an exercise: each says in `CHECKS` what it checks, and touches no process, file or socket."""
