"""The distance between drawings."""

from tilenca.shapes.likeness import Likeness
from tilenca.shapes.stretch import stretch

FOUR = ("#..#", "#..#", "####", "...#", "...#")
ZERO = ("####", "#..#", "#..#", "#..#", "####")


def test_a_drawing_is_nearest_to_its_own_class_at_another_size() -> None:
    index = Likeness([FOUR, ZERO])
    larger = stretch(FOUR, 10, 8)
    assert larger is not None
    number, distance = index.nearest(larger)
    assert number == 0
    assert distance < index.distances(larger)[1]


def test_a_drawing_of_the_index_has_no_distance_and_proportions_count() -> None:
    index = Likeness([FOUR, ("#",), ("#", "#", "#", "#")])
    assert index.distances(FOUR)[0] < 1e-2
    assert index.nearest(("#", "#", "#"))[0] == 2
    assert index.nearest(("##", "##"))[0] == 1
