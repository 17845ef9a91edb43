"""A sensor falls silent: the cycle in which the control freezes, counted from the telegrams alone.

The last value came in cycle c, a value every P is promised and three of them are allowed: the
first cycle behind c + 3 P / T freezes, c + floor(3 P / T) + 1.
"""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.time.clock import MS

RunDistance = Callable[..., Any]
PROGRAM = "N10 {on}\nN20 G4 0.4\nN30 Z[DIST_CTRL OFF NO_MOVE]"
ON = "Z[DIST_CTRL ON CONST_DIST SET_DIST=2]"
BY_PLC = "Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR ON CONST_DIST SET_DIST=2]"
LOST = "fault:drop=Z.TPDO4 at=200ms"
# The surface rises by 0.5 mm just before the sensor is lost: what it told last is an error
RISES = (
    "plant:gap.lift_mm=0.5",
    "plant:gap.lift_begin_ms=205",
    "plant:gap.lift_end_ms=205",
    "set:Z.kenngr.distc.kp=0.05",
    "set:Z.kenngr.distc.max_act_value_change=1000000",
)
PATIENT = "drive:servo.missing_cycles=100"


def frozen(watched: Any, alarm_id: int = 900314) -> tuple[int, int]:
    """Instant of the alarm and cycle of it; the offset is held from that cycle on, bit for bit."""
    channel = watched.channel
    assert [alarm.id for alarm in channel.alarms] == [alarm_id]
    cycle = watched.alarm_cycle()
    before = watched.cycles[cycle - 1]
    assert watched.cycles[cycle - 2].offset_mm != before.offset_mm  # it followed until then
    assert {c.offset_mm for c in watched.cycles[cycle:]} == {before.offset_mm}
    return channel.alarm_ns[0], cycle


def last_received_ns(watched: Any) -> int:
    """End of the last telegram with 60E4:1 that the kernel got: those behind pass and are lost."""
    machine = watched.outcome.machine
    (fault,) = machine.faults
    sent_ns = machine.recorder.series().telegrams("Z", "second").frame_ns
    return int(max(sent_ns[sent_ns < fault.begin_ns]))


@pytest.mark.parametrize(
    ("base", "period_ms", "cycle_ms"),
    [
        pytest.param("distance-z.toml", 1, 1, marks=pytest.mark.long),
        pytest.param("distance-z-2ms.toml", 2, 2, marks=pytest.mark.long),
        ("distance-z-every-second.toml", 2, 1),
        ("distance-z-event.toml", 10, 1),
    ],
)
@pytest.mark.provokes(900314, 7, owner="axis Z", source="SECOND_ENCODER")
def test_a_telegram_that_stops_freezes_behind_three_of_its_periods(
    run_distance: RunDistance, base: str, period_ms: int, cycle_ms: int
) -> None:
    watched = run_distance(PROGRAM.format(on=ON), LOST, *RISES, PATIENT, base=base)
    timing = watched.outcome.machine.timing
    last_ns = last_received_ns(watched)
    taken_ns = -(-(last_ns - timing.offset_ns) // timing.period_ns) * timing.period_ns
    taken_ns += timing.offset_ns
    alarm_ns, _ = frozen(watched)
    assert alarm_ns - taken_ns == (3 * period_ms // cycle_ms + 1) * cycle_ms * MS


@pytest.mark.long
def test_the_limit_of_the_rig_wins(run_distance: RunDistance) -> None:
    rig = "[axis.Z]\nsensor_age_limit_ms = 7.5"
    watched = run_distance(PROGRAM.format(on=ON), LOST, *RISES, PATIENT, rig=rig)
    timing = watched.outcome.machine.timing
    taken_ns = last_received_ns(watched) // timing.period_ns * timing.period_ns + timing.offset_ns
    alarm_ns, _ = frozen(watched)
    assert alarm_ns - taken_ns == 8 * MS
    assert watched.alarm.values["limit_ms"] == "7.5"


@pytest.mark.parametrize(
    ("period_ms", "last_read"), [pytest.param(1, 199, marks=pytest.mark.long), (5, 195)]
)
def test_a_variable_that_the_plc_brings_no_more_freezes_too(
    run_distance: RunDistance, period_ms: int, last_read: int
) -> None:
    """The PLC reads with its first turn and then every period; its turn 200 is the first lost."""
    entry = f"{{ period_ms = {period_ms}, silent_from_ms = 200 }}"
    watched = run_distance(
        PROGRAM.format(on=BY_PLC), *RISES, base="distance-z-variable.toml",
        rig=f'[plc]\n"V.E.SENSOR" = {entry}',
    )  # fmt: skip
    channel = watched.channel
    alarm_ns, _ = frozen(watched)
    assert alarm_ns - channel.start_ns == (last_read + 3 * period_ms + 1) * MS
    assert watched.alarm.values["source"] == "VARIABLE V.E.SENSOR"


@pytest.mark.long
def test_a_sensor_that_is_silent_already_switches_nothing_on(run_distance: RunDistance) -> None:
    watched = run_distance(f"N10 G4 0.3\nN20 {ON}\nN30 G4 0.1", LOST, PATIENT)
    assert [alarm.id for alarm in watched.channel.alarms] == [900314]
    assert {cycle.state for cycle in watched.cycles} == {"INACTIVE"}


@pytest.mark.parametrize("words", [pytest.param("CHECK_POS", marks=pytest.mark.long), "REF"])
def test_an_old_value_is_neither_checked_nor_a_reference(
    run_distance: RunDistance, words: str
) -> None:
    watched = run_distance(f"N10 G4 0.3\nN20 Z[DIST_CTRL {words}]\nN30 G4 0.1", LOST, PATIENT)
    assert [alarm.id for alarm in watched.channel.alarms] == [900314]


NO_TIMER = '[drive.servo]\npdo_map = "{path}"'
TABLE = """pdo,transmission,inhibit_100us,index,sub,bits,signed,field
RPDO1,1,0,0x6040,0,16,no,controlword
RPDO1,1,0,0x607A,0,32,yes,target
TPDO1,1,0,0x6041,0,16,no,statusword
TPDO1,1,0,0x6064,0,32,yes,actual
TPDO4,254,10,0x60E4,1,32,yes,second
"""


@pytest.mark.long
@pytest.mark.provokes(900315, 1, owner="axis Z", source="SECOND_ENCODER")
def test_the_first_on_warns_of_a_telegram_without_event_timer(
    run_distance: RunDistance, tmp_path: Any
) -> None:
    path = tmp_path / "no-timer.csv"
    path.write_text(TABLE)
    program = f"N10 {ON}\nN20 G4 0.1\nN30 Z[DIST_CTRL FREEZE]\nN40 Z[DIST_CTRL ON CONST_DIST]\n"
    rig = NO_TIMER.format(path=path.as_posix())
    watched = run_distance(program + "N50 G4 0.1\nN60 Z[DIST_CTRL OFF NO_MOVE]", rig=rig)
    assert [alarm.id for alarm in watched.channel.alarms] == [900315]


@pytest.mark.provokes(900315, 1, owner="axis Z", source="VARIABLE V.E.SENSOR")
@pytest.mark.parametrize("by", ["plan", "program"])
def test_the_first_on_warns_of_a_variable_that_has_no_age(
    run_distance: RunDistance, by: str
) -> None:
    written = "N05 V.E.SENSOR = -20000\n" if by == "program" else ""
    watched = run_distance(
        f"{written}N10 {BY_PLC}\nN20 G4 0.1\nN30 Z[DIST_CTRL OFF NO_MOVE]", "plc:V.E.SENSOR=-20000"
    )
    assert [alarm.id for alarm in watched.channel.alarms] == [900315]


@pytest.mark.long
@pytest.mark.parametrize(
    ("base", "on"),
    [
        ("distance-z.toml", ON),
        ("distance-z-every-second.toml", ON),
        ("distance-z-event.toml", ON),
        ("distance-z-variable-late.toml", BY_PLC),
    ],
)
def test_a_good_sensor_is_never_too_old(run_distance: RunDistance, base: str, on: str) -> None:
    """Also where nothing changes for a long time: the event timer sends what is the same."""
    program = f"N10 {on}\nN20 G4 0.5\nN30 Z[DIST_CTRL OFF NO_MOVE]"
    assert run_distance(program, base=base).channel.alarms == []
