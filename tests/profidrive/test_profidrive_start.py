"""Parameters of a PROFIdrive drive at the start of the control, against what it counts with."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.profidrive.test_profidrive_machine import SHORT, ids, settings_of

from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig import contents
from axisrig.bench.rig.profidrive.expected import expected_parameters
from axisrig.kernel.nc.text.parser import read_program

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-profidrive.toml"
CHECK = "drive:servo.parameter_check=true"
Run = Callable[..., Machine]


@pytest.fixture
def start(tmp_path: Path) -> Run:
    """Start the shipped rig with a drive whose parameters are other ones than its rig says."""

    def make(*changes: str, silent: bool = False, **values: int) -> Machine:
        (tmp_path / "own.nc").write_text(SHORT, encoding="utf-8")
        machine = Machine(settings_of(*changes), read_program(tmp_path / "own.nc", ("Z",)))
        part: Any = machine.installed[0]
        node = part.ends["Z"].node

        def commission() -> None:
            if silent:
                node.power_off()
            node.parameters.values |= {int(name[1:]): value for name, value in values.items()}

        try:
            machine.scheduler.call_at(1, 0, commission)
            machine.run()
        finally:
            machine.close()
        return machine

    return make


def text(machine: Machine) -> str:
    return str(machine.channel.alarms[0])


@pytest.mark.parametrize(
    ("number", "value", "expected", "source"),
    [
        ("P0922", 3, 5, "telegram of the rig"),
        ("P0880", 3000, 16_384, "P-AXIS-00379"),
        ("P1042", 12, 11, "P-AXIS-00065"),
        ("P0660", 0, 80, "P-AXIS-00516"),
    ],
)
@pytest.mark.provokes(900766, 4, axis="Z")
def test_900766_for_a_parameter_that_the_control_counts_otherwise(
    start: Run, number: str, value: int, expected: int, source: str
) -> None:
    machine = start(CHECK, **{number: value})
    assert ids(machine) == [900766]
    assert f"{number} = {value} and the control counts with {expected}" in text(machine)
    assert source in text(machine)
    part: Any = machine.installed[0]
    assert part.segments["bus"].exchanges == 0


@pytest.mark.parametrize(
    ("change", "number", "source"),
    [
        ("set:Z.antr.profibus.p1042=11", "P1042", "P-AXIS-00316"),
        ("set:Z.antr.profibus.p1043=11", "P1043", "P-AXIS-00317"),
    ],
)
def test_900766_names_the_parameter_of_the_list_that_counts(
    start: Run, change: str, number: str, source: str
) -> None:
    machine = start(CHECK, change, **{number: 10})
    assert ids(machine) == [900766]
    assert source in text(machine)


@pytest.mark.provokes(900767, 4, axis="Z", number="P0922", answer="no answer")
def test_900767_for_a_drive_that_gives_no_answer(start: Run) -> None:
    machine = start(CHECK, silent=True)
    assert ids(machine) == [900767]
    assert "P0922" in text(machine)


@pytest.mark.long
def test_a_drive_with_the_parameters_of_the_list_starts(start: Run) -> None:
    machine = start(CHECK)
    assert ids(machine) == []
    part: Any = machine.installed[0]
    assert part.segments["bus"].exchanges > 0


@pytest.mark.long
def test_without_parameter_check_nothing_is_asked(start: Run) -> None:
    assert ids(start(P0660=0)) == []


def test_what_is_compared_follows_from_list_and_rig() -> None:
    """P-AXIS-00316 before 00065, 00317 where it is set; P0660 where the drive latches."""
    assert expected_parameters(settings_of(), "Z") == ()
    found = expected_parameters(settings_of(CHECK), "Z")
    assert [(each.number, each.value) for each in found] == [
        (922, 5), (880, 16_384), (1042, 11), (660, 80),
    ]  # fmt: skip
    plain = settings_of(CHECK, "set:Z.kenngr.messachse=0", "set:Z.antr.profibus.p1043=11")
    assert [each.number for each in expected_parameters(plain, "Z")] == [922, 880, 1042, 1043]


@pytest.mark.parametrize("bits", [0, 1, 24])
def test_each_number_of_fine_bits_is_compared_and_0_is_one(bits: int) -> None:
    """-1 is the one that says nothing of P-AXIS-00316 and 00317."""
    keys = [f"set:Z.antr.profibus.{key}={bits}" for key in ("p1042", "p1043", "feinaufloesung")]
    for changes, found in (
        (keys[:1], [(1042, bits, "P-AXIS-00316")]),
        (keys[1:2], [(1042, 11, "P-AXIS-00065"), (1043, bits, "P-AXIS-00317")]),
        (keys[2:], [(1042, bits, "P-AXIS-00065")]),
        (keys, [(1042, bits, "P-AXIS-00316"), (1043, bits, "P-AXIS-00317")]),
    ):
        expected = expected_parameters(contents.settings_of(RIG, [CHECK, *changes]), "Z")
        fine = [each for each in expected if each.number in (1042, 1043)]
        assert [(each.number, each.value, each.source) for each in fine] == found
