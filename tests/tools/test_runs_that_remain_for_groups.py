"""Which causes of a budget are combined, as the runs of one group leave room for the next."""

import pytest
from tests.tools.test_budget_parts import Game

from axisrig.bench.tools.budget.combining import MOST, USUAL, combined, groups


def chain(on: set[int], *places: int) -> float:
    """Neighbours act on each other, the first two most: 2 um for each place to the end."""
    sizes = range(2 * len(places) - 2, 0, -2)
    pairs = zip(places, places[1:], sizes, strict=False)
    return sum(size * ({one, other} <= on) for one, other, size in pairs)


def of_sizes(*sizes: int) -> Game:
    """One group after the other, each of so many causes."""
    ends = [sum(sizes[: place + 1]) for place in range(len(sizes))]
    parts = [range(end - size, end) for end, size in zip(ends, sizes, strict=True)]
    return Game(sum(sizes), lambda on: sum(chain(on, *part) for part in parts))


@pytest.mark.parametrize(
    ("most", "chosen"),
    [
        (64, [3, 4]),  # 8 and 16
        (24, [3, 4]),
        (23, [3, 3]),  # 15 are left of it: room for 8
        (16, [3, 3]),
        (15, [3, 2]),
        (12, [3, 2]),
        (11, [3, 0]),  # 3 are left: room for one, which is none
        (8, [3, 0]),
        (7, [2, 0]),  # 4 of them for two of three
        (4, [2, 0]),
        (3, [0, 0]),
        (1, [0, 0]),
        (0, [0, 0]),
    ],
)
@pytest.mark.parametrize("turned", [False, True])
def test_a_group_has_as_many_runs_as_the_smaller_one_has_left(
    most: int, chosen: list[int], turned: bool
) -> None:
    """Powers of two; the smaller group comes first, wherever it is."""
    sizes = [4, 3] if turned else [3, 4]
    found = combined(of_sizes(*sizes).runs, 1e-6, most)
    begins = {3: 4 if turned else 0, 4: 0 if turned else 3}
    for size, count in zip((3, 4), chosen, strict=True):
        group = set(range(begins[size], begins[size] + size))
        assert len(group - found.left_out) == count
    assert sum(found.shares_um.values()) == pytest.approx(6.0 + 12.0)


@pytest.mark.parametrize(("most", "second"), [(20, 2), (24, 3), (23, 2), (31, 3), (19, 0)])
def test_a_group_that_is_cut_takes_the_runs_of_what_is_chosen_of_it(most: int, second: int) -> None:
    """Two of five: four of the first take 16 runs, of 32 for all five."""
    found = combined(of_sizes(5, 5).runs, 1e-6, most)
    assert len(set(range(5)) - found.left_out) == 4
    assert len(set(range(5, 10)) - found.left_out) == second


def test_a_cause_alone_takes_no_run_of_the_others() -> None:
    game = Game(5, lambda on: 1.0 * (0 in on) + 2.0 * (1 in on) + chain(on, 2, 3, 4))
    found = combined(game.runs, 1e-6, 8)
    assert found.left_out == frozenset()
    assert {place: found.shares_um[place] for place in (0, 1)} == {0: 1.0, 1: 2.0}


@pytest.mark.parametrize(
    ("most", "chosen"), [(None, 6), (USUAL, 6), (128, 7), (MOST, 8), (4 * MOST, 8)]
)
def test_no_more_runs_are_made_than_the_largest_number_allows(
    most: int | None, chosen: int
) -> None:
    """64 where nobody says more, 256 whatever is asked for."""
    runs = of_sizes(9).runs
    found = combined(runs, 1e-6) if most is None else combined(runs, 1e-6, most)
    assert 9 - len(found.left_out) == chosen


# Who depends on others


@pytest.mark.parametrize("none_um", [0.0, 100.0, -100.0])
def test_an_error_that_no_cause_makes_changes_no_choice_and_no_share(none_um: float) -> None:
    """1 depends by 8 um in turn, 2 by 8 um as the last one, the others by less; room for two."""

    def error_um(on: set[int]) -> float:
        return none_um + 8.0 * (1 in on) * (2 not in on) + 2.0 * ({0, 2} <= on) + ({1, 3} <= on)

    found = combined(Game(4, error_um).runs, 1e-6, 4)
    assert found.left_out == {0, 3}
    assert sum(found.shares_um.values()) == pytest.approx(error_um({0, 1, 2, 3}) - none_um)


@pytest.mark.parametrize("none_um", [0.0, 100.0, -100.0])
def test_who_adds_much_always_is_left_out_before_who_depends_on_others(none_um: float) -> None:
    """0 has 50 um and 1 um with 1; 1 and 2 have 6 um together, and are on as 0 goes off."""

    def error_um(on: set[int]) -> float:
        return none_um + 50.0 * (0 in on) + 1.0 * ({0, 1} <= on) + 6.0 * ({1, 2} <= on)

    found = combined(Game(3, error_um).runs, 1e-6, 4)
    assert found.left_out == {0}
    assert found.shares_um == pytest.approx({0: 51.0, 1: 3.0, 2: 3.0})


def test_a_share_that_differs_between_its_ends_only_depends_on_the_others() -> None:
    """1 has 8 um with 0 and without 2: nothing alone, nothing with all others."""
    game = Game(4, lambda on: 8.0 * ({0, 1} <= on) * (2 not in on) + 3.0 * ({0, 3} <= on))
    found = combined(game.runs, 1e-6)
    assert found.interacting == {0, 1, 2, 3}
    assert found.left_out == frozenset()


@pytest.mark.parametrize(("tolerance_um", "interacting"), [(0.5, {0, 2}), (0.4999, {0, 1, 2})])
def test_a_share_that_depends_by_the_tolerance_does_not(
    tolerance_um: float, interacting: set[int]
) -> None:
    """1 changes by 0.5 um with 0; 0 and 2, which multiply, hold all three in one group."""
    game = Game(3, lambda on: 0.5 * ({0, 1} <= on) + 4.0 * ({0, 2} <= on))
    assert groups(game.runs, tolerance_um) == [[0, 1, 2]]
    assert combined(game.runs, tolerance_um).interacting == interacting
