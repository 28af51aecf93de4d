"""A whole class in one run: who handed in what, graded side by side, and what is written for whom.

`intake` finds the submissions, `run` has them graded by an executor (`local` on this machine, `cluster` on many),
`records` keeps each result the moment it is there. `course_kit.classroom.exports` makes files for others of them.
"""

from __future__ import annotations
