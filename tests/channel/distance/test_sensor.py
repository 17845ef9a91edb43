"""From what a sensor counts to millimetres against the motor (P-AXIS-00230, 00422 to 00424)."""

from collections.abc import Callable
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.distance.sensor import EncoderSensor, SensorSettings, VariableSensor
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]


def counting(*counts: int | None) -> Any:
    """A link whose second encoder counts so, one value per look."""
    values = iter(counts)

    class Link(SimpleNamespace):
        @property
        def second_increments(self) -> int | None:
            return next(values)

    return Link(has_second=True)


def read(settings: SensorSettings, *counts: int | None) -> list[float | None]:
    sensor = EncoderSensor(counting(*counts), settings)
    return [sensor.read_mm() for _ in counts]


def test_without_a_resolution_an_increment_is_a_tenth_of_a_micrometre() -> None:
    assert read(SensorSettings(), 0, 1, -25_000, None) == [0.0, 1e-4, -2.5, None]


@pytest.mark.parametrize(
    ("numerator", "denominator"), [(1, 1), (2**20, 100_000), (7, 3), (3, 7), (4096, 10_000)]
)
@pytest.mark.parametrize("count", [1, -1, 123_457, -2_000_000_001])
def test_position_is_increments_by_00423_over_00422(
    numerator: int, denominator: int, count: int
) -> None:
    settings = SensorSettings(numerator, denominator)
    exact = Fraction(count) * denominator / numerator / 10_000
    assert read(settings, count) == [pytest.approx(float(exact), rel=1e-15)]


def test_sign_and_reference_offset() -> None:
    """The offset is told in the counting direction of the control: it is taken off last."""
    assert read(SensorSettings(is_inverted=True), 5000) == [-0.5]
    assert read(SensorSettings(ref_offset_mm=2.0), 5000) == [-1.5]
    assert read(SensorSettings(is_inverted=True, ref_offset_mm=2.0), 5000) == [-2.5]


def test_a_modulo_encoder_counts_on_where_its_32_bits_begin_anew() -> None:
    top = 2**31 - 1
    counts = (top - 1, -top - 1, -top + 8, top - 3)
    linear = read(SensorSettings(), *counts)
    assert linear == [count / 10_000 for count in counts]
    turning = read(SensorSettings(is_modulo=True), *counts)
    assert turning == [n / 10_000 for n in (top - 1, top + 1, top + 10, top - 3)]


@pytest.mark.parametrize(
    ("mode", "kind", "is_modulo"),
    [
        ("0", "ACHSTYP_TRANSLATOR", False),
        ("0", "ACHSTYP_ROTATOR", True),
        ("1", "ACHSTYP_ROTATOR", False),
        ("2", "ACHSTYP_TRANSLATOR", True),
    ],
)
def test_the_list_says_how_the_sensor_counts(mode: str, kind: str, is_modulo: bool) -> None:
    axis = ParameterSet("axis")
    for path, text in {
        "kenngr.achs_typ": kind,
        "lr_hw[1].mode_act_pos": mode,
        "lr_hw[1].vz_istw": "1",
        "lr_hw[1].encoder_resolution_num": "1048576",
        "lr_hw[1].encoder_resolution_denom": "100000",
        "kenngr.dist_ctrl[0].ref_offset": "-12345",
    }.items():
        axis.set(path, text, "test")
    assert SensorSettings.read(axis) == SensorSettings(2**20, 100_000, is_modulo, True, -1.2345)


@pytest.mark.parametrize("name", ["SENSOR", "V.E.SENSOR"])
def test_a_variable_is_in_tenths_of_micrometres_as_the_plc_has_it(name: str) -> None:
    values = {"SENSOR": -12_500.0}
    settings = SensorSettings(2**20, 100_000, True, is_inverted=True, ref_offset_mm=0.25)
    sensor = VariableSensor(name, values, settings)
    assert sensor.read_mm() == -1.5
    assert (sensor.period_ns(MS), sensor.age_cycles) == (None, 0), "nobody promises a period"
    missing = VariableSensor("V.E.OTHER", values, settings)
    assert (missing.exists, missing.read_mm()) == (False, None)


# On the bus


def test_the_sensor_value_is_of_the_sync_of_the_actual_position(
    distance_bench: Make, say: Any, words: Any
) -> None:
    """The surface stands, the axis moves at 10 mm/s: sensor and position always add up to it."""
    made = distance_bench(lambda _time_ns: 3.25)
    made.run(words.move(1, 600.0, Z=12.0))
    both = zip(made.seen.actual_mm, made.seen.sensor_mm, strict=True)
    sums = [actual + sensor for actual, sensor in both if sensor is not None]
    assert len(set(made.seen.actual_mm)) > 100
    assert sums == pytest.approx([3.25] * len(sums), abs=1.01 / say.per_mm)


def test_a_command_takes_the_value_of_the_moment_in_which_it_acts(distance_bench: Make) -> None:
    """REF, CHECK_POS and ON may come before the sensor was read in this cycle, or ever."""
    made = distance_bench()
    values, axis = made.channel.plc.values, made.channel.distance.axes["Z"]
    values["SENSOR"] = 1_000.0
    axis.choose("VARIABLE", "SENSOR")
    for value in (2_000.0, -5_000.0):
        values["SENSOR"] = value
        assert axis.require_sensor() == axis.sensor_mm == value / 1e4
    del values["SENSOR"]
    with pytest.raises(Alarm, match=r"31002[789]"):
        axis.require_sensor()


def test_control_by_a_variable_takes_the_value_of_the_same_cycle(
    distance_bench: Make, say: Any
) -> None:
    made = distance_bench()
    values = made.channel.plc.values
    values["SENSOR"] = 0.0
    made.at({100: lambda: values.update(SENSOR=2_000.0)})
    made.run(
        say.command(sensor_source="VARIABLE", sensor_variable="V.E.SENSOR"),
        say.command("on_const", set_dist_mm=0.0), say.dwell(150),
    )  # fmt: skip
    # d = -s = -0.2 mm; kp 0.5; the variable does not follow the axis
    assert made.seen.offset_mm[99:102] == pytest.approx([0.0, 0.1, 0.2])
    assert made.seen.state[99] is DistanceState.ACTIVE_CONST_DIST


@pytest.mark.long
def test_surface_and_distance_are_shown_to_the_plc(distance_bench: Make, say: Any) -> None:
    made = distance_bench(lambda time_ns: 1.5 if time_ns > 100 * MS else 0.5, v_max_mm_s=100.0)
    made.run(say.command("on_const", set_dist_mm=2.0), say.dwell(300))
    shown = made.channel.plc.axis["Z"].distance.state_r
    assert shown.surface_mm == pytest.approx(1.5, abs=2 / say.per_mm)
    assert shown.distance_mm == pytest.approx(2.0, abs=2 / say.per_mm)
    assert shown.state is DistanceState.ACTIVE_CONST_DIST
    assert shown.actual_offset_mm == made.control.offset_mm
