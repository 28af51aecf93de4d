"""Where boxes stand: in the order of the flow, apart from each other, and the same each time."""

from __future__ import annotations

from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from course_kit.ros.graph_drawing import BETWEEN_ROWS, lay_out

WIDE, HIGH = 120.0, 40.0


def placed(names: str, arrows: str) -> dict[str, tuple[float, float]]:
    """Boxes of one letter; capitals are channels. Arrows such as "aT Tb"."""
    boxes = {("box", name): (WIDE, HIGH) for name in names}
    pairs = [(("box", one[0]), ("box", one[1])) for one in arrows.split()]
    found = lay_out(boxes, pairs, {box: int(box[1].isupper()) for box in boxes}, ("box", "l"))
    return {name: place for (_, name), place in found.places.items()}


def test_a_flow_goes_from_left_to_right_on_one_line() -> None:
    places = placed("abcST", "aS Sb bT Tc")
    assert [name for name, _ in sorted(places.items(), key=lambda item: item[1])] == list("aSbTc")
    assert len({y for _, y in places.values()}) == 1


def test_an_arrow_back_leads_from_right_to_left_and_the_rest_stays_a_flow() -> None:
    places = placed("abST", "aS Sb bT Ta")
    assert places["a"][0] < places["S"][0] < places["b"][0]


@st.composite
def graphs(draw: st.DrawFn) -> tuple[list[tuple[str, str]], list[tuple[tuple[str, str], tuple[str, str]]]]:
    nodes = [("node", str(number)) for number in range(draw(st.integers(1, 12)))]
    channels = [("topic", str(number)) for number in range(draw(st.integers(1, 12)))]
    pair = st.tuples(st.sampled_from(nodes), st.sampled_from(channels))
    arrows = [one if draw(st.booleans()) else one[::-1] for one in draw(st.lists(pair, max_size=30))]
    return nodes + channels, list(dict.fromkeys(arrows))


@given(graphs())
def test_no_two_boxes_overlap_and_no_line_crosses_a_box(graph: tuple[list, list]) -> None:
    boxes, arrows = graph
    sizes = {box: (90.0 + 7 * len(box[1]), 30.0 + 3 * (int(box[1]) % 5)) for box in boxes}
    found = lay_out(sizes, arrows, {box: int(box[0] != "node") for box in boxes}, ("node", "0"))
    for one, other in combinations(boxes, 2):
        (x, y), (a, b) = found.places[one], found.places[other]
        beside = x + sizes[one][0] < a or a + sizes[other][0] < x
        assert beside or y + sizes[one][1] + BETWEEN_ROWS <= b + 0.01 or b + sizes[other][1] + BETWEEN_ROWS <= y + 0.01
    for (begin, end), way in found.ways.items():
        for x, y in way:
            assert 0 <= x <= found.size[0]
            assert 0 <= y <= found.size[1]
        for box in set(boxes) - {begin, end}:
            left, top = found.places[box]
            inside = [(x, y) for x, y in way if left < x < left + sizes[box][0] and top < y < top + sizes[box][1]]
            assert not inside
