"""A whole class, ours and others': `python benchmarks/class.py [throughput] [right] [rivals] [options]`.

`throughput`: N mixed submissions (right, wrong, crashing, one in 50 that never ends), all different, by
`course-kit class` with everything it does. `right`: 24 right ones of each exercise with a node.
`rivals`: equal work in the same run for ours, nbgrader, Otter (where it is installed), and the lower bound, which is a
fork from a warm process; see `class_work.py` for what they all do and `class_rivals.py` for how.
Without a name: throughput and rivals. Run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from class_rivals import CONTESTANTS, FULL, Ours
from class_submissions import large, mixed, right
from class_usage import measure

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Sequence

    from class_submissions import Submission
    from class_usage import Usage

SIZE = 200
QUICK = 50  # with one that never ends
RIGHT = 12
TWENTY = 20
FEW = 6  # the last of the mixed ones: two right, two wrong, one crashes, one never ends
RIGHT_AIM_S = 0.16  # ours, wall seconds for each of 12 right submissions, start-up included
MIXED_AIM_S = 5.0  # ours, wall seconds for the 20 mixed ones with two workers
TWO = 2
EACH = 24  # of `right`
EACH_AIMS_S = {"temperature_service": 0.16, "move_robot": 0.32, "robot_parameters": 0.32}
PARTS = ("throughput", "right", "rivals")
HEAD = f"{'wall s':>9} {'s each':>8} {'CPU s':>8} {'CPU each':>9} {'peak MB':>8}"


def main() -> None:
    options = _options()
    for part in options.part or ("throughput", "rivals"):
        if part == "throughput":
            throughput(QUICK if options.quick else options.size, options.workers)
        elif part == "right":
            each(FEW if options.quick else EACH, options.workers)
        else:
            few = FEW if options.quick else None
            rivals(options.only or list(CONTESTANTS), right(RIGHT)[:few], mixed()[-(few or TWENTY) :])


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("part", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--size", type=int, default=SIZE, help=f"submissions of `throughput` ({SIZE})")
    parser.add_argument("--workers", type=int, default=0, help="of ours in `throughput` and `right` (its default)")
    parser.add_argument("--only", action="append", choices=CONTESTANTS, help="of `rivals`, this row; repeatedly")
    parser.add_argument("--quick", action="store_true", help="small classes, to see that it works")
    options = parser.parse_args()
    if unknown := set(options.part) - set(PARTS):
        parser.error(f"there is no part {', '.join(sorted(unknown))}")
    return options


def throughput(size: int, workers: int) -> None:
    print(f"{size} mixed submissions\n\n  {'':<36}{HEAD}", flush=True)
    _ours(large(size), workers, "all")
    print()


def each(number: int, workers: int) -> None:
    print(f"{number} right submissions of an exercise\n\n  {'':<36}{HEAD}", flush=True)
    for exercise, aim_s in EACH_AIMS_S.items():
        _ours(right(number, exercise), workers, f"{exercise}, aim {aim_s:g} s each")
    print()


def _ours(submissions: Sequence[Submission], workers: int, title: str) -> None:
    """Grade a class with ours and print the row."""
    with tempfile.TemporaryDirectory() as folder:
        ours = Ours(Path(folder) / "ours", 0, workers)
        ours.prepare(submissions)
        usage = measure([ours.queue(submissions)])
        reports = ours.reports()
        log = (ours.folder / "log").read_text(encoding="utf-8", errors="replace").strip().splitlines()
    _print_row(title, usage, len(submissions))
    print(f"    {log[-2] if len(log) > 1 else log}", flush=True)
    wrong = [one.student for one in submissions if (one.kind == "right") != _is_full(reports, one)]
    if wrong:
        print(f"    WRONG: {', '.join(wrong)} have another grade than they should")


def _is_full(reports: dict[str, dict[str, object]], one: Submission) -> bool:
    report = reports.get(one.student, {"score": None, "max_score": FULL})
    return report["score"] == report["max_score"]


def rivals(names: Sequence[str], correct: Sequence[Submission], twenty: Sequence[Submission]) -> None:
    for submissions, workers, aim in (
        (correct, 1, RIGHT_AIM_S * len(correct)),
        (twenty, TWO, MIXED_AIM_S * len(twenty) / TWENTY),
    ):
        kinds = "right" if submissions is correct else "mixed"
        print(f"{len(submissions)} {kinds} submissions, {workers} worker(s)\n\n  {'':<36}{HEAD} {'full marks':>11}")
        for name in names:
            if CONTESTANTS[name].missing():
                print(f"  {CONTESTANTS[name].title:<36}   not installed")
                continue
            _contest(name, submissions, workers, aim)
            if name == "ours":
                _contest(name, submissions, 0, aim)
        print(flush=True)


def _contest(name: str, submissions: Sequence[Submission], workers: int, aim: float) -> None:
    """Measure one contestant and print its row; `workers` is 0 for ours with its own number of workers."""
    kind = CONTESTANTS[name]
    hands = 1 if kind is Ours else workers  # the others have no workers of their own: their work is dealt out
    shares = [submissions[hand::hands] for hand in range(hands)]
    with tempfile.TemporaryDirectory() as folder, ExitStack() as domains:
        sides = [
            kind(Path(folder) / str(hand), domains.enter_context(environment.exclusive_domain()), workers)
            for hand in range(hands)
        ]
        for side, share in zip(sides, shares, strict=True):
            side.prepare(share)
        usage = measure([side.queue(share) for side, share in zip(sides, shares, strict=True)])
        scores = [score for side, share in zip(sides, shares, strict=True) for score in side.scores(share)]
    due = sum(one.kind == "right" for one in submissions)
    verdict = f"{scores.count(FULL):>4} of {due:<4}"
    if kind is Ours:
        verdict += f"  aim {aim:g} s: {'met' if usage.wall_s <= aim else 'MISSED'}"
    title = kind.title + (f", {workers or 'its own'} workers" if kind is Ours else "")
    _print_row(title, usage, len(submissions), verdict)


def _print_row(title: str, usage: Usage, number: int, verdict: str = "") -> None:
    cells = (
        f"{usage.wall_s:>9.2f} {usage.wall_s / number:>8.3f} {usage.cpu_s:>8.2f} {usage.cpu_s / number:>9.3f} "
        f"{usage.memory_mb:>8.0f}"
    )
    print(f"  {title:<36}{cells} {verdict:>11}".rstrip(), flush=True)


if __name__ == "__main__":
    main()
