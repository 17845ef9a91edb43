"""Which of the things in its window a fault hits: skip, count and share."""

import random

from axisrig.bench.bus.hits import Hits, Window


def test_hits_fall_in_their_window_after_their_skip_and_up_to_their_count() -> None:
    window = Window(is_open=False)
    hits = Hits(window, skip=2, count=3)
    assert [hits.falls() for _ in range(4)] == [False] * 4  # none of these is counted
    window.begin()
    assert [hits.falls() for _ in range(4)] == [False, False, True, True]
    window.end()
    assert [hits.falls() for _ in range(4)] == [False] * 4
    window.begin()
    assert [hits.falls() for _ in range(4)] == [True, False, False, False]


def test_a_share_of_hits_is_drawn_and_counted_by_hits_alone() -> None:
    drawn = random.Random(5)
    expected = [drawn.random() < 0.25 for _ in range(400)]
    free = Hits(numbers=random.Random(5), share=0.25)
    assert [free.falls() for _ in range(400)] == expected
    few = Hits(numbers=random.Random(5), share=0.25, count=10)
    found = [few.falls() for _ in range(400)]
    last = [number for number, is_hit in enumerate(expected) if is_hit][9]
    assert found == [is_hit and number <= last for number, is_hit in enumerate(expected)]
    assert not any(Hits(count=0).falls() for _ in range(3))
    assert not any(Hits(share=0.0).falls() for _ in range(3))
