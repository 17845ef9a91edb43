"""Meters of several EtherCAT lines that read one journal."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.journal import Journal
from axisrig.bench.machine.ethercat.line_meter import LineMeters
from axisrig.kernel.time.clock import MS

SHORTEST, INDEX = 60, 17
"""Bytes of the shortest frame, 6.72 us on the wire, and where its index is."""


@pytest.mark.interpreted
def test_figures_of_a_line_have_its_own_frames_and_those_that_wait_in_the_journal() -> None:
    """Each time they are asked for; frames of two lines are kept apart by the segment."""

    def line(name: str) -> Any:
        return SimpleNamespace(
            nodes={}, segment=SimpleNamespace(name=name),
            master=SimpleNamespace(image_in=lambda frame: 0 if frame[-1] else None),
        )  # fmt: skip

    journal, clock = Journal(), SimpleNamespace(now_ns=0)
    meters = LineMeters([line("one"), line("two")], clock, journal)  # type: ignore[arg-type]
    frame = bytearray(SHORTEST)
    frame[INDEX], frame[-1] = 0x80, 1
    counts = []
    for number, names in enumerate((["one"], ["two", "one"], ["two"]), 1):
        journal.entries += [(number * MS, name, bytes(frame), False) for name in names]
        counts.append((meters["one"].back, meters["two"].back))
    assert counts == [(1, 0), (2, 1), (2, 2)]
    assert meters["two"].load_pct(10 * MS) == pytest.approx(100 * 2 * 6720 / (10 * MS))
