"""Values that are drawn for declared checks."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from course_kit.grading.checks.declared.inputs import drawn, in_turns, problem_of

seeds = st.integers(0, 2**31)
counts = st.integers(1, 50)


@given(seeds, counts, st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_numbers_lie_in_their_range_one_in_each_part(seed: int, count: int, low: float, width: float) -> None:
    high = low + width
    made = drawn([{"a": {"draw": [low, high], "count": count}, "b": 1}], seed, "check")
    values = sorted(one["a"] for one in made)
    assert len(values) == count
    assert low <= values[0]
    assert values[-1] <= high
    slack = width / 100  # digits that nobody would read are left out
    for number, value in enumerate(values):
        assert low + width * number / count - slack <= value <= low + width * (number + 1) / count + slack
    assert [one["b"] for one in made] == [1] * count


@given(seeds, counts)
def test_two_whole_numbers_draw_whole_ones(seed: int, count: int) -> None:
    made = drawn([{"a": {"draw": [-5, 5], "count": count}}], seed, "check")
    assert all(type(one["a"]) is int and -5 <= one["a"] <= 5 for one in made)


@given(seeds)
def test_every_choice_has_its_turn(seed: int) -> None:
    made = drawn([{"a": {"choice": ["x", "y", "z"], "count": 6}}], seed, "check")
    assert sorted(one["a"] for one in made) == ["x", "x", "y", "y", "z", "z"]


@given(seeds)
def test_draws_of_one_table_keep_step(seed: int) -> None:
    (first, second, third, last) = drawn(
        [{"p": {"x": {"draw": [0.0, 1.0], "count": 3}}, "q": [{"draw": [5, 9]}]}, {"p": {"x": 7}}], seed, "check"
    )
    assert last == {"p": {"x": 7}}
    assert len({one["p"]["x"] for one in (first, second, third)}) == 3
    assert all(5 <= one["q"][0] <= 9 for one in (first, second, third))


@given(seeds)
def test_values_follow_from_the_seed_and_the_check(seed: int) -> None:
    table = [{"a": {"draw": [0.0, 1e9], "count": 5}}]
    assert drawn(table, seed, "one") == drawn(table, seed, "one")
    assert drawn(table, seed, "one") != drawn(table, seed, "two")
    assert drawn(table, seed, "one") != drawn(table, seed + 1, "one")


def test_a_range_without_an_end_is_refused() -> None:
    assert "lowest and the highest" in problem_of({"draw": [0.0, float("inf")]})
    assert "lowest and the highest" in problem_of({"draw": [float("nan"), 1.0]})
    assert "with something in it" in problem_of({"choice": []})
    assert "A drawn value is" in problem_of({"draw": [0, 1], "choice": [1]})


def test_in_turns_one_of_each_table_comes_after_the_other() -> None:
    assert in_turns(["a1", "a2", "a3", "b1", "c1", "c2"], [3, 1, 2]) == ["a1", "b1", "c1", "a2", "c2", "a3"]
