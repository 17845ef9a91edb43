"""The last position that 32 bits hold, and the last lag that a rig lets pass."""

from math import inf, nextafter
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.drives.position_watch import lag_alarm
from axisrig.kernel.drives.set_points import SetPoints


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("per_mm", [1000.0, 1 << 20])
def test_a_position_fits_into_32_bits_up_to_the_last_increment(sign: int, per_mm: float) -> None:
    """2^31 increments are one too many, on either side."""
    points = SetPoints(per_mm, 1, inf)
    end_mm = (1 << 31) / per_mm
    assert points.can_reach(sign * (end_mm - 1 / per_mm))
    assert not points.can_reach(sign * end_mm)
    assert not points.can_reach(sign * (end_mm + 1 / per_mm))
    assert points.can_reach(0.0)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("limit_mm", "lag_mm", "watches", "is_beyond"),
    [
        (0.5, 0.5, True, False),
        (0.5, nextafter(0.5, 1.0), True, True),
        (0.5, 0.6, False, False),  # as in a run to a fixed stop
        (0.5, 0.0, True, False),
        (inf, 1e6, True, False),
    ],
)
def test_a_lag_at_the_limit_passes_and_one_beyond_it_does_not(
    sign: int, limit_mm: float, lag_mm: float, watches: bool, is_beyond: bool
) -> None:
    drive: Any = SimpleNamespace(
        name="Z", frozen=None, watches_lag=watches, lag_mm=sign * lag_mm,
        settings=SimpleNamespace(lag_limit_mm=limit_mm),
    )  # fmt: skip
    alarm = lag_alarm(drive)
    assert (alarm is not None) is is_beyond
    if alarm is not None:
        assert (alarm.id, alarm.values["limit_mm"]) == (900036, "0.5")


@pytest.mark.parametrize("limit_mm", [0.5, inf])
def test_an_encoder_that_stands_comes_before_any_lag(limit_mm: float) -> None:
    drive: Any = SimpleNamespace(
        name="Z", frozen=SimpleNamespace(is_frozen=True, speed_mm_s=-12.345678),
        watches_lag=True, lag_mm=9.0, settings=SimpleNamespace(lag_limit_mm=limit_mm),
    )  # fmt: skip
    alarm = lag_alarm(drive)
    assert alarm is not None
    assert (alarm.id, alarm.values["speed_mm_s"], alarm.values["time_ms"]) == (
        900037, "-12.35", "50"
    )  # fmt: skip
    drive.frozen.is_frozen = False
    found = lag_alarm(drive)
    assert (None if found is None else found.id) == (900036 if limit_mm == 0.5 else None)
