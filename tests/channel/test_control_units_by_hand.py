"""What the PLC side commands to the path and to axes beside it, by hand: overrides and holds."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.control_units import ControlUnits
from axisrig.kernel.channel.path.settings import OverrideMode
from axisrig.kernel.errors import Alarm


class Bench:
    """Axes X, Y and Z; calls: what the path was ordered in the last turn."""

    def __init__(self) -> None:
        self.calls: list[Any] = []
        self.mode, self.tool = OverrideMode.CHANNEL, (12.0, 80.0)
        self.path: Any = SimpleNamespace(
            transformation=SimpleNamespace(kinematic=None, state=lambda: self.tool),
            override=lambda permille, axes: self.calls.append(("override", permille, axes)),
            feedhold=lambda *, is_on, axes: self.calls.append(("hold", is_on, axes)),
            settings=lambda _axis: SimpleNamespace(override_mode=self.mode),
            override_max_permille=1200,
        )  # fmt: skip
        self.plc: Any = SimpleNamespace(
            tool=SimpleNamespace(tilt_deg=None), inputs=[], reported=[], override_permille=1000,
            take_turn=lambda: self.calls.append("turn"), feedhold=False,
            show_tool=lambda *shown: self.calls.append(("tool", *shown)),
            axis={n: SimpleNamespace(feedhold=False, override_permille=1000) for n in "XYZ"},
        )  # fmt: skip
        self.units = ControlUnits(self.plc, self.path)

    def step(self) -> list[Any]:
        self.calls.clear()
        self.units.step()
        return list(self.calls)


@pytest.mark.parametrize(
    ("permille", "feedhold", "orders"),
    [
        (1000, False, [("override", 1000, {}), ("hold", False, [])]),
        (500, True, [("override", 500, {}), ("hold", True, [])]),
        (0, False, [("hold", True, [])]),  # 0 % holds and leaves the override of before
        (0, True, [("hold", True, [])]),
        (1, False, [("override", 1, {}), ("hold", False, [])]),
    ],
)
def test_an_override_of_0_is_a_hold(permille: int, feedhold: bool, orders: list[Any]) -> None:
    bench = Bench()
    bench.plc.override_permille, bench.plc.feedhold = permille, feedhold
    assert bench.step() == ["turn", *orders]


def test_axes_slow_the_path_or_hold_it() -> None:
    """Over 100 % an axis asks for nothing; one at 0 % holds and does not slow."""
    bench = Bench()
    axes = bench.plc.axis
    axes["X"].override_permille, axes["Y"].override_permille = 300, 0
    axes["Z"].feedhold = True
    assert bench.step()[1:] == [("override", 1000, {"X": 300}), ("hold", False, ["Y", "Z"])]
    axes["Z"].override_permille, axes["X"].override_permille = 700, 1500
    assert bench.step()[1:] == [("override", 1000, {"Z": 700}), ("hold", False, ["Y", "Z"])]
    axes["Z"].feedhold, axes["Y"].override_permille = False, 1000
    assert bench.step()[1:] == [("override", 1000, {"Z": 700}), ("hold", False, [])]


@pytest.mark.parametrize(
    ("channel", "axis", "expected"),
    [
        (1000, 1000, (1000, 1000, 1000)),
        (500, 800, (500, 500, 800)),
        (800, 500, (800, 500, 500)),
        (1500, 1400, (1200, 1200, 1400)),  # P-CHAN-00056 limits that of the channel
        (0, 700, (0, 0, 700)),
        (700, 0, (700, 0, 0)),
    ],
)
def test_an_axis_beside_the_path_has_the_override_of_its_mode(
    channel: int, axis: int, expected: tuple[int, ...]
) -> None:
    """That of the channel, the smaller one, its own; its own feedhold stops it in every mode."""
    bench = Bench()
    bench.plc.override_permille, bench.plc.axis["Y"].override_permille = channel, axis
    found = []
    for bench.mode in (OverrideMode.CHANNEL, OverrideMode.LEAST, OverrideMode.AXIS):
        found.append(bench.units.override_beside_permille("Y"))
        bench.plc.axis["Y"].feedhold = True
        assert bench.units.override_beside_permille("Y") == 0
        bench.plc.axis["Y"].feedhold = False
    assert tuple(found) == expected


def test_inputs_come_before_the_turn_and_reports_after_the_orders() -> None:
    """One report in each cycle; the tool is shown while there is a kinematic, and once more."""
    bench = Bench()
    plc = bench.plc
    plc.inputs = [lambda: bench.calls.append("input")]
    plc.reported = [Alarm(50059, axis="X"), Alarm(50059, axis="Y")]
    for axis in "XY":
        with pytest.raises(Alarm) as caught:
            bench.step()
        assert caught.value.values["axis"] == axis
        assert bench.calls[:2] == ["input", "turn"]
        assert bench.calls[-1] == ("hold", False, [])
    bench.path.transformation.kinematic = object()
    assert bench.step()[0] == ("tool", 12.0, 80.0)
    bench.path.transformation.kinematic, plc.tool.tilt_deg = None, 12.0
    assert bench.step()[0] == ("tool", 12.0, 80.0)
    plc.tool.tilt_deg = None
    assert bench.step()[0] == "input"
