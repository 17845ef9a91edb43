"""Columns of distance control in the trace, and what a run notes of its controls; set by hand."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import facts
from axisrig.bench.machine.recording.distance_trace import DISTANCE_CONTROL_COLUMNS, DistanceTrace
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.kernel.channel.distance.sensor import VariableSensor
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


def test_3d_control_has_the_tool_and_what_is_superposed_on_each_axis() -> None:
    trace = DistanceTrace({"A"})
    trace.note(channel(sensing(10.0), Z=sensing(30.0)))
    found = columns(trace)
    assert found[f"{CHANNEL}.offset_mm"] == [10.0]
    assert found[f"{CHANNEL}.axes_share_pct"] == [75.0]
    assert found[f"{CHANNEL}.tilt_deg"] == [30.0]
    assert found[f"{CHANNEL}.tool_length_mm"] == [None]
    assert (found["Z.superposed_mm"], found["A.superposed_deg"]) == ([0.125], [0.0])
    plain = DistanceTrace()
    plain.note(channel(Z=sensing(1.0)))
    assert not any("superposed" in name or CHANNEL in name for name in columns(plain))


# --- facts


def variable(name: str) -> VariableSensor:
    sensor = VariableSensor.__new__(VariableSensor)
    sensor.name = name
    return sensor


def machine_of(whole: Any = None, **axes: Any) -> Any:
    log = SimpleNamespace(
        recorded=lambda name: (f"changes of {name}",), orders=lambda name: (f"orders of {name}",),
        dumps=lambda of: (f"dump of {of.title}",), guides=("guide",),
    )  # fmt: skip
    return SimpleNamespace(
        channel=SimpleNamespace(
            title="the channel", distance=SimpleNamespace(axes=axes, channel=whole)
        ),
        settings=SimpleNamespace(rig=SimpleNamespace(plc={"V.E.GAP": None})),
        referenced={"Z", CHANNEL}, distance_log=log,
    )  # fmt: skip


def test_a_control_is_left_with_its_variable_its_zero_and_its_history() -> None:
    """Only a variable that the PLC reads from a sensor is named."""
    machine = machine_of(
        Z=SimpleNamespace(sensor=variable("GAP")), Y=SimpleNamespace(sensor=variable("OTHER")),
        X=SimpleNamespace(sensor=SimpleNamespace(name="GAP")),
    )  # fmt: skip
    found: dict[str, Any] = {name: facts._distance(machine, name) for name in "XYZ"}
    assert {name: (one.variable, one.is_referenced) for name, one in found.items()} == {
        "X": ("", False), "Y": ("", False), "Z": ("V.E.GAP", True),
    }  # fmt: skip
    assert (found["Z"].changes, found["Z"].orders) == (("changes of Z",), ("orders of Z",))
    assert facts._distance_3d(machine) is None


def test_3d_control_is_left_with_its_own_history() -> None:
    machine = machine_of(SimpleNamespace(sensor=variable("GAP")))
    found: Any = facts._distance_3d(machine)
    assert found is not None
    assert (found.variable, found.is_referenced) == ("V.E.GAP", True)
    assert found.changes == (f"changes of {CHANNEL}",)
    assert (found.diagnosis, found.guides) == (("dump of the channel",), ("guide",))
    assert found.orders == (f"orders of {CHANNEL}",)


def change(sensor: str, kp: float, *, is_on: bool = True, is_dry_run: bool = False) -> Any:
    controller = SimpleNamespace(control=kp)
    return SimpleNamespace(
        sensor=sensor, is_on=is_on, is_dry_run=is_dry_run, mode="CONST_DIST", controller=controller
    )


def test_a_control_that_acted_and_cannot_be_stable_is_noted_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Off, a dry run, or by a sensor that the rig does not have: no loop."""
    acted = {
        "Z": [change("S", 1.0), change("S", 9.0), change("S", 9.0), change("T", 8.0),
              change("S", 7.0, is_on=False), change("S", 6.0, is_dry_run=True),
              change("own", 5.0)],
        "Y": [change("S", 9.0)],
        CHANNEL: [change("S", 4.0)],
    }  # fmt: skip
    sensors = {word: SimpleNamespace(source=word) for word in "ST"}
    monkeypatch.setattr(
        facts, "sensors_of", lambda _, name: [sensors["S"], sensors["T"]][: 1 + (name == "Z")]
    )

    def unstable(_settings: Any, name: str, sensor: Any, mode: str, kp: float) -> str | None:
        return None if kp < 2.0 else f"{name} {sensor.source} {mode} {kp:g}"

    monkeypatch.setattr(facts, "unstable", unstable)
    log: Any = SimpleNamespace(axes=["Y", "Z"], recorded=acted.__getitem__)
    assert facts._acting_warnings(None, log) == [  # type: ignore[arg-type]
        "Y S CONST_DIST 9", "Z S CONST_DIST 9", "Z T CONST_DIST 8", f"{CHANNEL} S CONST_DIST 4",
    ]  # fmt: skip


def test_notes_have_their_topics_in_the_order_of_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    sources = {"distance_warnings": "warning", "unproved_notes": "latch", "lacking_notes": "lack",
               "plant_warnings": "of plant", "printed_log": "printed"}  # fmt: skip
    for name, text in sources.items():
        monkeypatch.setattr(facts, name, lambda _, text=text: [text])
    monkeypatch.setattr(facts, "_acting_warnings", lambda *_: ["acting"])
    machine: Any = SimpleNamespace(
        settings=SimpleNamespace(notes=["one", "two"]), distance_log=None, links=None, plant=None,
        plc_side=SimpleNamespace(not_come=lambda: ["not come"]),
    )  # fmt: skip
    assert [(note.source, note.text) for note in facts._notes(machine)] == [
        ("rig", "one"), ("rig", "two"), ("distance", "warning"), ("distance", "acting"),
        ("latch", "latch"), ("lacking", "lack"), ("plant", "of plant"), ("printed", "printed"),
        ("plc", "not come"),
    ]  # fmt: skip
