"""Feedholds of the path beside the blocks of a program: `held_ns` and `waited_ns` of a table."""

from pathlib import Path

import pytest
from tests.recordings import Step, block_trace, facts

from axisrig.bench.record.blocks import held_ns
from axisrig.bench.record.facts import run_text
from axisrig.kernel.time.clock import MS
from axisrig.results.loading import load

Hold = tuple[int, int]


@pytest.mark.parametrize(
    ("holds", "held"),
    [
        ([], 0),
        ([(10, 20)], 10),  # the interval itself
        ([(0, 30)], 10),  # around it
        ([(12, 15)], 3),
        ([(5, 12)], 2),
        ([(18, 30)], 2),
        ([(0, 10)], 0),  # it ends where the interval begins
        ([(20, 30)], 0),
        ([(0, 9)], 0),
        ([(21, 30)], 0),
        ([(0, 11), (13, 14), (19, 30)], 3),
        ([(15, 15)], 0),
    ],
)
def test_a_feedhold_counts_as_far_as_it_is_within_an_interval(holds: list[Hold], held: int) -> None:
    """The interval is 10 .. 20."""
    assert held_ns(holds, 10, 20) == held


def test_an_interval_without_length_was_never_held() -> None:
    assert held_ns([(0, 30)], 10, 10) == 0


def blocks_of(folder: Path, steps: list[Step], holds: list[Hold]) -> list[tuple[float, float]]:
    """What each block of a run waited and was held, ms."""
    (folder / "cases.csv").write_text("run,verdict\nr1,pass\n", encoding="utf-8")
    (folder / "results.csv").write_text("run,metric,verdict\n", encoding="utf-8")
    (folder / "runs").mkdir()
    trace = block_trace(steps, [(begin * MS, end * MS) for begin, end in holds])
    (folder / "runs" / "r1.json").write_text(run_text(facts(blocks=trace)), encoding="utf-8")
    table = load(folder).blocks("r1")
    pairs = zip(table["waited_ns"] / MS, table["held_ns"] / MS, strict=True)
    return [(float(waited), float(held)) for waited, held in pairs]


@pytest.mark.parametrize(
    ("holds", "waited_held"),
    [
        ([], [(0, 0), (4, 0), (0, 0)]),
        ([(7, 9)], [(0, 0), (4, 0), (0, 0)]),  # while the second one waits
        ([(7, 12)], [(0, 0), (4, 2), (0, 0)]),  # it begins in the feedhold
        ([(9, 10)], [(0, 0), (4, 0), (0, 0)]),
        ([(12, 14)], [(0, 0), (4, 2), (0, 0)]),
        ([(14, 25)], [(0, 0), (4, 1), (0, 10)]),  # on to the next block
        ([(3, 28)], [(0, 3), (4, 5), (0, 13)]),
        ([(1, 2), (7, 8), (11, 12), (16, 19)], [(0, 1), (4, 1), (0, 3)]),
    ],
)
def test_a_block_is_held_from_its_begin_on_and_waits_before(
    holds: list[Hold], waited_held: list[tuple[float, float]], tmp_path: Path
) -> None:
    """Blocks of 0 .. 6, 10 .. 15 (the next one from 6 on) and 15 .. 30 ms."""
    steps = [
        Step("N10 G1 Z5", "feed", 0, 0, 6),
        Step("N20 G1 Z9", "feed", 6, 10, 15),
        Step("N30 G4 X1", "dwell", 15, 15, 30),
    ]
    assert blocks_of(tmp_path, steps, holds) == waited_held


def test_a_block_that_never_began_was_never_held(tmp_path: Path) -> None:
    """The program ended while it waited: its begin is its end."""
    steps = [Step("N10 G1 Z5", "feed", 2, 8, 8, "not begun")]
    assert blocks_of(tmp_path, steps, [(1, 20)]) == [(6, 0)]
