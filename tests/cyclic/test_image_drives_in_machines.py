"""What a machine wires to drives whatever they are on: switches, and names of their telegrams."""

from itertools import pairwise
from pathlib import Path

import pytest

from axisrig.bench.drive.axis.switches import HOME, NEGATIVE, POSITIVE
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
WIRED = """[axis.Z]
limit_positive = "high"
home_switch = "probe"
[plant.high]
fmu = "AxisRig.Sensors.TouchProbe"
start = { surface_mm = 100, inverted = true }
wire = { z = "z" }
"""


def machine_of(folder: Path, rig: str, above: str, *changes: str) -> Machine:
    (folder / "own.nc").write_text("%none\nN10 M30\n", encoding="utf-8")
    base = (RIGS / rig).as_posix()
    (folder / "own.toml").write_text(f'base = "{base}"\n{above}', encoding="utf-8")
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(folder / "own.toml"), assigned)
    return Machine(settings, read_program(folder / "own.nc", ("Z",)))


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    "of",
    ["conventional", "profidrive", "sercos", "lightbus", "encoder-terminal", "ethercat"],
)
def test_a_drive_of_any_family_has_the_switches_of_its_axis(tmp_path: Path, of: str) -> None:
    machine = machine_of(tmp_path, f"probe-z-{of}.toml", WIRED)
    try:
        switches = machine.drives["Z"].switches  # type: ignore[attr-defined]
        assert switches.wired == {POSITIVE, HOME}
        switches.take_edges(machine.scheduler.now_ns)
        on = [name for name in (NEGATIVE, POSITIVE, HOME) if switches.is_on(name)]
        assert on == [POSITIVE]  # the inverted one is high at rest
    finally:
        machine.close()


def test_words_of_a_profidrive_telegram_are_named_in_their_direction(tmp_path: Path) -> None:
    """PROFIdrive, standard telegram 5: 9 words each way, of which some are double."""
    machine = machine_of(tmp_path, "probe-z-profidrive.toml", "")
    try:
        (part,) = machine.installed
        outputs, inputs = part.telegrams("Z")
    finally:
        machine.close()
    assert (outputs.name, outputs.fields) == (
        "outputs", ("STW1", "NSOLL_B", "STW2", "G1_STW", "XERR", "KPC"),
    )  # fmt: skip
    assert (inputs.name, inputs.fields) == (
        "inputs", ("ZSW1", "NIST_B", "ZSW2", "G1_ZSW", "G1_XIST1", "G1_XIST2"),
    )  # fmt: skip


@pytest.mark.parametrize(
    "of",
    ["conventional", "profidrive", "sercos", "lightbus", "encoder-terminal", "ethercat"],
)
def test_states_of_a_drive_of_any_family_are_in_the_results(tmp_path: Path, of: str) -> None:
    """From its start-up to operation, each once and with its time."""
    machine = machine_of(tmp_path, f"probe-z-{of}.toml", "")
    try:
        states = facts_of(machine, machine.run()).axes["Z"].states
    finally:
        machine.close()
    names = [state.state for state in states]
    assert "OPERATION_ENABLED" in names
    assert all(one != other for one, other in pairwise(names))
    times_ns = [state.time_ns for state in states]
    assert times_ns == sorted(times_ns)
    assert len(names) >= 2


@pytest.mark.parametrize("of", ["conventional", "lightbus", "encoder-terminal"])
def test_a_drive_that_only_takes_speeds_needs_a_plant_that_takes_one(
    tmp_path: Path, of: str
) -> None:
    """A KinematicAxis is led by its place: it is refused at the plant of the axis."""
    plant = '[plant.stiff]\nfmu = "AxisRig.Drives.KinematicAxis"\n[axis.Z]\nplant = "stiff"\n'
    with pytest.raises(UserError, match="axis Z: its drive only takes speeds") as refused:
        machine_of(tmp_path, f"probe-z-{of}.toml", plant)
    assert refused.value.value == "stiff"
    assert str(refused.value.file).endswith("own.toml")
    assert refused.value.line == 5
