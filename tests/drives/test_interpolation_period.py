"""The period of the cycle reaches a drive that has 60C2, whatever else it has.

Source: CiA 402-2, object 60C2: time = value (sub-index 1) * 10^index (sub-index 2) seconds.
"""

from collections.abc import Callable
from copy import deepcopy
from fractions import Fraction
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.canopen.startup_steps import (
    BusSettings,
    Scaling,
    StartUpSettings,
    Write,
    start_up_steps,
)
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
INTERPOLATION = 0x60C2


def periods(period_us: int, od: Any) -> list[tuple[int, int, int]]:
    """What is written of the period, in its order."""
    steps = start_up_steps(
        StartUpSettings(), BusSettings(sync_period_us=period_us), telegrams(0x60BA), 3,
        Scaling(1 << 20, Fraction(1 << 20)), od,
    )  # fmt: skip
    return [
        (step.index, step.sub, int.from_bytes(step.data, "little", signed=step.sub == 2))
        for step in steps
        if isinstance(step, Write) and step.index in (0x1006, INTERPOLATION)
    ]


@pytest.mark.parametrize(
    ("period_us", "value", "index"),
    [
        (250, 25, -5), (1000, 1, -3), (1200, 12, -4), (2000, 2, -3), (2550, 255, -5),
        (10_000, 1, -2), (20_000, 2, -2),
    ],
)  # fmt: skip
def test_60c2_gets_the_period_as_value_and_power_of_ten(
    period_us: int, value: int, index: int
) -> None:
    written = periods(period_us, object_dictionary(3, DriveProfile()))
    assert written == [
        (0x1006, 0, period_us), (INTERPOLATION, 1, value), (INTERPOLATION, 2, index),
    ]  # fmt: skip
    assert value * Fraction(10) ** index == Fraction(period_us, 10**6)


@pytest.mark.long
def test_what_the_eds_lacks_is_left_out() -> None:
    assert periods(2000, object_dictionary(3, DriveProfile(lacks="60C2"))) == [(0x1006, 0, 2000)]
    alone = periods(2000, object_dictionary(3, DriveProfile(lacks="1006")))
    assert alone == [(INTERPOLATION, 1, 2), (INTERPOLATION, 2, -3)]
    assert periods(2000, object_dictionary(3, DriveProfile(lacks="1006 60C2"))) == []


@pytest.mark.parametrize("sub", [1, 2])
def test_60c2_that_lacks_its_value_or_its_power_of_ten_is_left_out(sub: int) -> None:
    od = deepcopy(object_dictionary(3, DriveProfile()))
    del od[INTERPOLATION].subindices[sub]
    assert periods(2000, od) == [(0x1006, 0, 2000)]


def test_limits_and_access_of_the_eds_are_kept() -> None:
    """Drives of makers: an index from -4 on, one that is fixed, a value of a few steps."""
    od = deepcopy(object_dictionary(3, DriveProfile()))
    value, index = od[INTERPOLATION][1], od[INTERPOLATION][2]
    index.max = -4
    assert periods(2000, od)[1:] == [(INTERPOLATION, 1, 20), (INTERPOLATION, 2, -4)]
    value.min, index.max = 50, None
    assert periods(2000, od)[1:] == [(INTERPOLATION, 1, 200), (INTERPOLATION, 2, -5)]
    value.min, index.access_type, index.default = None, "ro", -4
    assert periods(2000, od)[1:] == [(INTERPOLATION, 1, 20)]
    value.access_type = "ro"
    assert periods(2000, od)[1:] == []


@pytest.mark.parametrize(("period_us", "lowest"), [(1001, -6), (2570, -6), (250, -4)])
def test_a_period_that_60c2_cannot_say_is_refused(period_us: int, lowest: int) -> None:
    od = deepcopy(object_dictionary(3, DriveProfile()))
    od[INTERPOLATION][2].min = lowest
    with pytest.raises(UserError) as caught:
        periods(period_us, od)
    assert "60C2" in caught.value.message
    assert caught.value.value == f"{period_us} us"
    assert caught.value.hint == "choose another period_us of [cycle]"
    assert str(lowest) in str(caught.value.allowed)


@pytest.mark.parametrize("lacks", ["", "1006", "60C2"])
def test_a_drive_at_2_ms_leads_its_demand_over_2_ms(link_bench: Make, lacks: str) -> None:
    """10 mm/s at 2 ms with 1 ms in the drive would wait 1 ms of each 2, 10 um behind."""
    bench = link_bench(profile=DriveProfile(lacks=lacks, input_delay_ns=0))
    bench.scheduler.run_until(2 * MS)
    ended = bench.start_up(bus=BusSettings(sync_period_us=2000))
    bench.scheduler.run_while(lambda: not ended, None)
    assert ended == [None]
    assert bench.node.servo.interpolation.period_ns() == 2 * MS
