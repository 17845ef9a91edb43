"""Delay from an edge to the reaction of the CNC with a SERCOS drive, at random instants.

The drive has latched t_d after the edge; the AT of the next SYNC0 shows it, the frame at the begin
of the next cycle brings it, and the NC cycle of that one sees it: with SYNC0 at m T + s and the NC
cycle at o, m the first with m T + s >= t + t_d, it is at (m + 1) T + o.
"""

import random
from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
MS, US = 1_000_000, 1_000
DELAY_NS, SHIFT_NS = 4 * US, 100 * US


def touches(count: int, numbers: random.Random) -> str:
    lines = ["%touches"]
    for number in range(1, count + 1):
        start = 100.2 + numbers.random() * 0.05
        lines.append(f"N{number}0 G01 G90 Z{start:.5f} F6000")
        lines.append(f"N{number}5 G100 Z99 F600")
    return "\n".join([*lines, "N99999 M30", ""])


@pytest.mark.parametrize(
    ("rig", "period_ns", "offset_ns", "count"),
    [
        pytest.param("probe-z-sercos", MS, 600 * US, 8),
        pytest.param("probe-z-sercos", MS, 600 * US, 400, marks=pytest.mark.long),
        pytest.param("probe-z-sercos-4ms", 4 * MS, 2400 * US, 400, marks=pytest.mark.long),
    ],
)
@pytest.mark.long
def test_each_edge_is_seen_in_the_cycle_of_the_formula(
    tmp_path: Path, rig: str, period_ns: int, offset_ns: int, count: int
) -> None:
    (tmp_path / "own.nc").write_text(touches(count, random.Random(37)), encoding="utf-8")
    changes = (
        "plant:z.position_start_mm=100.3", "plant:z.kv=100", "plant:z.feed_forward=1",
        "set:Z.getriebe[0].window=500",
    )  # fmt: skip
    settings = read_settings(
        *read_rig(RIGS / f"{rig}.toml"), [(parse_assignment(text), as_written) for text in changes]
    )
    machine = Machine(settings, read_program(tmp_path / "own.nc", ("Z",)))
    signal = machine.plant.probes["probe"].signal
    edges: list[int] = []

    def note(time_ns: int) -> None:
        if signal.level:
            edges.append(time_ns)

    signal.watches.append(note)
    try:
        machine.run()
    finally:
        machine.close()
    assert [alarm.id for alarm in machine.channel.alarms] == []
    assert len(machine.channel.records) == count
    phases = set()
    for record in machine.channel.records:
        assert record.start_ns is not None
        edge_ns = next(each for each in edges if each > record.start_ns)
        sync = -(-(edge_ns + DELAY_NS - SHIFT_NS) // period_ns)
        assert record.signal_ns == (sync + 1) * period_ns + offset_ns
        phases.add((edge_ns % period_ns) * 10 // period_ns)
    assert count < 100 or phases == {*range(10)}
