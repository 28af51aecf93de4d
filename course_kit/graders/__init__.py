"""One module an exercise, holding only what is particular to it; each says in `CHECKS` what it checks.

Graders speak in checks and probes. They touch neither processes nor files nor sockets.
"""
