"""What a run leaves of its distance controls: variable, zero, history, notes of instability."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine import facts
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.kernel.channel.distance.sensor import VariableSensor

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


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
