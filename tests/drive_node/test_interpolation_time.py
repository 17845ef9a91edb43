"""Over which time a set value of a cyclic mode is led: 60C2 where it was written, else 1006."""

import pytest

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.functions.interpolation import InterpolationTime
from axisrig.kernel.time.clock import MS, US


def made(period_us: int = 0) -> tuple[ProcessImage, InterpolationTime]:
    """With the default of 60C2, 1 ms."""
    image = ProcessImage()
    image.set_defaults(DriveProfile())
    image.sync_period_us = period_us
    return image, InterpolationTime(image)


@pytest.mark.parametrize(
    ("value", "index", "time_ns"),
    [(1, -3, MS), (20, -4, 2 * MS), (250, -6, 250 * US), (5, -2, 50 * MS), (1, -1, 100 * MS)],
)
@pytest.mark.parametrize("period_us", [0, 4000])
def test_60c2_that_is_not_its_default_counts(
    value: int, index: int, time_ns: int, period_us: int
) -> None:
    """A value that was stored is in the object at power on; either of its two parts may differ."""
    image, time = made(period_us)
    image.interpolation_value, image.interpolation_index = value, index
    time.update()
    is_default = (value, index) == (1, -3)
    assert time.period_ns() == (period_us * US if is_default and period_us else time_ns)


@pytest.mark.parametrize(("value", "index"), [(1, -2), (2, -3)])
def test_60c2_is_the_default_again_after_power(value: int, index: int) -> None:
    """Without 1006 the time is that of the object at once, and with it 1006 counts."""
    image, time = made()
    image.interpolation_value, image.interpolation_index = value, index
    time.written()
    assert time.period_ns() == value * 10 ** (9 + index)
    image.interpolation_value, image.interpolation_index = 1, -3
    time.forget()
    assert time.period_ns() == MS
    image.sync_period_us = 5000
    assert time.period_ns() == 5 * MS


def test_the_default_counts_where_it_was_written() -> None:
    image, time = made(7000)
    assert time.period_ns() == 7 * MS
    time.written()
    assert time.period_ns() == MS
    image.sync_period_us = 3000
    assert time.period_ns() == MS
    time.forget()
    assert time.period_ns() == 3 * MS
