"""The check of what a control has computed: v_max and a_max of its offset, by hand."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.distance.test_sensing_by_hand import Bench

from axisrig.kernel.channel.distance.channel import ChannelDistance
from axisrig.kernel.channel.distance.sensing import Sensing
from axisrig.kernel.channel.distance.settings import ChannelDistanceSettings
from axisrig.kernel.distance import DistanceSettings, Reading
from axisrig.kernel.distance.limiter import UNLIMITED
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

READING = Reading(0.0, 0.0, 0.0)
V_STEP_MM, A_STEP_MM, INCREMENT_MM = 0.1, 0.01, 0.001  # 100 mm/s, 10 m/s², of 1 ms
PASSED = 900501


class Stepped:
    """A control that moves its offset by the steps of the test; failed: with which alarm."""

    def __init__(self, **settings: Any) -> None:
        self.settings = DistanceSettings(
            v_max_mm_s=100.0, a_max_mm_s2=1e4, max_deviation_mm=10.0
        ).replaced(**settings)
        self.owner, self.offset_mm, self.step_mm = "axis Z", 0.0, 0.0
        self.next_mm = 0.0

    def step(self, _reading: Reading) -> None:
        self.offset_mm += self.next_mm
        self.step_mm = self.next_mm

    def fail(self, alarm: Alarm) -> None:
        raise alarm


def checked(**settings: Any) -> tuple[Sensing, Stepped]:
    axis, control = Bench().axis, Stepped(**settings)
    stepped: Any = control
    axis.control = stepped
    return axis, control


def walk(steps_mm: list[float], **settings: Any) -> Alarm | None:
    """Do these steps; all but the last are within the limits."""
    axis, control = checked(**settings)
    for step_mm in steps_mm[:-1]:
        control.next_mm = step_mm
        axis.control_within_limits(READING)
    before_mm, control.next_mm = control.offset_mm, steps_mm[-1]
    try:
        axis.control_within_limits(READING)
    except Alarm as alarm:
        assert control.offset_mm == before_mm  # it stays where it was
        return alarm
    assert control.offset_mm == pytest.approx(before_mm + steps_mm[-1])
    return None


def ramp(to_mm: float, by_mm: float = A_STEP_MM) -> list[float]:
    count = round(abs(to_mm) / by_mm)
    return [to_mm * (n + 1) / count for n in range(count)]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("beyond_mm", "passes"), [(0.0, False), (INCREMENT_MM, False), (INCREMENT_MM + 1e-6, True)]
)
def test_a_step_is_as_long_as_the_speed_and_an_increment_at_most(
    sign: float, beyond_mm: float, passes: bool
) -> None:
    steps = [sign * step for step in [*ramp(V_STEP_MM), V_STEP_MM + beyond_mm]]
    alarm = walk(steps)
    assert (alarm is not None) is passes
    if alarm is not None:
        assert (alarm.id, alarm.values["owner"]) == (PASSED, "axis Z")
        speed, a = (float(text.split()[0]) for text in str(alarm.values["what"]).split(", "))
        assert speed == pytest.approx(sign * (V_STEP_MM + beyond_mm) * 1e3, rel=1e-5)
        assert a == pytest.approx(sign * beyond_mm * 1e6, rel=1e-5)  # six digits
        assert alarm.values["allowed"] == "100 mm/s and 10000 mm/s2"


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("before_mm", [0.0, 0.03, 0.05])
@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("beyond_mm", "passes"), [(0.0, False), (2 * INCREMENT_MM, False), (0.003, True)]
)
def test_a_step_changes_by_the_acceleration_and_two_increments_at_most(
    sign: float, before_mm: float, way: float, beyond_mm: float, passes: bool
) -> None:
    """Faster and slower alike, but for a stop."""
    steps = [*ramp(before_mm), before_mm + way * (A_STEP_MM + beyond_mm)]
    alarm = walk([sign * step for step in steps])
    assert (None if alarm is None else alarm.id) == (PASSED if passes else None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_offset_may_stop_at_once_and_then_begins_with_speed_0(sign: float) -> None:
    assert walk([sign * step for step in [*ramp(0.08), 0.0]]) is None
    assert walk([sign * step for step in [*ramp(0.08), 0.0, A_STEP_MM]]) is None
    assert walk([sign * step for step in [*ramp(0.08), 0.0, 0.08]]) is not None


def test_what_has_stopped_at_once_and_goes_on_in_the_same_cycle_begins_with_speed_0() -> None:
    """FREEZE and ON: the control has no step any more, whatever the last one was."""
    axis, control = checked()
    for step_mm in ramp(0.08):
        control.next_mm = step_mm
        axis.control_within_limits(READING)
    control.step_mm, control.next_mm = 0.0, A_STEP_MM
    axis.control_within_limits(READING)
    assert control.offset_mm == pytest.approx(sum(ramp(0.08)) + A_STEP_MM)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("last_mm", "passes"),
    [(0.01, False), (0.069, False), (-0.01, True), (0.085, False), (0.095, True)],
)
def test_at_the_end_of_its_range_an_offset_may_be_cut_to_what_is_left(
    sign: float, last_mm: float, passes: bool
) -> None:
    """From 80 um in a cycle: any smaller step in the same direction that ends at the limit."""
    before = ramp(0.08)
    limit_mm = abs(sum(before) + last_mm)
    steps = [sign * step for step in [*before, last_mm]]
    assert (walk(steps, max_deviation_mm=limit_mm) is not None) is passes
    # elsewhere it brakes by its acceleration
    is_gentle = abs(last_mm - 0.08) <= A_STEP_MM + 2 * INCREMENT_MM
    assert (walk(steps) is None) is is_gentle


def test_a_speed_that_a_program_lowers_is_left_step_by_step() -> None:
    """v_max falls to 20 mm/s at 100: steps above it are no error while they get shorter."""
    axis, control = checked()
    for step_mm in ramp(0.1):
        control.next_mm = step_mm
        axis.control_within_limits(READING)
    control.settings = control.settings.replaced(v_max_mm_s=20.0)
    for step_mm in (0.1, 0.09, 0.08):
        control.next_mm = step_mm
        axis.control_within_limits(READING)
    control.next_mm = 0.085
    with pytest.raises(Alarm) as caught:
        axis.control_within_limits(READING)
    assert caught.value.values["allowed"] == "20 mm/s and 10000 mm/s2"


@pytest.mark.parametrize(
    ("v_permille", "a_permille", "v_step_mm", "a_step_mm"),
    [(0, 0, 0.1, 0.01), (1500, 0, 0.15, 0.01), (0, 2000, 0.1, 0.02), (1500, 2000, 0.15, 0.02),
     (500, 500, 0.1, 0.01)],
)  # fmt: skip
def test_weights_above_a_whole_lift_the_limits_and_smaller_ones_do_not_lower_them(
    v_permille: int, a_permille: int, v_step_mm: float, a_step_mm: float
) -> None:
    """The check has one limit for both ways; the limiter weights the way down alone."""
    weights = {"v_weight_down_permille": v_permille, "a_weight_down_permille": a_permille}
    up = ramp(v_step_mm)
    assert walk([*up, v_step_mm + INCREMENT_MM], **weights) is None
    assert walk([*up, v_step_mm + 1.5 * INCREMENT_MM], **weights) is not None
    assert walk([a_step_mm + 2 * INCREMENT_MM], **weights) is None
    alarm = walk([a_step_mm + 2.5 * INCREMENT_MM], **weights)
    assert alarm is not None
    allowed = f"{v_step_mm * 1e3:.6g} mm/s and {a_step_mm * 1e6:.6g} mm/s2"
    assert alarm.values["allowed"] == allowed


@pytest.mark.parametrize("increments_per_mm", [(1e6, 1e3, 1e6), (1e3, 1e6, 1e6), (1e6, 1e6, 1e3)])
def test_the_coarsest_drive_of_a_channel_counts(increments_per_mm: tuple[float, ...]) -> None:
    links: Any = [
        SimpleNamespace(
            name=name, actual_mm=0.0, set_mm=0.0, settings=SimpleNamespace(increments_per_mm=per_mm)
        )
        for name, per_mm in zip("XYZ", increments_per_mm, strict=True)
    ]
    found = ChannelDistance(
        ChannelDistanceSettings(DistanceSettings()), [UNLIMITED] * 3, links, lambda: None, {}, {},
        MS,
    )  # fmt: skip
    control: Any = Stepped()
    found.control = control
    control.next_mm = A_STEP_MM + 2 * INCREMENT_MM
    found.control_within_limits(READING)
    control.next_mm += A_STEP_MM + 3 * INCREMENT_MM
    with pytest.raises(Alarm):
        found.control_within_limits(READING)
