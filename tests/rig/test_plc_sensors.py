"""The table `[plc]` of a rig: variables that the PLC reads from distance sensors."""

from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.distance.sensors import sensors_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program

BASE = Path(__file__).parents[2] / "testplans" / "rigs" / "distance-z.toml"


def settings_of(folder: Path, table: str, *assignments: str):
    path = folder / "rig.toml"
    path.write_text(f'base = "{BASE.as_posix()}"\n[plc]\n{table}\n', encoding="utf-8")
    changes = [(parse_assignment(text), as_written) for text in assignments]
    return read_settings(*read_rig(path), changes)


def refusal(folder: Path, table: str, *assignments: str) -> UserError:
    def build() -> None:
        settings = settings_of(folder, table, *assignments)
        Machine(settings, parse_program("M30", axes=("Z",))).close()

    with pytest.raises(UserError) as error:
        build()
    return error.value


@pytest.mark.parametrize(
    ("table", "words", "line"),
    [
        ('"SENSOR" = { sensor = "gap" }', "unknown rig key plc.SENSOR", 3),
        ('"V.E.1" = { sensor = "gap" }', 'in quotes: "V.E.SENSOR"', 3),
        ('"V.E.S" = { sensor = "gab" }', "V.E.S: sensor names nothing in this rig", 3),
        ('"V.E.S" = { sensor = "z" }', "V.E.S: sensor must name a distance sensor", 3),
        ('"V.E.S" = { sensor = "gap", delay_cycles = 21 }', "less than or equal to 20", 3),
        ('"V.E.S" = { sensor = "gap", sign = 0 }', "1 or -1", 3),
        ('"V.E.S" = { sensor = "gap", unit_mm = 1 }', "unknown rig key", 3),
        ('"V.E.S" = { unit_um = 1.0 }', "lacks the key", 3),
    ],
)
def test_a_table_that_cannot_be_is_refused_with_its_line(
    tmp_path: Path, table: str, words: str, line: int
) -> None:
    error = refusal(tmp_path, table)
    assert words in error.message
    assert (Path(error.file).name, error.line) == ("rig.toml", line)


def test_a_variable_that_a_sensor_writes_cannot_be_written_by_the_plan(tmp_path: Path) -> None:
    error = refusal(tmp_path, '"V.E.S" = { sensor = "gap" }', "plc:V.E.S=5")
    assert "reads that variable from a sensor" in error.message


def test_unit_and_sign(tmp_path: Path) -> None:
    table = (
        '"V.E.UM" = { sensor = "gap", unit_um = 1.0 }\n"V.E.NEG" = { sensor = "gap", sign = -1 }'
    )
    settings = settings_of(tmp_path, table, "plant:gap.workpiece.plane.level_mm=29.50034")
    machine = Machine(settings, parse_program("G04 0.01\nM30", axes=("Z",)))
    try:
        machine.run()
    finally:
        machine.close()
    assert machine.channel.plc.values == {"UM": 2500.0, "NEG": -24997.0}


@pytest.mark.parametrize(
    ("base", "age", "late"), [("distance-z.toml", 0, 0), ("distance-z-ethercat.toml", -1, 1)]
)
def test_a_variable_is_newer_than_6064_where_the_carrier_brings_that_a_cycle_later(
    tmp_path: Path, base: str, age: int, late: int
) -> None:
    """The PLC reads its sensor as it is at the last SYNC. On a line the frame at the begin of a
    cycle brings the position of the SYNC0 in the cycle before (docs/ethercat.md).
    """
    path = tmp_path / "rig.toml"
    for delay in (0, 3):
        entry = f'"V.E.SENSOR" = {{ sensor = "gap", delay_cycles = {delay} }}'
        path.write_text(
            f'base = "{(BASE.parent / base).as_posix()}"\n[plc]\n{entry}\n', encoding="utf-8"
        )
        found = [
            s for s in sensors_of(read_settings(*read_rig(path), []), "Z") if "V.E." in s.words
        ]
        assert [(sensor.age, sensor.late) for sensor in found] == [(delay + age, late)]
