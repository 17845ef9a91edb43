"""What a machine knows of its program and PLC side: measuring targets, new zeros, who writes."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import settings_of

from axisrig.bench.machine.machine import Machine
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.canon import DistanceCommand, Dwell, MeasuringRun
from axisrig.kernel.nc.text.parser import read_program


@pytest.mark.parametrize(
    ("rig", "changes", "constant"),
    [
        ("probe-z.toml", (), True),
        ("probe-z.toml", ("plc:V.E.A=0",), True),
        ("probe-z.toml", ("plc:V.E.A=0; 1 at=M50",), False),
        ("distance-z-variable.toml", (), False),  # the PLC reads a sensor
        ("plc-signal.toml", (), False),  # its task may write
    ],
)
def test_the_plc_side_is_constant_where_nobody_there_writes(
    rig: str, changes: tuple[str, ...], constant: bool, tmp_path: Path
) -> None:
    """Else a program that asks again and again must let time pass."""
    program = tmp_path / "p.nc"
    program.write_text("%p\nN10 M30\n", encoding="utf-8")
    settings = settings_of(rig, *changes)
    machine = Machine(settings, read_program(program, tuple(settings.rig.axis)))
    try:
        assert machine._interpreter._waiting.is_constant is constant
    finally:
        machine.close()


@pytest.mark.interpreted
def test_where_measuring_blocks_lead_and_whose_zero_is_new_is_noted() -> None:
    """A block that comes again counts with its last target."""
    machine: Any = SimpleNamespace(measuring_targets={}, referenced=set())
    blocks = {n: Block(n, 10 * n, f"N{10 * n}") for n in (1, 2, 3)}

    def run(number: int, z_mm: float) -> MeasuringRun:
        return MeasuringRun(blocks[number], {"Z": z_mm}, ("Z",), ("Z",), 600.0, 1)

    commands: list[Any] = [
        run(1, 5.0), Dwell(blocks[3], 1), run(2, 6.0), run(1, 7.0),
        DistanceCommand(blocks[3], "Z", "ref"), DistanceCommand(blocks[3], "Y", "on"),
        DistanceCommand(blocks[3], None, "ref"),
    ]  # fmt: skip
    assert [*Machine._noted(machine, iter(commands))] == commands
    assert machine.measuring_targets == {
        str(blocks[1]): {"Z": 7.0}, str(blocks[2]): {"Z": 6.0},
    }  # fmt: skip
    assert machine.referenced == {"Z", "channel"}
