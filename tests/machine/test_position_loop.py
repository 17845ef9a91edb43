"""A position loop in the CNC: its lag, and how much nearer the axis is to its set position."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import S

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-velocity.toml"
SPEED_MM_S, KV_PER_S, INCREMENT_MM = 10.0, 40.0, 10.0 / 2**20
AGE_S = 600e-6 - 48e-6
"""The NC cycle comes 600 us after the begin of SYNC, which is 44 bits and 4 stuff bits long."""


@pytest.mark.long
def test_the_axis_is_nearer_than_the_lag_by_its_speed_times_the_age(tmp_path: Path) -> None:
    """The actual position is of the SYNC, the lag of the NC cycle after it."""
    path = tmp_path / "move.nc"
    path.write_text("%move\nN10 G90 G01 Z104 F600\nN20 M30\n", encoding="utf-8")
    changes = ("plant:z.position_start_mm=110", "set:Z.getriebe[0].kv=4000")
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(RIG), assigned)
    machine = Machine(settings, read_program(path, ("Z",)))
    part: Any = machine.installed[0]
    link, axis, seen = part.links["Z"], part.nodes["Z"].servo.axis, list[tuple[float, float]]()

    def look(_: object) -> None:
        now_ns, begin_ns = machine.scheduler.now_ns, machine.channel.start_ns
        if begin_ns is not None and 0.4 < (now_ns - begin_ns) / S < 0.5:
            axis.advance_to(now_ns)
            seen.append((link.lag_mm, link.set_mm - 1e3 * axis.motor_position_m()))

    machine.channel.observers.append(look)
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.alarms == []
    assert len(seen) > 90
    for lag_mm, true_mm in seen:
        assert lag_mm == pytest.approx(-SPEED_MM_S / KV_PER_S, abs=1.1 * INCREMENT_MM)
        nearer_mm = SPEED_MM_S * AGE_S
        assert true_mm - lag_mm == pytest.approx(nearer_mm, abs=1.1 * INCREMENT_MM)
