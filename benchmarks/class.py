"""A whole class, ours and others': `python benchmarks/class.py [throughput] [right] [rivals] [--quick]`.

`throughput`: 200 mixed submissions (right, wrong, crashing, one in 50 that never ends), all different, by
`course-kit class` with everything it does. `right`: 24 right ones of each exercise with a node.
`rivals`: equal work in the same run for ours, nbgrader, and the lower bound, which is a fork from a warm process; see
`class_work.py` for what they all do and `class_rivals.py` for how.
Without a name: throughput and rivals. Run it on a quiet machine; `--quick` is for small classes, to see that it works.
"""

from __future__ import annotations

import argparse
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from class_rivals import CONTESTANTS, FULL, Ours
from class_submissions import large, mixed, right
from measure import cost_of

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Sequence

    from class_rivals import Contestant
    from class_submissions import Submission

SIZE, QUICK = 200, 50  # the least with one that never ends
RIGHT, EACH, FEW = 12, 24, 6
RIGHT_AIM_S, MIXED_AIM_S = 0.25, 0.25  # ours, wall seconds for each of the 12 and of the 20, start-up included
EACH_AIMS_S = {"temperature_service": 0.25, "move_robot": 0.75, "robot_parameters": 0.75}
PARTS = ("throughput", "right", "rivals")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("part", nargs="*", metavar="PART", choices=[[], *PARTS], help=f"of {', '.join(PARTS)}")
    parser.add_argument("--quick", action="store_true", help="small classes, to see that it works")
    options = parser.parse_args()
    for part in options.part or ("throughput", "rivals"):
        if part == "throughput":
            print_head("mixed submissions")
            contest(Ours, large(QUICK if options.quick else SIZE), 0, None)
        elif part == "right":
            print_head("right submissions of an exercise")
            for exercise, aim_s in EACH_AIMS_S.items():
                contest(Ours, right(FEW if options.quick else EACH, exercise), 0, aim_s)
        else:
            few = FEW if options.quick else None
            print_head("right submissions, one worker")
            rivals(right(RIGHT)[:few], 1, RIGHT_AIM_S)
            print_head("mixed submissions, two workers")
            rivals(mixed()[-(few or len(mixed())) :], 2, MIXED_AIM_S)


def print_head(title: str) -> None:
    heads = f"{'number':>7} {'wall s':>9} {'s each':>8} {'CPU s':>8} {'CPU each':>9} {'full marks':>11}"
    print(f"\n{title}\n\n  {'':<36}{heads}", flush=True)


def rivals(submissions: Sequence[Submission], workers: int, aim_s: float) -> None:
    for kind in CONTESTANTS:
        contest(kind, submissions, workers, aim_s if kind is Ours else None)
    contest(Ours, submissions, 0, aim_s)


def contest(kind: type[Contestant], submissions: Sequence[Submission], workers: int, aim_s: float | None) -> None:
    """Measure one contestant and print its row; `workers` is 0 for ours with its own number of workers."""
    hands = 1 if kind is Ours else workers  # the others have no workers of their own: their work is dealt out
    shares = [submissions[hand::hands] for hand in range(hands)]
    with tempfile.TemporaryDirectory() as folder, ExitStack() as domains:
        sides = [
            kind(Path(folder) / str(hand), domains.enter_context(environment.exclusive_domain()), workers)
            for hand in range(hands)
        ]
        for side, share in zip(sides, shares, strict=True):
            side.prepare(share)
        wall_s, cpu_s = cost_of([side.command(share) for side, share in zip(sides, shares, strict=True)])
        scores = [score for side, share in zip(sides, shares, strict=True) for score in side.scores(share)]
    number, due = len(submissions), sum(one.kind == "right" for one in submissions)
    verdict = "" if aim_s is None else f"  aim {aim_s:g} s each: {'met' if wall_s / number <= aim_s else 'MISSED'}"
    title = kind.title + (f", {workers or 'its own'} workers" if kind is Ours else "")
    print(
        f"  {title:<36}{number:>7} {wall_s:>9.2f} {wall_s / number:>8.3f} {cpu_s:>8.2f} {cpu_s / number:>9.3f} "
        f"{scores.count(FULL[submissions[0].exercise]):>4} of {due:<4}{verdict}",
        flush=True,
    )


if __name__ == "__main__":
    main()
