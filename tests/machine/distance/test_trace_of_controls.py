"""Columns of distance control in the trace; controls are set by hand."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.recording.distance_trace import DISTANCE_CONTROL_COLUMNS, DistanceTrace
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.kernel.distance import DistanceState

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

NUMBERS = ("offset_mm", "distance_mm", "surface_mm", "filtered_mm", "error_mm", "delta_mm",
           "step_mm", "set_pos_mm", "set_dist_mm")  # fmt: skip


def sensing(first: float, **more: Any) -> Any:
    """A control whose values are `first` and the following numbers, in the order of NUMBERS."""
    values: dict[str, Any] = {name: first + n for n, name in enumerate(NUMBERS)}
    given = {"state": DistanceState.ACTIVE, "has_read": True, "sensor_mm": 0.5, "sign": 1,
             "has_surface": True, "is_held": False, "override": 0.25} | more  # fmt: skip
    values |= {name: given[name] for name in given if name in values}
    control = SimpleNamespace(
        **values, state=given["state"], has_read=given["has_read"], sensor_mm=given["sensor_mm"],
        settings=SimpleNamespace(sensor_sign=given["sign"]),
    )  # fmt: skip
    return SimpleNamespace(
        control=control, has_surface=given["has_surface"], is_held=given["is_held"],
        override=given["override"], axes_share=0.75, names=("Z", "A"), deltas_mm={"Z": 0.125},
    )  # fmt: skip


def channel(whole: Any = None, **axes: Any) -> Any:
    return SimpleNamespace(
        distance=SimpleNamespace(axes=axes, channel=whole),
        plc=SimpleNamespace(tool=SimpleNamespace(tilt_deg=30.0, length_mm=None)),
    )


def columns(trace: DistanceTrace) -> dict[str, list[Any]]:
    return {name: column.to_pylist() for name, column in trace.take_columns().items()}


def test_each_column_has_its_own_value_of_its_axis() -> None:
    trace = DistanceTrace({"A"})
    trace.note(channel(Z=sensing(10.0), A=sensing(30.0, is_held=True, override=1.0, sign=-1)))
    trace.note(channel(Z=sensing(50.0, state=DistanceState.FREEZE), A=sensing(70.0)))
    found = columns(trace)
    assert len(found) == 2 * len(DISTANCE_CONTROL_COLUMNS)
    of_z = {name: found[f"Z.{name}"] for name in DISTANCE_CONTROL_COLUMNS}
    assert of_z == {
        "offset_mm": [10.0, 50.0], "distance_state": [1, 2], "distance_held": [0, 0],
        "sensor_mm": [0.5, 0.5], "distance_cnc_mm": [11.0, 51.0], "surface_cnc_mm": [12.0, 52.0],
        "filtered_mm": [13.0, 53.0], "error_mm": [14.0, 54.0], "delta_mm": [15.0, 55.0],
        "step_mm": [16.0, 56.0], "set_pos_mm": [17.0, 57.0], "set_dist_mm": [18.0, 58.0],
        "distance_override_pct": [25.0, 25.0],
    }  # fmt: skip
    assert found["A.offset_deg"] == [30.0, 70.0]
    assert (found["A.distance_held"], found["A.distance_override_pct"]) == ([1, 0], [100.0, 25.0])
    assert found["A.sensor_deg"] == [-0.5, 0.5]
    assert columns(trace)["Z.offset_mm"] == []  # of the cycles since the last call


def test_what_is_not_known_yet_is_no_number() -> None:
    trace = DistanceTrace()
    trace.note(channel(Z=sensing(10.0, has_read=False, set_pos_mm=None)))
    trace.note(channel(Z=sensing(10.0, has_surface=False, set_dist_mm=None)))
    found = {name: [v is not None for v in values] for name, values in columns(trace).items()}
    missing = {name.partition(".")[2]: known for name, known in found.items() if not all(known)}
    assert missing == {
        "sensor_mm": [False, True], "distance_cnc_mm": [False, True],
        "surface_cnc_mm": [False, False], "set_pos_mm": [False, True], "set_dist_mm": [True, False],
    }  # fmt: skip


def test_0_is_a_value() -> None:
    """A set value, an offset and the tilt of an upright tool."""
    trace = DistanceTrace()
    given = channel(sensing(10.0, set_pos_mm=0.0), Z=sensing(0.0, set_pos_mm=0.0, set_dist_mm=0.0))
    given.plc.tool = SimpleNamespace(tilt_deg=0.0, length_mm=0.0)
    trace.note(given)
    found = columns(trace)
    names = ("Z.set_pos_mm", "Z.set_dist_mm", "Z.offset_mm", f"{CHANNEL}.set_pos_mm",
             f"{CHANNEL}.tilt_deg", f"{CHANNEL}.tool_length_mm")  # fmt: skip
    assert {name: found[name] for name in names} == {name: [0.0] for name in names}


def test_3d_control_has_the_tool_and_what_is_superposed_on_each_axis() -> None:
    trace = DistanceTrace({"A"})
    trace.note(channel(sensing(10.0), Z=sensing(30.0)))
    found = columns(trace)
    assert found[f"{CHANNEL}.offset_mm"] == [10.0]
    assert found[f"{CHANNEL}.axes_share_pct"] == [75.0]
    assert found[f"{CHANNEL}.tilt_deg"] == [30.0]
    assert found[f"{CHANNEL}.tool_length_mm"] == [None]
    assert (found["Z.superposed_mm"], found["A.superposed_deg"]) == ([0.125], [0.0])
    down = sensing(10.0)
    down.deltas_mm = {"A": -0.5, "Z": -0.125}
    trace.note(channel(down, Z=sensing(30.0)))
    found = columns(trace)
    assert (found["Z.superposed_mm"], found["A.superposed_deg"]) == ([-0.125], [-0.5])
    plain = DistanceTrace()
    plain.note(channel(Z=sensing(1.0)))
    assert not any("superposed" in name or CHANNEL in name for name in columns(plain))


def test_states_are_whole_numbers_and_all_else_is_none() -> None:
    """In every block alike, also in one without a row: the blocks of a run are one file."""
    trace = DistanceTrace({"A"})
    trace.note(channel(sensing(10.0), Z=sensing(30.0, is_held=True), A=sensing(5.0)))
    for rows in (1, 0):
        found = trace.take_columns()
        kinds = {name: str(column.type) for name, column in found.items()}
        assert {len(column) for column in found.values()} == {rows}
        whole = {name for name, kind in kinds.items() if kind == "int8"}
        heads = ("Z", "A", CHANNEL)
        assert whole == {f"{of}.distance_{word}" for of in heads for word in ("state", "held")}
        assert {kind for name, kind in kinds.items() if name not in whole} == {"double"}
