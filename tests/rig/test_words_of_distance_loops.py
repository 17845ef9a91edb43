"""What `axisrig check` shows of a distance control as listed: each number at its own place.

FCT-M3 9: kp is P-AXIS-00759, Tn and Tv are times in s; 12.8 has the same for the channel.
"""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.oracles.distance.loop import CONST_DIST
from axisrig.bench.rig.distance.check import describe_distance, drive_lags_s
from axisrig.bench.rig.distance.loops import (
    control_lines,
    cycles_line,
    dead_cycles,
    dead_line,
    dead_words,
    is_beyond,
    law_words,
    limits_words,
    listed_for,
    loop_of,
    silence_line,
)
from axisrig.bench.rig.distance.sensors import Sensor, sensors_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import MS

Read = Callable[..., Settings]
OLDER, NEWER = "kenngr.distc.", "kenngr.dist_ctrl[0]."


def sensor_of(settings: Settings, name: str = "Z") -> Sensor:
    (sensor,) = sensors_of(settings, name)
    return sensor


@pytest.mark.parametrize("structure", [OLDER, NEWER])
@pytest.mark.parametrize(
    ("kp", "tn_s", "tv_s"), [("0.3", "0.5", "0.01"), ("0.01", "0.3", "0.5"), ("0.5", "0", "0.3")]
)
def test_each_part_of_the_listed_control_is_shown_as_what_it_is(
    rig_above: Read, structure: str, kp: str, tn_s: str, tv_s: str
) -> None:
    values = {"kp": kp, "i_tn": tn_s, "d_tv": tv_s}
    changes = [f"set:Z.{structure}{key}={value}" for key, value in values.items()]
    settings = rig_above("distance-z.toml", "", *changes)
    lines = control_lines(settings, "Z", sensor_of(settings))
    assert f"  listed       kp {kp}, Tn {tn_s} s, Tv {tv_s} s" in lines


def test_that_of_the_channel_too(rig_above: Read) -> None:
    values = {"kp": "0.3", "i_tn": "0.5", "d_tv": "0.01"}
    changes = [f"set:channel.dist_ctrl[0].{key}={value}" for key, value in values.items()]
    settings = rig_above("distance-5axis.toml", "", *changes)
    lines = control_lines(settings, CHANNEL, sensor_of(settings, "X"))
    assert "  listed       kp 0.3, Tn 0.5 s, Tv 0.01 s" in lines


@pytest.mark.parametrize("of", ["error", "feedback"])
@pytest.mark.parametrize(("unit", "worth"), [("per_second", "Tv/T"), ("per_cycle", "Tv")])
@pytest.mark.parametrize("limiter", ["slope", "clamp"])
def test_the_law_names_every_choice(
    rig_above: Read, of: str, unit: str, worth: str, limiter: str
) -> None:
    changes = (f"derivative_of={of}", f"derivative={unit}", f"limiter={limiter}")
    settings = rig_above("distance-z.toml", "", *(f"distance:{one}" for one in changes))
    words = law_words(listed_for(settings, "Z").control)
    assert words.startswith(f"derivative of the {of}, {worth} in a cycle; limiter {limiter} (")


@pytest.mark.parametrize(
    ("age", "words"), [(-1, "1 cycles newer than 6064"), (0, "0 cycles old"), (2, "2 cycles old")]
)
@pytest.mark.parametrize("late", [0, 1, 3])
@pytest.mark.parametrize(("optimised", "goes"), [(0, "the next"), (1, "the same")])
def test_the_dead_cycles_name_what_they_are_made_of(
    rig_above: Read, age: int, words: str, late: int, optimised: int, goes: str
) -> None:
    """P-AXIS-00509 is the cycle in which the offset is sent."""
    change = f"set:Z.{OLDER}optimized_scheduling={optimised}"
    settings = rig_above("distance-z.toml", "", change)
    sensor = replace(sensor_of(settings), age=age, late=late)
    dead = dead_cycles(listed_for(settings, "Z"), sensor)
    found = dead_line(settings, "Z", sensor)
    assert found.startswith(f"  dead cycles  n = {dead.dead}: the offset is sent in {goes} cycle")
    assert f"(P-AXIS-00509 = {optimised})" in found
    assert f"the sensor value is {words}" in found
    assert ("the carrier adds" in found) is (late > 0)
    assert found.endswith(f", and the carrier adds {late}" if late else words)


@pytest.mark.parametrize("every", [1, 2, 5])
def test_a_value_that_comes_seldom_is_up_to_its_period_older(rig_above: Read, every: int) -> None:
    settings = rig_above("distance-z.toml")
    sensor = replace(sensor_of(settings), every=every)
    dead = dead_cycles(listed_for(settings, "Z"), sensor)
    fresh = f"n = {dead.dead}"
    old = f"{fresh} to {dead.dead + every - 1}, a value comes every {every}."
    assert dead_words(dead, sensor) == (fresh if every == 1 else old)


@pytest.mark.parametrize(
    ("promised_ns", "limit_ms", "words"),
    [
        (None, None, "not noticed: nothing promises when the next value comes"),
        (None, 7.0, "not noticed: nothing promises when the next value comes"),
        (MS, None, "a value every 1 ms is promised; control freezes when it is older than 3 ms"),
        (4 * MS, None, "a value every 4 ms is promised; control freezes when it is older than 12"),
        (4 * MS, 7.5, "a value every 4 ms is promised; control freezes when it is older than 7.5"),
        (MS, 0.0, "a value every 1 ms is promised; control freezes when it is older than 0 ms"),
    ],
)
def test_a_silent_sensor_is_noticed_after_three_of_its_periods_or_the_limit_of_the_rig(
    rig_above: Read, promised_ns: int | None, limit_ms: float | None, words: str
) -> None:
    sensor = replace(sensor_of(rig_above("distance-z.toml")), promised_ns=promised_ns)
    found = silence_line(sensor, limit_ms)
    assert found.startswith(f"  silence      {words}")
    assert ("900314" in found) is (promised_ns is not None)


@pytest.mark.parametrize("optimised", [(1, 1, 1), (1, 0, 1), (0, 0, 0)])
def test_cycles_of_a_real_control_are_those_of_every_axis(
    rig_above: Read, optimised: tuple[int, int, int]
) -> None:
    """P-AXIS-00191 sorted, each once; P-AXIS-00276 acts where all axes have it."""
    changes = []
    for name, delay, value in zip("XYZ", (10, 2, 4), optimised, strict=True):
        changes.append(f"set:{name}.antr.nbr_delay_cycles={delay}")
        changes.append(f"set:{name}.lr_param.field_bus_allows_optimized_schedule={value}")
    rest = ("A", "C")
    for name in rest:
        changes.append(f"set:{name}.antr.nbr_delay_cycles=7")
        changes.append(f"set:{name}.lr_param.field_bus_allows_optimized_schedule=1")
    settings = rig_above("distance-5axis.toml", "", *changes)
    dead = dead_cycles(listed_for(settings, CHANNEL), sensor_of(settings, "X"))
    found = cycles_line(settings, CHANNEL, dead)
    assert f"P-AXIS-00191 = 2, 4, 7, 10, P-AXIS-00276 = {int(all(optimised))}:" in found
    assert f"changes n = {dead.dead}," in found
    for name, delay in zip("XYZ", (10, 2, 4), strict=True):
        own = cycles_line(settings, name, dead)
        assert f"P-AXIS-00191 = {delay}, P-AXIS-00276 = {int(all(optimised))}:" in own


@pytest.mark.parametrize(
    ("share", "beyond"), [(1.0, True), (1.0 - 1e-7, True), (0.9999, False), (1.1, True), (0, False)]
)
def test_a_gain_at_its_limit_rings_for_ever(share: float, beyond: bool) -> None:
    assert is_beyond(0.25 * share, 0.25) is beyond


class Slave:
    """An FMU with these variables."""

    def __init__(self, **values: float) -> None:
        self.values = values

    def has(self, name: str) -> bool:
        return name in self.values

    def get(self, name: str) -> float:
        return self.values[name]


@pytest.mark.parametrize(
    ("slave", "lag_s"),
    [
        (Slave(kv=40.0, feed_forward=0.0), 0.025),
        (Slave(kv=40.0, feed_forward=1.0), 0.0),
        (Slave(kv=20.0, feed_forward=0.4), 0.03),
        (Slave(kv=0.0, feed_forward=0.0), 0.0),  # without a loop there is no lag
        (Slave(kv=40.0), None),
        (Slave(feed_forward=0.5), None),
        (None, None),
    ],
)
def test_a_drive_lags_by_what_its_gain_and_its_feed_forward_leave(
    slave: Slave | None, lag_s: float | None, rig_above: Read
) -> None:
    """At a steady speed v the lag is (1 - f) v/Kv: a time of (1 - f)/Kv."""
    settings = rig_above("distance-xz.toml")
    other = Slave(kv=100.0, feed_forward=0.5)
    axes: dict[str, Any] = {"x": SimpleNamespace(slave=other)}
    if slave is not None:
        axes["z"] = SimpleNamespace(slave=slave)
    plant: Any = SimpleNamespace(axes=axes)
    found = drive_lags_s(settings, plant)
    assert found.pop("X") == pytest.approx(0.005)
    assert found == ({} if lag_s is None else {"Z": pytest.approx(lag_s)})


@pytest.mark.parametrize(
    ("age", "cycles", "past"), [(-1, "2.5", "0.025"), (0, "3.5", "0.035"), (2, "5.5", "0.055")]
)
def test_a_step_goes_past_by_all_that_its_sensor_is_late(
    rig_above: Read, age: int, cycles: str, past: str
) -> None:
    """v_max T (n + delay of the filter): 10 mm/s, 1 ms, n = 2 and the age, 1.5 of the filter."""
    values = {"kp": 0.3, "a_max": 100, "v_max": 10000}
    changes = [f"set:Z.{OLDER}{key}={value}" for key, value in values.items()]
    settings = rig_above("distance-z.toml", "", *changes)
    sensor = replace(sensor_of(settings), age=age)
    listed = listed_for(settings, "Z")
    words = limits_words(listed, 1000, loop_of(settings, "Z", sensor, CONST_DIST))
    assert f"by {past} mm in CONST_DIST, whose error is {cycles} cycles old" in words


@pytest.mark.parametrize(
    ("model", "lag_s", "words"),
    [
        ("KinematicAxis", 0.0, None),
        ("KinematicAxis", 0.02, None),  # it follows its demand whatever is given
        ("ServoAxis", 0.0, "  drive        what else its loops add"),
        ("ServoAxis", 0.0125, "  drive        lags by 12.5 ms, counted below as a first order"),
    ],
)
def test_what_a_drive_adds_to_the_loop_is_reported_where_it_has_a_lag(
    rig_above: Read, model: str, lag_s: float, words: str | None
) -> None:
    """What is known of its limits of kp goes with that."""
    settings = rig_above("distance-z.toml", f'[plant.z]\nfmu = "AxisRig.Drives.{model}"')
    (text,) = describe_distance(settings, {"Z": lag_s, "X": 1.0})
    drives = [line for line in text.splitlines() if line.startswith("  drive ")]
    expected = [] if words is None else [words]
    assert [line[: len(words or "")] for line in drives] == expected
    assert ("not known as listed" in text) is (words is not None)
