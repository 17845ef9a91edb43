"""What the plant of an axis gives of its stop: its side, its place, its damping, or nothing.

Recordings of `stop_recordings.py`: contact at 140.3 ms, found at 203.6 ms, 0.1 mm deep.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.stop_recordings import (
    CONTACT_MS,
    DEEP_MM,
    DETECTED_NS,
    LATCHED_MM,
    RUN,
    STOP_MM,
    K,
    recorded,
    seen,
)

from axisrig.bench.judge.fixed_stop.findings import stop_findings
from axisrig.bench.judge.fixed_stop.run import stop_runs
from axisrig.kernel.time.clock import MS

NOTHING: Mapping[str, Any] = {"stop_force_n": None, "stop_force_peak_n": None}
FACE = {"stop_mm": np.full(len(K), STOP_MM)}
UNKNOWN = "the plant of axis Z gives a force at its stop, and no stop_direction"


@pytest.mark.parametrize(
    ("plant", "columns", "note"),
    [
        # Without a force, a face and a side it says that it has no stop
        ({"stop_direction": None}, NOTHING, "axis Z had no contact before"),
        ({"stop_direction": None, "stop_position": None}, NOTHING, "axis Z had no contact before"),
        ({"stop_position": None}, NOTHING, "axis Z had no contact before"),
        # What it gives of a stop whose side is missing is of no use
        ({"stop_direction": None}, {}, UNKNOWN),
        ({"stop_direction": None}, {**NOTHING, **FACE}, UNKNOWN),
        ({"stop_direction": None}, FACE, UNKNOWN),
        ({"stop_position": None}, {}, "axis Z had no contact before"),
    ],
)
def test_a_plant_that_gives_a_stop_must_give_its_side(
    plant: Mapping[str, Any], columns: Mapping[str, Any], note: str
) -> None:
    observed = recorded(plant=plant, columns=columns)
    found = seen(observed, "contact_to_detection_ms")
    assert found.value is None
    assert found.note.startswith(note)
    without = seen(observed, "found_without_contact")
    if note is UNKNOWN:
        assert without.value is None
        assert without.note.startswith(note)
    else:
        assert without.value == 1


@pytest.mark.parametrize("columns", [{}, NOTHING, FACE, {**NOTHING, **FACE}])
def test_a_stop_is_met_where_its_place_or_its_face_is_given(columns: Mapping[str, Any]) -> None:
    plant = {"stop_position": None} if "stop_mm" in columns else {}
    found = seen(recorded(plant=plant, columns=columns), "contact_to_detection_ms")
    assert found.value == pytest.approx(DETECTED_NS / MS - CONTACT_MS, abs=1e-4)
    assert seen(recorded(plant=plant, columns=columns), "found_without_contact").value == 0


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("place_m", "is_there"), [(99.0, True), (100.0, False), (250.0, False), (0.11, True)]
)
def test_a_stop_a_hundred_metres_away_is_none(place_m: float, is_there: bool, side: float) -> None:
    (run,) = stop_runs(recorded(side, plant={"stop_position": place_m}))
    path = run.truths["Z"].stop_path
    assert (path is not None) is is_there
    if path is not None:
        assert path.position_mm == pytest.approx(side * place_m * 1e3)
        assert path.direction == side


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("speed_mm_s", "damping_s_m", "deep_mm"),
    [
        (0.0, 10.0, DEEP_MM),
        (20.0, 0.0, DEEP_MM),
        (20.0, 10.0, DEEP_MM / 1.2),  # it goes in: part of the force is of the damping
        (-20.0, 10.0, DEEP_MM / 0.8),  # it comes out
        (20.0, 25.0, DEEP_MM / 1.5),
    ],
)
def test_what_the_damping_of_a_stop_takes_is_no_depth(
    speed_mm_s: float, damping_s_m: float, deep_mm: float, side: float
) -> None:
    """F = k p (1 + a dp/dt) (Hunt and Crossley): x_stop + p beside what was latched."""
    speed = np.where(K >= 200, side * speed_mm_s, 0.0)
    observed = recorded(side, plant={"stop_damping": damping_s_m}, columns={"velocity_mm_s": speed})
    found = seen(observed, "latch_force_error_um")
    assert found.value == pytest.approx(side * 1e3 * (LATCHED_MM - STOP_MM - deep_mm))


@pytest.mark.parametrize("before", [0, 1, 3])
def test_a_run_has_its_number_among_those_to_a_stop(before: int) -> None:
    """Others of the program, to a probe, do not count."""
    touch = replace(RUN, fixed_stop=None, begin_ns=0, end_ns=MS)
    stops = [
        replace(RUN, block=f"N{n}", begin_ns=n * MS, end_ns=(n + 1) * MS) for n in range(before)
    ]
    blocks = stop_findings(recorded(before=(touch, *stops)))
    assert [block.number for block in blocks] == list(range(1, before + 2))
    assert [block.block for block in blocks] == [*(f"N{n}" for n in range(before)), "N30"]
