"""A PROFIdrive drive in a machine: what is refused, alarms of its start and of its interface."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.machine.cyclic.profidrive_drive import profidrive_settings
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.cia402.ds402 import State

RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z-profidrive.toml"
SHORT = "%short\nN10 G01 G90 Z129.9 F3000\nN20 M30\n"
PROBE = "%probe\nN10 G100 G90 Z{target} F3000\nN20 M30\n"
NEAR = "plant:probe.surface_mm=129"

Run = Callable[..., Machine]


def settings_of(*changes: str) -> Settings:
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(RIG), assigned)
    check_rig(settings)
    return settings


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run a program with the shipped rig. changes: of its keys. before: called with the machine."""

    def make(
        program: str, *changes: str, before: Callable[[Machine], None] | None = None
    ) -> Machine:
        (tmp_path / "own.nc").write_text(program, encoding="utf-8")
        machine = Machine(settings_of(*changes), read_program(tmp_path / "own.nc", ("Z",)))
        try:
            if before is not None:
                before(machine)
            machine.run()
        finally:
            machine.close()
        return machine

    return make


def ids(machine: Machine) -> list[int]:
    return [alarm.id for alarm in machine.channel.alarms]


def part_of(machine: Machine) -> Any:
    return machine.installed[0]


@pytest.mark.provokes(70344, 5, axis="Z", mode="DSC_POSITION_CONTROL")
def test_70344_for_dsc_without_gain_in_the_telegram(run: Run) -> None:
    mode = "set:Z.antr.operation_mode=DSC_POSITION_CONTROL"
    assert ids(run(SHORT, "drive:servo.telegram=3", mode)) == [70344]


@pytest.mark.provokes(70346, 5, axis="Z", mode="DRIVE_POSITION_CONTROL")
def test_70346_for_a_set_position_that_no_telegram_has(run: Run) -> None:
    mode = "set:Z.antr.operation_mode=DRIVE_POSITION_CONTROL"
    assert ids(run(SHORT, mode)) == [70346]


@pytest.mark.provokes(900763, 7, axis="Z", code="6")
@pytest.mark.long
def test_900763_for_an_input_that_the_drive_does_not_have(run: Run) -> None:
    """The control allows input 2, the drive has one probe: error 6, and never a value."""
    program = "%two\nN10 #MEAS [AX=Z INPUT=2]\nN20 G100 G90 Z128 F3000\nN30 M30\n"
    machine = run(program, NEAR)
    assert ids(machine) == [900763]
    assert not part_of(machine).links["Z"].has_latched


@pytest.mark.provokes(900765, 7, axis="Z")
@pytest.mark.long
def test_900765_for_homing(run: Run) -> None:
    assert ids(run("%home\nN10 G74 Z1\nN20 M30\n")) == [900765]


@pytest.mark.long
def test_a_sign_of_life_that_sticks_is_a_fault_of_the_drive(run: Run) -> None:
    """All images to the drive are lost from 50 ms on: fault in the second wrong cycle."""
    wrong: list[int] = []

    def lose(machine: Machine) -> None:
        part = part_of(machine)
        segment, node = part.segments["bus"], part.ends["Z"].node

        def loses(_axis: str) -> bool:
            is_lost = bool(segment.exchanges > 50)
            if is_lost and node.state not in (State.FAULT, State.FAULT_REACTION_ACTIVE):
                wrong.append(node.life.counter)
            return is_lost

        segment.loses = loses

    assert ids(run(SHORT, before=lose)) == [900005]
    assert wrong == [0, 10]


@pytest.mark.long
def test_one_lost_image_is_no_fault(run: Run) -> None:
    def lose(machine: Machine) -> None:
        segment = part_of(machine).segments["bus"]
        segment.loses = lambda _axis: segment.exchanges == 50

    assert ids(run(SHORT, before=lose)) == []


@pytest.mark.long
def test_a_drive_without_power_sends_nothing(run: Run) -> None:
    def unplug(machine: Machine) -> None:
        node = part_of(machine).ends["Z"].node
        machine.scheduler.call_at(60_000_000, 1, node.power_off)

    assert ids(run(SHORT, before=unplug)) == [900764]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("drive:servo.p1042=12", "factor of 2 "),
        ("drive:servo.p1042=10", "factor of 0.5 "),
        ("set:Z.antr.profibus.feinaufloesung=12", "factor of 0.5 "),
        ("set:Z.antr.profibus.p1042=12", "factor of 0.5 .P-AXIS-00316"),
        ("set:Z.antr.profibus.p1043=10", "factor of 2 .P-AXIS-00317"),
        ("drive:servo.p0880=3000", "factor of 0.183"),
        ("set:Z.kenngr.measure.input=2", "one probe at its encoder"),
        ("set:Z.getriebe[0].kv=900000", "position loop of the drive .DSC. is unstable"),
        ("bus:bus.input_us=1000", "input_us does not fit"),
        ("bus:bus.bus_us=601", "bus_us does not fit"),
        ("bus:bus.output_us=1000", "output_us does not fit"),
        ("bus:bus.bus_us=100", "before these have come"),
    ],
)
def test_a_rig_that_does_not_fit_is_refused(change: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        settings_of(change)


def test_a_gain_of_the_cnc_has_the_limit_of_its_dead_cycle() -> None:
    """Kv T below 2 sin(pi/6) = 1 with one dead cycle, 1000 1/s at 1 ms."""
    settings_of("drive:servo.telegram=3", "set:Z.getriebe[0].kv=99900")
    with pytest.raises(UserError, match="must be below 1 with 1 dead cycles"):
        settings_of("drive:servo.telegram=3", "set:Z.getriebe[0].kv=100000")


@pytest.mark.parametrize(("speed_loop_us", "limit"), [(1000, "0.618"), (2000, "0.445")])
def test_a_speed_loop_is_a_dead_time_of_the_loop_in_the_cnc(speed_loop_us: int, limit: str) -> None:
    """2 sin(pi/(2 (2 n + 1))) with n = 1 cycle of the images and those of the speed loop."""
    slow = f"drive:servo.speed_loop_us={speed_loop_us}"
    kv = round(100_000 * 2 * math.sin(math.pi / (2 * (3 + speed_loop_us / 500))))
    settings_of("drive:servo.telegram=3", slow, f"set:Z.getriebe[0].kv={kv - 50}")
    with pytest.raises(UserError, match=f"must be below {limit}"):
        settings_of("drive:servo.telegram=3", slow, f"set:Z.getriebe[0].kv={kv + 50}")


CNC = "set:Z.antr.operation_mode=CNC_POSITION_CONTROL"


@pytest.mark.parametrize(("speed_loop_us", "limit"), [(0, 2.0), (250, 1.0)])
@pytest.mark.parametrize("way", ["", "bus:bus.output_us=900"])
def test_a_gain_of_the_drive_has_the_limit_of_its_ticks(
    speed_loop_us: int, limit: float, way: str
) -> None:
    """2 sin(pi/(2 (2 n + 1))) / T: 2 without a dead tick, 1 with one; no image is in that loop."""
    changes = ["drive:servo.tick_us=250", f"drive:servo.speed_loop_us={speed_loop_us}"]
    changes += [way] if way else []
    kv = round(100 * limit / 250e-6)
    settings_of(*changes, f"set:Z.getriebe[0].kv={kv - 100}")
    with pytest.raises(UserError, match=f"must be below {limit:g} with {2 - limit:g} dead cycles"):
        settings_of(*changes, f"set:Z.getriebe[0].kv={kv}")


@pytest.mark.parametrize(
    ("changes", "in_drive"),
    [
        ((), True),
        (("drive:servo.telegram=6",), True),
        (("drive:servo.telegram=105",), True),
        (("drive:servo.telegram=3",), False),  # no word for it
        ((CNC,), False),
        (("drive:servo.telegram=105", CNC), False),
    ],
)
def test_one_end_closes_the_position_loop_and_only_one(
    changes: tuple[str, ...], in_drive: bool
) -> None:
    """KPC is the gain in 0.001 1/s, P-AXIS-00099 has 0.01 1/s: 20 1/s; 0 leaves it to the CNC."""
    settings = profidrive_settings(settings_of("set:Z.getriebe[0].kv=2000", *changes), "Z")
    assert settings.gain == (20_000 if in_drive else 0)
    loop = settings.loop
    assert (loop is None) is in_drive
    assert loop is None or loop.kv_per_s == 20.0


@pytest.mark.long
def test_a_plant_that_takes_no_speed_is_refused(tmp_path: Path) -> None:
    (tmp_path / "own.nc").write_text(SHORT, encoding="utf-8")
    rig, files = read_rig(RIG)
    plant = rig.plant["z"].model_copy(
        update={"fmu": "AxisRig.Drives.KinematicAxis", "start": {"position_start_mm": 130}}
    )
    rig = rig.model_copy(update={"plant": {**rig.plant, "z": plant}})
    with pytest.raises(UserError, match="its plant takes none"):
        Machine(read_settings(rig, files, []), read_program(tmp_path / "own.nc", ("Z",)))


@pytest.mark.long
def test_a_drive_stops_by_itself_when_the_control_begins_no_cycle_any_more(tmp_path: Path) -> None:
    """Its own clock counts cycles: the sign of life is that of the telegram before in each."""
    (tmp_path / "own.nc").write_text(SHORT, encoding="utf-8")
    machine = Machine(settings_of(), read_program(tmp_path / "own.nc", ("Z",)))
    try:
        machine.run()
        node, end_ns = part_of(machine).ends["Z"].node, machine.scheduler.now_ns
        assert node.state is State.OPERATION_ENABLED
        machine.scheduler.run_until(end_ns + 300_000_000)
        assert node.state is State.FAULT
    finally:
        machine.close()
