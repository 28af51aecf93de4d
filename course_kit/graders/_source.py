"""What the text of a submission gives away; for a diagnosis, never for a point."""

from __future__ import annotations

import ast


def divides_in_integers(source: str) -> bool:
    """Whether `//` stands anywhere in a program."""
    return any(
        isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, ast.FloorDiv)
        for node in ast.walk(ast.parse(source))
    )
