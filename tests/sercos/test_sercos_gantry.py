"""The gantry example of FCT-C4 7.3.1 with SERCOS drives: what the drives have before and behind."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.sercos.service import ident_number

PLANS = Path(__file__).parents[2] / "testplans"
LIMIT, WINDOW = ident_number("S-0-0092"), ident_number("S-0-0159")


@pytest.mark.long
def test_torque_limit_and_lag_monitoring_of_both_sides_are_changed_and_restored() -> None:
    settings = read_settings(
        *read_rig(PLANS / "rigs" / "fixed-stop-gantry-sercos.toml"),
        [
            (parse_assignment(text), as_written)
            for text in ("plant:x.position_start_mm=128", "plant:x2.position_start_mm=28")
        ],
    )
    program = read_program(
        PLANS / "programs" / "fixed-stop-gantry-printed.nc", tuple(settings.rig.axis)
    )
    machine = Machine(settings, program)
    part: Any = machine.installed[0]
    writes: dict[str, list[tuple[int, int]]] = {name: [] for name in settings.rig.axis}

    def note(name: str, ident: int) -> None:
        idents = part.nodes[name].idents
        written = idents.table[ident].changed

        def changed() -> None:
            written()
            writes[name].append((ident, idents.number(ident)))

        idents.table[ident].changed = changed

    for name in writes:
        note(name, LIMIT)
        note(name, WINDOW)
    try:
        machine.run()
    finally:
        machine.close()
    assert [alarm.id for alarm in machine.channel.alarms] == []
    start = [(WINDOW, 1048575), (LIMIT, 10000)]
    program_ = [(LIMIT, 100), (WINDOW, 0), (WINDOW, 1048575), (LIMIT, 10000)]
    assert writes == {
        "X": start + program_,
        "X2": start + program_,
        "Y": start[1:],
        "Z": start[1:],
        "Z2": start[1:],
    }
