"""What the types say about speed, stroke, overtravel and a missing signal."""

from math import inf, sqrt

import pytest

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import (
    MeasuringAxis,
    least_stroke_mm,
    lengthened,
    misses_signal,
)
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.parameters.signal_sources import SOURCES

FLAT = Slope(1000.0, 1000.0, 100.0)
TYPES = measuring_types()


@pytest.mark.parametrize("stroke_mm", [0.0, 0.01, 1.0, 5.0, 50.0])
def test_one_slope_stops_from_the_root_of_two_a_s(stroke_mm: float) -> None:
    assert FLAT.speed_within(stroke_mm) == pytest.approx(sqrt(2 * 1000.0 * stroke_mm))


def test_two_steps_stop_from_a_speed_of_the_upper_one() -> None:
    """To 50 mm/s 500 mm/s2: 2.5 mm. The other 2.5 mm at 2000: v^2 = 2500 + 2 * 2000 * 2.5."""
    assert Slope(500.0, 2000.0, 50.0).speed_within(5.0) == pytest.approx(sqrt(12500.0))
    assert Slope(500.0, 2000.0, 50.0).speed_within(2.5) == pytest.approx(50.0)


@pytest.mark.parametrize("stroke_mm", [0.3, 2.5, 4.0, 40.0])
def test_the_braking_distance_of_that_speed_is_the_stroke(stroke_mm: float) -> None:
    slope = Slope(700.0, 1900.0, 61.0)
    assert slope.distance_mm(slope.speed_within(stroke_mm)) == pytest.approx(stroke_mm)


@pytest.mark.parametrize(("number", "keeps"), [(1, False), (2, True), (3, False), (4, True)])
def test_types_2_and_4_keep_to_the_smallest_stroke_of_the_path(number: int, keeps: bool) -> None:
    axes = [MeasuringAxis(stroke_mm=5.0), MeasuringAxis(stroke_mm=2.0)]
    assert least_stroke_mm(TYPES[number], axes) == (2.0 if keeps else inf)


@pytest.mark.parametrize(
    ("number", "new_mm", "old_mm", "expected_mm"),
    [
        (1, 2.0, 3.0, 2.0),
        (1, 0.0, 3.0, 0.0),
        (2, 2.0, 3.0, 2.0),
        (2, 0.0, 3.0, 3.0),
        (3, 2.0, 3.0, 0.0),
        (4, 2.0, 3.0, 2.0),
        (5, 2.0, 3.0, 2.0),
    ],
)
def test_overtravel_of_each_type(
    number: int, new_mm: float, old_mm: float, expected_mm: float
) -> None:
    """P-AXIS-00467 for all but type 3; P-AXIS-00114 for type 2 while 00467 is 0."""
    axis = MeasuringAxis(offset_mm=new_mm, old_offset_mm=old_mm)
    assert axis.overtravel_mm(TYPES[number]) == expected_mm


def test_the_axis_that_allows_least_decides_how_far_a_path_goes_on() -> None:
    """30 and 40 mm: 3 mm are a tenth of the first, 2 mm a twentieth of the second."""
    target = lengthened({"Y": 0.0, "Z": 0.0}, {"Y": 30.0, "Z": 40.0}, {"Y": 3.0, "Z": 2.0})
    assert target == pytest.approx({"Y": 31.5, "Z": 42.0})
    same = {"Y": 0.1, "Z": 0.3}
    assert lengthened({"Y": 0.0, "Z": 0.3}, same, {"Y": 0.0}) == same


@pytest.mark.parametrize(
    ("number", "parameter", "programmed", "is_alarm"),
    [
        *((1, parameter, None, parameter) for parameter in (True, False)),
        *((2, parameter, said, True) for parameter in (True, False) for said in (None, False)),
        *((number, True, None, False) for number in (3, 4, 5)),
        *((number, False, True, True) for number in (1, 3, 4)),
        *((number, True, False, False) for number in (1, 3, 4)),
        (5, True, True, False),
    ],
)
def test_which_types_want_a_signal(
    number: int, parameter: bool, programmed: bool | None, is_alarm: bool
) -> None:
    """FCT-C4 8.2.1: P-CHAN-00176 is about type 1; type 2 always, type 5 never."""
    assert misses_signal(TYPES[number], parameter, programmed) is is_alarm


@pytest.mark.parametrize(
    ("number", "source", "mode", "is_beside", "refused"),
    [
        (1, "DRIVE", 0, False, None),
        (1, "DRIVE", 4, False, None),
        (1, "FIXED_STOP", 0, False, 900242),
        (1, "FIXED_STOP", 4, False, None),  # the simulated probe is the signal
        (1, "DRIVE", 4, True, 900100),
        (7, "FIXED_STOP", 0, False, None),
        (7, "FIXED_STOP", 0, True, None),
        (7, "PLC", 0, False, 900241),
        (7, "FIXED_STOP", 4, False, 900100),
    ],
)
def test_which_signal_may_end_a_run_of_a_type(
    number: int, source: str, mode: int, is_beside: bool, refused: int | None
) -> None:
    axis = MeasuringAxis(simulated=(mode, 0, 0, 0, 0))
    if refused is None:
        axis.check("Z", TYPES[number], source, is_beside=is_beside)
        return
    with pytest.raises(Alarm) as caught:
        axis.check("Z", TYPES[number], source, is_beside=is_beside)
    assert caught.value.id == refused


@pytest.mark.parametrize("source", sorted(SOURCES))
@pytest.mark.parametrize("mode", range(7))
def test_a_simulated_probe_needs_no_plc_whatever_its_list_has_as_source(
    source: str, mode: int
) -> None:
    axis = MeasuringAxis(source=source, simulated=(mode, 0, 0, 0, 0))
    is_at_plc = source.startswith("PLC") or source == "EXT_PROBE_WITH_DRIVE"
    assert axis.needs_plc(source) is (is_at_plc and mode == 0)


def test_parameters_of_an_axis_in_the_units_of_the_kernel() -> None:
    axis = ParameterSet("axis")
    for path, text in {
        "kenngr.vb_messen": "5000",
        "kenngr.hub_messtaster": "20000",
        "kenngr.probing_offset": "15000",
        "kenngr.mess_offset": "2500",
        "kenngr.probe_actuation_time_delay": "10000",
        "kenngr.measure.input": "2",
        "kenngr.measure.probe[1].input": "1",
    }.items():
        axis.set(path, text, "test")
    expected = MeasuringAxis(5.0, 2.0, 1.5, 0.25, 10_000_000, (2, 1), probe_input=2)
    assert MeasuringAxis.read(axis) == expected


@pytest.mark.parametrize(
    ("settings", "source", "probe_input", "edge"),
    [
        ({"kenngr.mess_signal_achs_steuer": "1"}, "PLC", 1, "POS"),  # P-AXIS-00115
        ({"kenngr.mess_signal_sercos": "1"}, "DRIVE", 1, "POS"),  # 00116
        ({"kenngr.mess_signal_taster": "1"}, "DRIVE", 1, "POS"),  # 00117
        ({"kenngr.probing_signal_via_plc": "1"}, "PLC", 1, "POS"),  # 00257
        ({"kenngr.meas_signal_drive": "1"}, "DRIVE", 1, "POS"),  # 00269
        ({"kenngr.mess_neg_flanke": "1"}, "DRIVE", 1, "NEG"),  # 00113
        ({"antr.probing_input_nbr": "2"}, "DRIVE", 2, "POS"),  # 00430
        ({"antr.canopen.probing_input_number": "2"}, "DRIVE", 2, "POS"),  # 00295
        (
            {
                "kenngr.probing_signal_via_plc": "1",
                "kenngr.mess_neg_flanke": "1",
                "antr.probing_input_nbr": "2",
            },
            "PLC",
            2,
            "NEG",
        ),
        (
            {"kenngr.measure.signal": "DRIVE", "kenngr.probing_signal_via_plc": "1"},
            "DRIVE",
            1,
            "POS",
        ),
    ],
)
def test_older_parameters_arrive_at_their_source(
    settings: dict[str, str], source: str, probe_input: int, edge: str
) -> None:
    """FCT-C4 8.2.4: they decide while P-AXIS-00516, 00517 and 00518 are not given."""
    axis = ParameterSet("axis")
    for path, text in settings.items():
        axis.set(path, text, "test")
    found = MeasuringAxis.read(axis)
    assert (found.source, found.probe_input) == (source, probe_input)
    assert axis.word("kenngr.measure.edge") == edge


def test_an_axis_without_settings_has_those_of_the_manual() -> None:
    """16666 um/s, 5 mm of stroke."""
    assert MeasuringAxis.read(ParameterSet("axis")) == MeasuringAxis(16.666, 5.0)
