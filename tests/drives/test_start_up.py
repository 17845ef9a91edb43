"""A drive is started by its declaration: what is written, in which order, and what stops it."""

import struct
from collections.abc import Callable
from copy import copy
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.kernel.drives.canopen.mapping import Telegram, telegrams
from axisrig.kernel.drives.canopen.startup_steps import (
    BusSettings,
    Check,
    CheckScaling,
    Scaling,
    StartUpSettings,
    Step,
    Write,
    start_up_steps,
)
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
NODE = 3
SCALING = Scaling(1 << 20, Fraction(1 << 20))


def _steps(
    settings: StartUpSettings | None = None, bus: BusSettings | None = None
) -> tuple[Step, ...]:
    od = object_dictionary(NODE, DriveProfile())
    maps = telegrams(0x60BA)
    return start_up_steps(
        settings or StartUpSettings(), bus or BusSettings(), maps, NODE, SCALING, od
    )


def _writes(steps: tuple[Step, ...]) -> list[tuple[int, int, int]]:
    return [
        (s.index, s.sub, int.from_bytes(s.data, "little")) for s in steps if isinstance(s, Write)
    ]


def _result(bench: Any, *args: Any, **options: Any) -> Alarm | None:
    bench.scheduler.run_until(2 * MS)
    ended = bench.start_up(*args, **options)
    bench.scheduler.run_while(lambda: not ended, None)
    bench.scheduler.run_until(bench.scheduler.now_ns + MS)  # what was sent last arrives
    alarm: Alarm | None = ended[0]
    return alarm


# The list


def test_the_order_is_boot_device_sync_mapping_mode_scaling_start() -> None:
    kinds = [type(step).__name__ for step in _steps()]
    names = [step.name for step in _steps()]
    assert kinds[0] == "BootUp"
    assert names[1].startswith("0x1000:0")
    assert kinds[-2:] == ["CheckScaling", "Nmt"]
    assert [index for index, _, _ in _writes(_steps())][:2] == [0x1005, 0x1006]
    assert _writes(_steps())[-1] == (0x6060, 0, 8)


def test_free_writes_come_in_their_order_before_the_start() -> None:
    settings = StartUpSettings(
        writes=[(0x6065, 0, 0xFFFFFFFF), (0x6066, 0, 7)],
    )
    assert _writes(_steps(settings))[-2:] == [(0x6065, 0, 0xFFFFFFFF), (0x6066, 0, 7)]


def test_heartbeat_is_the_last_thing_written() -> None:
    assert _writes(_steps(StartUpSettings(heartbeat_ms=100)))[-1] == (0x1017, 0, 100)


def test_each_word_of_the_declaration_goes_to_its_own_object() -> None:
    settings = StartUpSettings(
        identity={1: 0x11, 2: 0x22, 3: 0x33, 4: 0x44},
        sync_window_us=250,
        guard_time_ms=30,
        life_factor=4,
        consumer_ms=70,
        options={0x605A: 2, 0x605B: 1},
    )
    bus = BusSettings(sync_period_us=2000, sync_counter=10, heartbeat_ms=20, master_node=126)
    steps = _steps(settings, bus)
    identity = {s.sub: s.expected for s in steps if isinstance(s, Check) and s.index == 0x1018}
    assert identity == settings.identity
    written = [w for w in _writes(steps) if w[0] < 0x1400 or w[0] in settings.options]
    # 1019 can be changed while 1006 is 0 only
    assert written == [
        *((0x1005, 0, 0x80), (0x1006, 0, 0), (0x1019, 0, 10), (0x1007, 0, 250)),
        *((0x1006, 0, 2000), (0x605A, 0, 2), (0x605B, 0, 1)),
        *((0x100C, 0, 30), (0x100D, 0, 4), (0x1016, 1, 126 << 16 | 70)),
    ]


@pytest.mark.parametrize("window_us", [None, 0, 250])
def test_a_window_of_0_is_written_and_none_is_left_alone(window_us: int | None) -> None:
    """1007 = 0 switches the window of the SYNC off (CiA 301)."""
    written = [
        w for w in _writes(_steps(StartUpSettings(sync_window_us=window_us))) if w[0] == 0x1007
    ]
    assert written == ([] if window_us is None else [(0x1007, 0, window_us)])


@pytest.mark.parametrize("device_type", [None, 0, 402, 401])
def test_a_device_of_no_profile_is_compared_too(device_type: int | None) -> None:
    """1000 = 0 is a device without one (CiA 301); None looks at nothing."""
    checks = [
        (step.expected, step.mask)
        for step in _steps(StartUpSettings(device_type=device_type))
        if isinstance(step, Check) and step.index == 0x1000
    ]
    assert checks == ([] if device_type is None else [(device_type, 0xFFFF)])


@pytest.mark.parametrize("lacks", [None, 0x608F, 0x6091, 0x6092])
@pytest.mark.parametrize("is_wanted", [True, False])
def test_the_scaling_is_compared_where_it_is_wanted_and_the_drive_has_all_of_its_objects(
    lacks: int | None, is_wanted: bool
) -> None:
    od = copy(object_dictionary(NODE, DriveProfile()))  # which is made once for all
    od.indices, od.names = dict(od.indices), dict(od.names)
    if lacks is not None:
        del od[lacks]
    settings = StartUpSettings(scaling_check=is_wanted)
    steps = start_up_steps(settings, BusSettings(), telegrams(0x60BA), NODE, SCALING, od)
    found = [step for step in steps if isinstance(step, CheckScaling)]
    assert len(found) == (is_wanted and lacks is None)


def test_the_drive_watches_the_rpdos_that_come_with_every_sync_and_no_others() -> None:
    """14xx:5. One that is sent on change, or acyclic (type 0), may stay out for as long as it may.

    A TPDO keeps its own times: inhibit 10, event timer 500 ms.
    """
    torque = (MappedObject(0x6072, 0, 16, False, ""),)
    types = {"RPDO1": 1, "RPDO2": 255, "RPDO3": 240, "RPDO4": 0}
    maps = {name: Telegram(name, number, 0, torque) for name, number in types.items()}
    inputs = (MappedObject(0x60FD, 0, 32, False, "inputs"),)
    maps["TPDO3"] = Telegram("TPDO3", 254, 10, inputs, event_ms=500)
    od = object_dictionary(NODE, DriveProfile())
    settings = StartUpSettings(rpdo_timeout_ms=50)
    steps = start_up_steps(settings, BusSettings(), maps, NODE, SCALING, od)
    times = [w for w in _writes(steps) if 0x1400 <= w[0] < 0x1A00 and w[1] in (3, 5)]
    assert times == [(0x1400, 5, 50), (0x1402, 5, 50), (0x1802, 3, 10), (0x1802, 5, 500)]


@pytest.mark.parametrize(
    "types", [{"TPDO1": 1}, {"TPDO2": 3, "TPDO3": 254}, {"TPDO1": 0, "TPDO2": 1, "TPDO4": 255}]
)
def test_tpdos_that_nobody_uses_are_switched_off_and_the_others_while_they_are_mapped(
    types: dict[str, int],
) -> None:
    """CiA 301, 7.5.2.37: 18xx:1 with bit 31; identifiers of the predefined connection set."""
    inputs = (MappedObject(0x60FD, 0, 32, False, ""),)
    maps = {name: Telegram(name, number, 0, inputs) for name, number in types.items()}
    od = object_dictionary(NODE, DriveProfile())
    steps = start_up_steps(StartUpSettings(), BusSettings(), maps, NODE, SCALING, od)
    off = 1 << 31
    for number in range(1, 5):
        index, cob_id = 0x17FF + number, 0x80 + 0x100 * number + NODE
        values = [value for at, sub, value in _writes(steps) if (at, sub) == (index, 1)]
        written = [value & (off | 0x7FF) for value in values]  # bit 30: remote requests
        is_used = f"TPDO{number}" in types
        assert written == ([cob_id | off, cob_id] if is_used else [cob_id | off]), number


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (StartUpSettings(writes=[(0x5FFF, 0, 1)]), "no such object"),
        (StartUpSettings(writes=[(0x6065, 1, 1)]), "no such object"),
        (StartUpSettings(writes=[(0x6041, 0, 1)]), "does not let the object be written"),
        (StartUpSettings(writes=[(0x6066, 0, 70_000)]), "does not fit"),
        (StartUpSettings(writes=[(0x1008, 0, 1)]), "does not let"),
        (StartUpSettings(heartbeat_ms=100, guard_time_ms=100), "not by both"),
        (StartUpSettings(consumer_ms=100), "kernel sends no heartbeat"),
    ],
)
def test_what_the_drive_cannot_do_is_refused_before_anything_is_sent(
    settings: StartUpSettings, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        _steps(settings)


@pytest.mark.parametrize(
    ("mapped", "message"),
    [
        (MappedObject(0x5FFF, 0, 32, False, ""), "the drive does not have"),
        (MappedObject(0x6502, 0, 32, False, ""), "no PDO may carry"),
        (MappedObject(0x607A, 0, 16, True, ""), "another type"),
        (MappedObject(0x6064, 0, 32, False, ""), "another type"),
    ],
)
def test_a_mapping_that_the_eds_does_not_allow_is_refused(
    mapped: MappedObject, message: str
) -> None:
    maps = {**telegrams(0x60BA)}
    maps["TPDO2"] = replace(maps["TPDO2"], objects=(mapped,))
    od = object_dictionary(NODE, DriveProfile())
    with pytest.raises(UserError, match=message):
        start_up_steps(StartUpSettings(), BusSettings(), maps, NODE, SCALING, od)


def test_a_status_object_cannot_be_sent_to_the_drive() -> None:
    maps = {**telegrams(0x60BA)}
    wrong = MappedObject(0x60B9, 0, 16, False, "")
    maps["RPDO1"] = replace(maps["RPDO1"], objects=(wrong,))
    od = object_dictionary(NODE, DriveProfile())
    with pytest.raises(UserError, match="an RPDO cannot carry"):
        start_up_steps(StartUpSettings(), BusSettings(), maps, NODE, SCALING, od)


# The drive


def test_start_up_returns_at_once_and_ends_by_events(link_bench: Make) -> None:
    bench = link_bench()
    begin_ns = bench.scheduler.now_ns
    ended = bench.start_up()
    assert bench.scheduler.now_ns == begin_ns
    assert ended == []
    bench.scheduler.run_until(begin_ns + 50 * MS)
    assert ended == [None]


def test_what_was_declared_stands_in_the_drive(link_bench: Make) -> None:
    bench = link_bench()
    settings = StartUpSettings(heartbeat_ms=50, writes=[(0x6065, 0, 5000), (0x6066, 0, 9)])
    assert _result(bench, settings) is None
    assert bench.remote.sdo[0x1017].raw == 50
    assert (bench.remote.sdo[0x6065].raw, bench.remote.sdo[0x6066].raw) == (5000, 9)


@pytest.mark.provokes(900020, 4, node=3, ms=800, attempts=4)
def test_900020_when_the_node_does_not_boot(link_bench: Make) -> None:
    bench = link_bench(silent=True)
    alarm = _result(bench, StartUpSettings(boot_timeout_ns=200 * MS, boot_attempts=4))
    assert alarm is not None
    assert alarm.id == 900020
    assert alarm.values == {"axis": "Z", "node": NODE, "ms": 800, "attempts": 4}
    resets = [d for _, can_id, d in bench.heard if can_id == 0]
    assert resets == [bytes([130, NODE])] * 4  # and never started


def test_900011_when_a_silent_node_is_not_waited_for(link_bench: Make) -> None:
    bench = link_bench(silent=True)
    alarm = _result(bench, StartUpSettings(boot="none"))
    assert alarm is not None
    assert alarm.id == 900011
    assert alarm.values["answer"] == "no answer"
    assert "0x1000" in str(alarm.values["step"])
    assert 0x000 not in [can_id for _, can_id, _ in bench.heard]  # never started


def test_900011_when_the_drive_refuses_a_value(link_bench: Make) -> None:
    """6060 = 77 is no mode of any drive."""
    bench = link_bench()
    alarm = _result(bench, StartUpSettings(writes=[(0x6060, 0, 77)]))
    assert alarm is not None
    assert alarm.id == 900011
    assert "0x6060:0" in str(alarm.values["step"])
    assert str(alarm.values["answer"]).startswith("abort 0x0609003")


@pytest.mark.provokes(900011, 4, axis="Z", node=3)
def test_900011_names_object_and_value_of_a_mapping(link_bench: Make) -> None:
    """A drive whose EDS has more than it has: 60D5, 16 bits, as the second object of TPDO2."""
    bench = link_bench(profile=DriveProfile(lacks="60D5", input_delay_ns=0))
    bench.remote.object_dictionary = object_dictionary(NODE, DriveProfile())
    alarm = _result(bench, telegrams=telegrams(0x60BA, counter=True))
    assert alarm is not None
    assert "did not accept mapping of TPDO2: 0x1A01:" in str(alarm)
    assert "= 0x60D50010: abort 0x06020000, " in str(alarm)


def test_900011_names_the_object_that_could_not_be_read(link_bench: Make) -> None:
    bench = link_bench(profile=DriveProfile(lacks="6091", input_delay_ns=0))
    bench.remote.object_dictionary = object_dictionary(NODE, DriveProfile())
    alarm = _result(bench)
    assert "the reading of 0x6091:1 (scaling): abort 0x06020000" in str(alarm)


def test_900021_when_another_device_answers(link_bench: Make) -> None:
    bench = link_bench()
    alarm = _result(bench, StartUpSettings(identity={2: 4711}))
    assert alarm is not None
    assert alarm.id == 900021
    assert (alarm.values["found"], alarm.values["expected"]) == ("0x192", "0x1267")
    assert "0x1018:2" in str(alarm.values["step"])


@pytest.mark.provokes(900021, 4, found="0x20192", expected="0x191")
def test_900021_when_the_node_is_no_drive(link_bench: Make) -> None:
    bench = link_bench()
    alarm = _result(bench, StartUpSettings(device_type=401))
    assert alarm is not None
    assert alarm.id == 900021


@pytest.mark.parametrize(
    ("scaling", "expected"),
    [
        (Scaling(1 << 17, Fraction(1 << 20)), "131072 increments and 1048576 position units"),
        (Scaling(1 << 20, Fraction(10_000)), "1048576 increments and 10000 position units"),
    ],
)
@pytest.mark.provokes(900022, 4, axis="Z", node=3)
def test_900022_tells_both_scalings(link_bench: Make, scaling: Scaling, expected: str) -> None:
    alarm = _result(link_bench(), scaling=scaling)
    assert alarm is not None
    assert alarm.id == 900022
    assert expected in str(alarm.values["expected"])
    assert "1048576 increments and 1048576 position units" in str(alarm.values["found"])


@pytest.mark.parametrize(("lead_mm", "alarms"), [(10.0, []), (5.0, [900022])])
def test_the_lead_is_compared_where_the_position_unit_is_a_length(
    link_bench: Make, lead_mm: float, alarms: list[int]
) -> None:
    """6092 of a drive in units of 0.1 um says 100000 for a lead of 10 mm."""
    drive = DriveTable(position_unit_um=0.1, lead_mm=10.0).make()
    rig = DriveTable(position_unit_um=0.1, lead_mm=lead_mm).make()
    assert drive.units_per_revolution == 100_000
    scaling = Scaling(rig.encoder_increments, Fraction(rig.units_per_revolution))
    alarm = _result(link_bench(profile=drive), scaling=scaling)
    assert [alarm.id for alarm in [alarm] if alarm] == alarms


def test_a_lead_is_whole_position_units() -> None:
    with pytest.raises(UserError, match="no whole number of position units"):
        DriveTable(position_unit_um=3.0, lead_mm=10.0).make()


def test_reset_node_and_waiting_for_power_on_boot_the_drive_too(link_bench: Make) -> None:
    bench = link_bench()
    assert _result(bench, StartUpSettings(boot="reset_node")) is None
    assert [d[0] for _, can_id, d in bench.heard if can_id == 0] == [129, 1]


def test_a_start_at_power_on_sees_one_boot_up_and_it_is_that_of_the_reset(link_bench: Make) -> None:
    """The boot-up of power on waits behind the NMT command, and is lost with the reset."""
    bench = link_bench()
    ended = bench.start_up()
    bench.scheduler.run_until(50 * MS)
    assert ended == [None]
    first = [(can_id, data[:1]) for _, can_id, data in bench.heard[:3]]
    assert first == [(0x000, bytes([130])), (0x700 + NODE, b"\0"), (0x600 + NODE, b"\x40")]
    assert [can_id for _, can_id, _ in bench.heard].count(0x700 + NODE) == 1


def test_a_boot_up_that_ends_before_the_command_is_on_the_bus_does_not_count(
    link_bench: Make,
) -> None:
    """The boot-up of power on is on the wire while the kernel asks for a reset."""
    bench = link_bench()
    bench.scheduler.run_until(20_000)  # 20 of its 50 to 60 bits
    ended = bench.start_up()
    bench.scheduler.run_until(50 * MS)
    assert ended == [None]
    ids = [can_id for _, can_id, _ in bench.heard[:4]]
    assert ids == [0x700 + NODE, 0x000, 0x700 + NODE, 0x600 + NODE]


def test_waiting_begins_with_the_drives_own_boot_up(link_bench: Make) -> None:
    bench = link_bench()
    ended = bench.start_up(StartUpSettings(boot="wait"))  # the node boots with the first event
    bench.scheduler.run_until(50 * MS)
    assert ended == [None]
    assert [struct.unpack("BB", d) for _, i, d in bench.heard if i == 0] == [(1, NODE)]
