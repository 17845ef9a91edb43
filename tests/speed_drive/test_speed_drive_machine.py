"""Drives that only take a speed in machines: what is refused, alarms, faults."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.speed_drive.ends import MILLISECOND, Ends

from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.lightbus.checks import describe_lightbus
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
SHORT = "%short\nN10 G01 G90 Z129.9 F3000\nN20 M30\n"
FAMILIES = ("conventional", "encoder-terminal", "lightbus")

Run = Callable[..., Machine]


def settings_of(family: str, *changes: str) -> Settings:
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(*read_rig(RIGS / f"probe-z-{family}.toml"), assigned)
    check_rig(settings)
    return settings


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run a program with a shipped rig. changes: of its keys. before: called with the machine."""

    def make(
        family: str, program: str, *changes: str, before: Callable[[Machine], None] | None = None
    ) -> Machine:
        (tmp_path / "own.nc").write_text(program, encoding="utf-8")
        machine = Machine(settings_of(family, *changes), read_program(tmp_path / "own.nc", ("Z",)))
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


COMMON = [
    ("set:Z.getriebe[0].kv=900000", "position loop of the CNC is unstable"),
    ("set:Z.getriebe[0].kv=100000", "must be below 1 with 1 dead cycles"),
]
OWN = {
    "conventional": [
        ("drive:servo.rpm_at_10v=1500", "factor of 0.5 .P-AXIS-00129"),
        ("bus:card.input_us=1000", "input_us does not fit"),
        ("bus:card.bus_us=100", "has no bus|before these have come"),
    ],
    "lightbus": [
        ("drive:servo.rpm_at_full=1500", "factor of 0.5 .P-AXIS-00129"),
        ("bus:bus.input_us=1000", "input_us does not fit"),
        ("drive:servo.latch_variable=LATCH64", "latch_variable"),
    ],
    "encoder-terminal": [
        ("drive:servo.rpm_at_10v=1500", "factor of 0.5 .P-AXIS-00129"),
        ("bus:bus.input_us=1000", "input_us does not fit"),
        ("set:Z.kenngr.measure.edge=NEG", "type terminal does not latch at this edge"),
        ("drive:servo.lines=600000", "nobody knows how often it has wrapped"),
        ("drive:servo.missing_cycles=900", "nobody knows how often it has wrapped"),
    ],
}
REFUSED = [(name, *row) for name in FAMILIES for row in [*COMMON, *OWN[name]]]


@pytest.mark.parametrize(("family", "change", "words"), REFUSED)
def test_a_rig_that_does_not_fit_is_refused(family: str, change: str, words: str) -> None:
    with pytest.raises(UserError, match=words):
        settings_of(family, change)


def test_a_latch_within_a_turn_is_refused_where_the_turn_is_not_known() -> None:
    """500 mm/s for 4 cycles: 2 mm at 1 ms, 8 mm at 4 ms, of 5 mm that are half a turn."""
    in_turn = "drive:servo.latch_variable=LATCH16"
    settings_of("lightbus", in_turn)
    settings_of("lightbus-2ms", in_turn)
    with pytest.raises(UserError, match="nobody knows in which turn LATCH16 was"):
        settings_of("lightbus-4ms", in_turn)
    settings_of("lightbus-4ms", in_turn, "drive:servo.missing_cycles=1")


def test_a_function_of_input_2_that_does_not_latch_is_warned_of() -> None:
    """IN2MODE."""
    shown = describe_lightbus(settings_of("lightbus", "drive:servo.in2mode=0"), "Z", MS)
    assert "in2mode of its drive is 0 and not 26: its input 2 latches nothing" in shown[-1]
    assert not any(
        "in2mode" in line for line in describe_lightbus(settings_of("lightbus"), "Z", MS)
    )


@pytest.mark.parametrize("family", FAMILIES)
def test_a_gain_just_below_the_limit_is_none(family: str) -> None:
    """Kv T below 2 sin(pi/6) = 1 with one dead cycle; 0.618 with a speed loop of one cycle."""
    settings_of(family, "set:Z.getriebe[0].kv=99900")
    slow = "drive:servo.speed_loop_us=1000"
    settings_of(family, slow, "set:Z.getriebe[0].kv=61800")
    with pytest.raises(UserError, match=r"must be below 0\.618 with 2 dead cycles"):
        settings_of(family, slow, "set:Z.getriebe[0].kv=61900")


@pytest.mark.parametrize("family", FAMILIES)
def test_distance_control_is_corrected(family: str) -> None:
    """110547: these types cannot do it."""
    settings = settings_of(family, "set:Z.lr_param.distance_control_on=1")
    assert [alarm.id for alarm in settings.warnings] == [110547]
    assert not settings.axis["Z"].flag("lr_param.distance_control_on")


@pytest.mark.provokes(900782, 7, axis="Z")
@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.long
def test_900782_for_homing(run: Run, family: str) -> None:
    assert ids(run(family, "%home\nN10 G74 Z1\nN20 M30\n")) == [900782]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.long
def test_a_program_cannot_choose_what_the_drive_does_not_have(run: Run, family: str) -> None:
    """P-AXIS-00517: one input with these types; FCT-C4 6.3: one edge with a terminal."""
    choices = ["INPUT=2"] + (["EDGE=NEG"] if family == "encoder-terminal" else [])
    for choice in choices:
        assert ids(run(family, f"%two\nN10 #MEAS [AX=Z {choice}]\nN20 M30\n")) == [900227]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.long
def test_a_drive_without_power_sends_nothing(run: Run, family: str) -> None:
    def unplug(machine: Machine) -> None:
        node = part_of(machine).ends["Z"].node
        machine.scheduler.call_at(60_000_000, 1, node.power_off)

    expected = 900027 if family == "conventional" else 900780  # the card has its own power
    assert ids(run(family, SHORT, before=unplug)) == [expected]


RESTARTED = {"conventional": 900027, "encoder-terminal": 900781, "lightbus": 900027}


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.long
def test_a_drive_that_starts_again_is_not_led_on(run: Run, family: str) -> None:
    def restart(machine: Machine) -> None:
        node = part_of(machine).ends["Z"].node
        machine.scheduler.call_at(60_000_000, 1, node.restart)

    assert ids(run(family, SHORT, before=restart)) == [RESTARTED[family]]


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.long
def test_lost_images_are_borne_up_to_the_watchdog(run: Run, family: str) -> None:
    def lose(count: int) -> Callable[[Machine], None]:
        def build(machine: Machine) -> None:
            (segment,) = part_of(machine).segments.values()
            segment.loses = lambda _axis: 50 < segment.exchanges <= 50 + count

        return build

    assert ids(run(family, SHORT, before=lose(3))) == []
    assert ids(run(family, SHORT, before=lose(8))) != []


@pytest.mark.parametrize("family", FAMILIES)
def test_a_drive_stops_by_itself_when_the_control_begins_no_cycle_any_more(family: str) -> None:
    """After `watchdog_cycles` of its own clock, with the set speed that came last until then."""
    ends = Ends(family.replace("-", "_"), lambda _: 0.159, [], MILLISECOND)
    for _ in range(20):
        ends.cycle()
    ends.link.send(ends.link.actual_mm + 1.0)
    ends.scheduler.run_until(20 * MS)
    ends.carrier.begin_cycle()
    ends.scheduler.run_until(24 * MS)
    assert ends.node.speed.speed_m_s == pytest.approx(0.01, rel=1e-3)
    assert ends.node.state is State.OPERATION_ENABLED
    ends.scheduler.run_until(25 * MS)
    assert ends.node.speed.speed_m_s == 0.0
    assert ends.node.state is not State.OPERATION_ENABLED
    assert ends.segment.exchanges == 21
