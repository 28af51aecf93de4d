"""Reads what strangers have handed in: the process in which their bytes become text, and nothing else does.

Decoding, JSON, Python's own parser and regular expressions can be made to compute or to fill memory without end. So
whatever interprets a submission runs here, in a fork with limits for each one; `course_kit.grading.reading` has the
handle. It is started often, so it imports the standard library alone, and as little of that as will do.
"""
