"""What the declaration of a drive may leave out or set to 0, and what a start-up makes of that.

Objects are those of CiA 301 (1005 SYNC, 1006 its period, 1007 its window, 1019 its counter, 100C
and 100D guarding, 1016 and 1017 heartbeat) and CiA 402-2 (608F, 6091, 6092 scaling, 60C2 period).
"""

from copy import copy, deepcopy
from fractions import Fraction
from typing import Any

import pytest
from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.canopen.startup_steps import (
    BootUp,
    BusSettings,
    Check,
    CheckScaling,
    Keep,
    Nmt,
    Scaling,
    StartUpSettings,
    Step,
    Write,
    object_steps,
    start_up_steps,
)
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.errors import UserError

NODE = 3
SCALING = Scaling(1 << 20, Fraction(1 << 20))
WHOLE_SECONDS, MILLISECONDS = 0, -3


def dictionary(*changed: int) -> ObjectDictionary:
    """That of our own drive; the objects that are named are copies, to be changed."""
    od = copy(object_dictionary(NODE, DriveProfile()))
    od.indices = {**od.indices, **{index: deepcopy(od[index]) for index in changed}}
    return od


def steps(
    settings: StartUpSettings | None = None,
    bus: BusSettings | None = None,
    od: ObjectDictionary | None = None,
    maps: Any = None,
) -> tuple[Step, ...]:
    return start_up_steps(
        settings or StartUpSettings(), bus or BusSettings(), maps or telegrams(0x60BA), NODE,
        SCALING, od or dictionary(),
    )  # fmt: skip


def written(made: tuple[Step, ...], *indices: int) -> list[tuple[int, int, int]]:
    return [
        (step.index, step.sub, int.from_bytes(step.data, "little"))
        for step in made
        if isinstance(step, Write) and step.index in indices
    ]


# The SYNC


@pytest.mark.parametrize(("window_us", "count"), [(None, 0), (0, 1), (1, 1), (900, 1)])
def test_a_window_of_0_is_written_and_one_that_is_left_out_is_not(
    window_us: int | None, count: int
) -> None:
    """1007 = 0 switches the window of the drive off (CiA 301), whatever it has stored."""
    found = written(steps(StartUpSettings(sync_window_us=window_us)), 0x1007)
    assert found == [(0x1007, 0, window_us)] * count


@pytest.mark.parametrize("counter", [0, 2, 240])
def test_the_counter_of_the_sync_is_written_while_its_period_is_0(counter: int) -> None:
    """CiA 301 section 7.5.2.22; without a counter 1019 stays as it is."""
    bus = BusSettings(sync_period_us=1500, sync_counter=counter)
    with_counter = [(0x1006, 0, 0), (0x1019, 0, counter)]
    expected = [*(with_counter if counter else ()), (0x1006, 0, 1500)]
    assert written(steps(bus=bus), 0x1006, 0x1019) == expected


@pytest.mark.parametrize("index", [0x1005, 0x1006])
def test_what_the_drive_does_not_let_be_written_of_the_sync_is_left_alone(index: int) -> None:
    od = dictionary(index)
    od[index].access_type = "const"
    (other,) = {0x1005: 0x80, 0x1006: 1000}.items() - {(index, 0x80), (index, 1000)}
    assert written(steps(od=od), 0x1005, 0x1006) == [(other[0], 0, other[1])]


# Which device


@pytest.mark.parametrize(("declared", "is_asked"), [(None, False), (0, True), (402, True)])
def test_a_device_type_of_0_is_compared_and_one_that_is_left_out_is_not(
    declared: int | None, is_asked: bool
) -> None:
    """1000 = 0: a device that follows no profile (CiA 301); the low word is the profile."""
    found = [
        step
        for step in steps(StartUpSettings(device_type=declared))
        if isinstance(step, Check) and step.index == 0x1000
    ]
    assert [(each.sub, each.expected, each.mask) for each in found] == (
        [(0, declared, 0xFFFF)] if is_asked else []
    )


@pytest.mark.parametrize(
    ("boot", "command"),
    [("reset_communication", 0x82), ("reset_node", 0x81), ("wait", None), ("none", ...)],
)
def test_a_drive_boots_by_the_command_of_its_declaration(boot: Any, command: Any) -> None:
    """NMT commands of CiA 301; with `none` nothing is waited for. It is started in any case."""
    made = steps(StartUpSettings(boot=boot))
    boots = [step.command for step in made if isinstance(step, BootUp)]
    assert boots == ([] if command is ... else [command])
    assert isinstance(made[0], BootUp) is (command is not ...)
    assert [step.command for step in made if isinstance(step, Nmt)] == [0x01]
    assert isinstance(made[-1], Nmt)


def test_values_of_a_dcf_go_to_their_own_places_after_the_identity() -> None:
    """In the order of objects and sub-indices, each with its name; then the SYNC."""
    od = dictionary(0x6091, 0x6065)
    od[0x6091][2].value, od[0x6091][1].value, od[0x6065].value = 3, 7, 500
    made = [step for step in steps(od=od) if isinstance(step, Write)]
    assert [(step.index, step.sub, int.from_bytes(step.data, "little")) for step in made[:4]] == [
        (0x6065, 0, 500), (0x6091, 1, 7), (0x6091, 2, 3), (0x1005, 0, 0x80),
    ]  # fmt: skip
    assert made[2].name == f"DCF: 0x6091:2 {od[0x6091][2].name} = 3"


# Scaling


PLACES = [(0x608F, 1), (0x608F, 2), (0x6091, 1), (0x6091, 2), (0x6092, 1), (0x6092, 2)]


def has_scaling(od: ObjectDictionary, *, checks: bool = True) -> bool:
    settings = StartUpSettings(scaling_check=checks)
    made = steps(settings, od=od)
    beside = object_steps(settings, 1000, telegrams(0x60BA), SCALING, od)
    found = [any(isinstance(step, CheckScaling) for step in each) for each in (made, beside)]
    assert found[0] is found[1]
    return found[0]


@pytest.mark.parametrize(("index", "sub"), PLACES)
def test_the_scaling_is_compared_where_the_drive_has_all_of_its_factors(
    index: int, sub: int
) -> None:
    """On CAN and on EtherCAT; one that it lacks could not be read, and would end the start."""
    assert has_scaling(dictionary())
    assert not has_scaling(dictionary(), checks=False)
    od = dictionary(index)
    del od[index].subindices[sub]
    assert not has_scaling(od)
    del od.indices[index]
    assert not has_scaling(od)


def test_beside_can_the_same_is_asked_and_written_without_a_bus() -> None:
    """Device, identity, period, mode, scaling, reactions, free writes, what RPDOs keep; no NMT."""
    settings = StartUpSettings(
        boot="reset_node", identity={1: 0x11, 4: 0x44}, mode=9, options={0x605A: 2},
        heartbeat_ms=100, sync_window_us=7, writes=[(0x6065, 0, 10)],
    )  # fmt: skip
    maps = {**telegrams(0x60BA)}
    torque = (MappedObject(0x6072, 0, 16, False, ""),)
    maps["RPDO2"] = type(maps["RPDO1"])("RPDO2", 1, 0, torque)
    made = object_steps(settings, 2000, maps, SCALING, dictionary())
    assert [(step.index, step.sub, step.expected) for step in made if isinstance(step, Check)] == [
        (0x1000, 0, 402), (0x1018, 1, 0x11), (0x1018, 4, 0x44),
    ]  # fmt: skip
    writes = [step for step in made if isinstance(step, Write)]
    assert [(step.index, step.sub, step.data) for step in writes] == [
        (0x60C2, 1, b"\2"), (0x60C2, 2, b"\xfd"), (0x6060, 0, b"\x09"), (0x605A, 0, b"\2\0"),
        (0x6065, 0, b"\x0a\0\0\0"),
    ]  # fmt: skip
    kinds = [type(step).__name__ for step in made]
    assert kinds == [
        *["Check"] * 3, *["Write"] * 3, "CheckScaling", *["Write"] * 2, "Keep",
    ]  # fmt: skip
    assert [step.name.rpartition(" = ")[2] for step in writes] == ["2", "-3", "9", "2", "0xA"]


# The period of the set positions


@pytest.mark.parametrize(
    ("exponent", "period_us", "value"),
    [
        (MILLISECONDS, 1000, 1), (MILLISECONDS, 4000, 4), (-4, 1500, 15), (-6, 100, 100),
        (WHOLE_SECONDS, 1_000_000, 1), (WHOLE_SECONDS, 1000, None), (MILLISECONDS, 1500, None),
    ],
)  # fmt: skip
def test_a_fixed_power_of_ten_is_that_of_the_drive(
    exponent: int, period_us: int, value: int | None
) -> None:
    """60C2: value times ten to the exponent are seconds. An exponent of 0 is one, too."""
    od = dictionary(0x60C2)
    od[0x60C2][2].access_type, od[0x60C2][2].default = "ro", exponent
    bus = BusSettings(sync_period_us=period_us)
    if value is not None:
        assert written(steps(bus=bus, od=od), 0x60C2) == [(0x60C2, 1, value)]
        assert value * Fraction(10) ** exponent == Fraction(period_us, 10**6)
        return
    od[0x60C2][1].min, od[0x60C2][1].max = 3, 200
    with pytest.raises(UserError, match="60C2") as caught:
        steps(bus=bus, od=od)
    assert caught.value.value == f"{period_us} us"
    allowed = str(caught.value.allowed)
    assert allowed.startswith("3 to 200 times a power of ten of a second")
    assert allowed.endswith(f"exponents {exponent}")


# Who watches whom


@pytest.mark.parametrize(("guard_ms", "life"), [(0, 3), (30, 0), (30, 1), (30, 255)])
def test_guarding_has_the_time_and_the_factor_of_the_declaration(guard_ms: int, life: int) -> None:
    """A factor of 0 switches the life guarding of the drive off (CiA 301, 100D)."""
    found = written(
        steps(StartUpSettings(guard_time_ms=guard_ms, life_factor=life)), 0x100C, 0x100D
    )
    assert found == ([(0x100C, 0, guard_ms), (0x100D, 0, life)] if guard_ms else [])


@pytest.mark.parametrize(("consumer_ms", "heartbeat_ms"), [(0, 50), (70, 20), (20, 70)])
@pytest.mark.parametrize("master", [1, 127])
def test_a_drive_watches_the_kernel_for_its_own_time(
    consumer_ms: int, heartbeat_ms: int, master: int
) -> None:
    """1016:1 has the node in its bits 16 to 23 and the time in its low word (CiA 301)."""
    bus = BusSettings(heartbeat_ms=heartbeat_ms, master_node=master)
    found = written(steps(StartUpSettings(consumer_ms=consumer_ms), bus), 0x1016)
    assert found == ([(0x1016, 1, (master << 16) + consumer_ms)] if consumer_ms else [])


def test_a_drive_that_is_to_watch_a_kernel_without_a_heartbeat_is_refused() -> None:
    with pytest.raises(UserError, match="the kernel sends no heartbeat") as caught:
        steps(StartUpSettings(consumer_ms=70), BusSettings(heartbeat_ms=0))
    assert caught.value.value == "consumer_ms = 70"
    assert caught.value.hint == "set heartbeat_ms in [cycle]"
    with pytest.raises(UserError, match="not by both") as caught:
        steps(StartUpSettings(heartbeat_ms=40, guard_time_ms=30))
    assert caught.value.value == "heartbeat_ms = 40"
    assert caught.value.allowed == "one of heartbeat_ms, guard_time_ms"


# What RPDOs carry for drive functions


def test_each_object_of_an_rpdo_without_a_field_is_read_before_it_is_sent() -> None:
    """Of all RPDOs in their order, with the sign of each; those of TPDOs are the drive's own."""
    maps = {**telegrams(0x60BA)}
    free = (MappedObject(0x6072, 0, 16, False, ""), MappedObject(0x60E0, 0, 16, False, ""))
    torque = MappedObject(0x60B2, 0, 16, True, "")
    first, sent = maps["RPDO1"], maps["TPDO2"]
    maps["RPDO1"] = type(first)("RPDO1", 1, 0, (first.objects[0], first.objects[1], torque))
    maps["RPDO2"] = type(first)("RPDO2", 1, 0, free)
    maps["TPDO2"] = type(first)(
        "TPDO2", 1, 0, (*sent.objects, MappedObject(0x6077, 0, 16, True, ""))
    )
    kept = [step for step in steps(maps=maps) if isinstance(step, Keep)]
    assert [(each.index, each.sub, each.signed) for each in kept] == [
        (0x60B2, 0, True), (0x6072, 0, False), (0x60E0, 0, False),
    ]  # fmt: skip
