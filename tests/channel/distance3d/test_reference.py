"""#DIST CTRL REF: of which sensor values its zero is, and when it may act.

The surface is noisy by numbers that repeat with the period of the filter, so that any mean of as
many values has their mean exactly, and one value alone is up to 0.3 mm away from it.
"""

from typing import Any

import pytest
from tests.channel.distance3d.programs import HEAD, SENSOR, Make, dwell

COUNT = 16
NOISE_MM = [
    0.3,
    -0.2,
    0.1,
    0.05,
    -0.15,
    0.25,
    -0.3,
    0.2,
    0.15,
    -0.1,
    0.0,
    0.3,
    -0.25,
    0.05,
    -0.2,
    -0.2,
]
"""Sum 0."""
HEIGHT_MM = 80.0  # of the clamping point over a surface at 0, A = 0
REF = "#DIST CTRL REF\n"


def noisy(ms: float) -> float:
    return NOISE_MM[int(ms) % COUNT]


def referred(make_head: Make, text: str, height_mm: Any = noisy, **changes: Any) -> Any:
    made = make_head(height_mm, filter_type="MOVING_AVERAGE", n_cycles=COUNT, **changes)
    return made.run(text)


@pytest.mark.parametrize(
    "before",
    [
        pytest.param(SENSOR, id="before MODE and #TRAFO"),
        pytest.param(HEAD + SENSOR, id="in MCS"),
        pytest.param(SENSOR + "#DIST CTRL [MODE=ACS DIRECTION=Z]\n", id="in ACS"),
        pytest.param(HEAD + dwell(100) + SENSOR, id="just after SENSOR_VAR"),
        pytest.param(
            SENSOR + dwell(50) + "#DIST CTRL [SENSOR_VAR=V.E.OTHER]\n", id="another variable"
        ),
    ],
)
def test_the_zero_is_the_mean_of_as_many_values_as_the_filter_has(
    make_head: Make, before: str
) -> None:
    """Whatever says where the surface is, or nothing yet, and however new the sensor is."""
    made = make_head(noisy, filter_type="MOVING_AVERAGE", n_cycles=COUNT)
    plc = made.channel.plc
    plc.values["OTHER"] = 0.0
    plc.inputs.append(lambda: plc.values.update(OTHER=plc.values["SENSOR"] + 5e4))
    made.run(before + REF + dwell(5))
    assert made.alarm_ids == []
    other_mm = 5.0 if "OTHER" in before else 0.0
    zero_mm = made.control3d.control.zero_mm
    assert zero_mm == pytest.approx(-HEIGHT_MM - other_mm, abs=1e-4)
    assert len(made.state) < 300


@pytest.mark.long
def test_ref_forgets_values_of_a_sideways_motion(make_head: Make) -> None:
    """Along the normal X moves the tool over another surface: 1 mm lower after it."""
    made = referred(
        make_head,
        HEAD + SENSOR + "#DIST CTRL [MODE=MCS]\n" + dwell(100) + "G1 F60000 X1\n" + REF,
        lambda ms: 0.0 if ms < 104 else -1.0,
    )
    assert made.sent["X"][-1] == 1.0
    assert made.control3d.control.zero_mm == pytest.approx(-HEIGHT_MM - 1.0, abs=1e-4)


@pytest.mark.long
def test_without_a_guide_a_motion_counts_too(make_head: Make) -> None:
    made = referred(
        make_head,
        SENSOR + dwell(100) + "G1 F60000 X1\n" + REF,
        lambda ms: 0.0 if ms < 104 else -1.0,
    )
    assert made.control3d.control.zero_mm == pytest.approx(-HEIGHT_MM - 1.0, abs=1e-4)


def test_ref_takes_nothing_of_the_variable_before(make_tool_loop: Make) -> None:
    """20 values of SENSOR, 80 mm, have been read; then one of another sensor at 30 mm."""
    loop = make_tool_loop(n_cycles=20)
    loop.values["OTHER"] = 30.0 * 1e4
    loop.run(30)
    assert loop.control3d.shown_sensor_mm == pytest.approx(80.0)
    loop.control3d.choose("VARIABLE", "V.E.OTHER")
    loop.run(1)
    loop.control.reference(loop.control3d.require_sensor())
    assert loop.control.zero_mm == pytest.approx(-30.0)
