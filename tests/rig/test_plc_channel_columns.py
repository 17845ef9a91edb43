"""Columns of the PLC side that act on the channel: override, reset, program start."""

from pathlib import Path

import pytest

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment, parse_column
from axisrig.bench.rig.plc.channel_words import ProgramStart, Reset, channel_columns
from axisrig.bench.rig.plc.override import OverrideCourse
from axisrig.bench.rig.plc.words import Moment, Rule, read_rules
from axisrig.bench.rig.programs import programs_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml"


def rules(column: str, cell: str) -> list[Rule]:
    return read_rules(parse_column(f"plc:{column}", cell), ["Z"])[1]


def settings(*assignments: str) -> Settings:
    table, files = read_rig(RIG)
    return read_settings(table, files, [(parse_assignment(a), as_written) for a in assignments])


def test_every_column_of_the_table_is_read_as_its_example_is_written() -> None:
    for name, row in channel_columns().items():
        assert len(rules(name, row.cell)) == row.cell.count(";") + 1


def test_an_override_of_the_path_is_a_set_value() -> None:
    first, second = rules("override", "50; 200 at=motion+20ms over=100ms")
    assert first.action == OverrideCourse(None, 500)
    assert second.action == OverrideCourse(None, 2000, 100 * MS)
    assert second.moment == Moment("motion", None, 20 * MS)


def test_reset_and_start_act_once_unless_told_which_one() -> None:
    (reset,) = rules("reset", "at=M50+20ms")
    assert (reset.action, reset.nth) == (Reset(), 1)
    first, second = rules("program_start", "at=reset+100ms; at=program_end nth=2 file=second.nc")
    assert (first.action, first.nth) == (ProgramStart(None), 1)
    assert (second.action, second.nth) == (ProgramStart("second.nc"), 2)


@pytest.mark.parametrize(
    ("column", "cell", "says"),
    [
        ("override", "201", "0 to 200"),
        ("override", "99.95", "steps of 0.1"),
        ("override", "at=M50", "one value and its keys"),
        ("override", "50 for=3ms", "no such key"),
        ("reset", "1 at=M50", "a reset has no value"),
        ("reset", "nth=1", "a reset needs its moment"),
        ("reset", "at=M50 file=x.nc", "no such key"),
        ("program_start", "second.nc at=reset", "a program_start has no value"),
        ("program_start", "file=second.nc", "a program_start needs its moment"),
    ],
)
def test_what_cannot_be_is_refused_in_words(column: str, cell: str, says: str) -> None:
    with pytest.raises(UserError) as caught:
        rules(column, cell)
    assert says in str(caught.value)


def test_programs_that_are_started_lie_beside_that_of_the_run(tmp_path: Path) -> None:
    for name in ("first.nc", "second.nc"):
        (tmp_path / name).write_text(f"%{name[:-3]}\nN10 M30\n", encoding="utf-8")
    cells = settings("plc:program_start=at=program_end file=second.nc; at=reset")
    first = read_program(tmp_path / "first.nc", ("Z",))
    found = programs_of(cells, first)
    assert {file: program.name for file, program in found.items()} == {
        None: "first",
        "second.nc": "second",
    }
    several = "at=program_end file=second.nc; at=reset file=first.nc; at=M50 file=second.nc"
    found = programs_of(settings(f"plc:program_start={several}"), first)
    assert list(found) == [None, "second.nc", "first.nc"]  # in the order of their cells
    assert list(programs_of(settings(), first)) == [None]
    (tmp_path / "third.nc").write_text("%third\nN10 X[\nN20 M30\n", encoding="utf-8")
    with pytest.raises(UserError) as caught:
        programs_of(settings("plc:program_start=at=reset file=third.nc"), first)
    assert (caught.value.file, caught.value.line) == (str(tmp_path / "third.nc"), 2)
    assert "plc:program_start" not in str(caught.value)
    (tmp_path / "third.nc").unlink()
    missing = settings("plc:program_start=at=program_end file=third.nc")
    with pytest.raises(UserError, match=r"plc:program_start.*third.nc"):
        Machine(missing, first)
