"""A measuring run of `axisrig tune` around its machine: blocks, what is kept, how it may end."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from axisrig.bench.machine.machine import SimulatedTimeoutError
from axisrig.bench.record.series import SECOND, TARGET
from axisrig.bench.tools.tune import measure
from axisrig.bench.tools.tune.measure import Bench, _Log, _run
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

RIG = Path("distance.toml")
BLOCKS = ["G4 0.2", "Z[DIST_CTRL OFF NO_MOVE]"]


class OwnMachine:
    """Stands for the machine: two cycles of the channel, and the end that it is given."""

    error: Exception | None = None
    alarms: Any = ()
    made: "list[OwnMachine]"

    def __init__(self, settings: Any, program: Any) -> None:
        self.made.append(self)
        self.settings, self.program, self.is_closed = settings, program, False
        self.channel = SimpleNamespace(observers=[], alarms=list(self.alarms))
        series = SimpleNamespace(telegrams=lambda axis, name: (axis, name))
        self.recorder = SimpleNamespace(series=lambda: series)

    def run(self) -> None:
        for cycle in (1.0, 2.0):
            control = SimpleNamespace(set_pos_mm=10 * cycle, set_dist_mm=20 * cycle, offset_mm=0.0)
            axis = SimpleNamespace(sensor_mm=-cycle, control=control)
            self.channel.distance = SimpleNamespace(axes={"Z": axis})
            self.channel.links = [SimpleNamespace(name="Z", set_mm=0.0, actual_mm=0.0)]
            for look in self.channel.observers:
                look(self.channel)
        if self.error is not None:
            raise self.error

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> type[OwnMachine]:
    own = type("Own", (OwnMachine,), {"made": []})
    settings = SimpleNamespace(rig=SimpleNamespace(axis={"X": None, "Z": None}))
    monkeypatch.setattr(Bench, "settings", lambda _, parameters: (settings, parameters)[0])
    monkeypatch.setattr(measure, "Machine", own)
    monkeypatch.setattr(
        measure, "parse_program", lambda text, file, axes: (text.splitlines(), axes)
    )
    return own


@pytest.mark.parametrize(
    ("variable", "first"),
    [(None, []), ("V.E.GAP", ["Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.GAP]"])],
)
def test_blocks_are_numbered_and_the_sensor_is_chosen_first(
    variable: str | None, first: list[str], machine: type[OwnMachine]
) -> None:
    _run(Bench(RIG, "Z", variable, ()), {}, BLOCKS)
    (made,) = machine.made
    lines, axes = made.program
    expected = [*first, *BLOCKS, "M30"]
    assert lines == [f"N{10 * number} {text}" for number, text in enumerate(expected, 1)]
    assert axes == ("X", "Z")
    assert made.is_closed


def test_what_is_wanted_is_the_distance_where_the_program_sets_one(
    machine: type[OwnMachine],
) -> None:
    """Each cycle is a row; the telegrams are those of the set positions and the second encoder."""
    for blocks, wanted in (
        (["Z[DIST_CTRL ON SET_POS=10]"], [10.0, 20.0]),
        (["G4 0.1", "Z[DIST_CTRL ON CONST_DIST SET_DIST=2]"], [20.0, 40.0]),
    ):
        found = _run(Bench(RIG, "Z", None, ()), {}, blocks)
        assert found.signals.wanted_mm.tolist() == wanted
        assert found.signals.distance_mm.tolist() == [1.0, 2.0]
        telegrams: Any = (found.targets, found.sensor)
        assert telegrams == (("Z", TARGET), ("Z", SECOND))


@pytest.mark.parametrize(
    "error", [PlantError("z", 2 * MS, "no such step"), SimulatedTimeoutError("it does not end")]
)
def test_a_run_that_does_not_come_to_its_end_is_closed_and_refused(
    error: Exception, machine: type[OwnMachine]
) -> None:
    machine.error = error
    with pytest.raises(UserError, match=r"no such step|does not end") as caught:
        _run(Bench(RIG, "Z", None, ()), {}, BLOCKS)
    assert caught.value.file == str(RIG)
    assert machine.made[0].is_closed


class Alarm(SimpleNamespace):
    def __str__(self) -> str:
        return f"alarm {self.id}"


def test_an_alarm_that_ends_the_program_is_named_and_a_warning_is_not(
    machine: type[OwnMachine],
) -> None:
    warning = Alarm(id=1, ends_program=False)
    machine.alarms = [warning]
    assert len(_run(Bench(RIG, "Z", None, ()), {}, BLOCKS).signals.wanted_mm) == 2
    machine.alarms = [warning, Alarm(id=70331, ends_program=True), Alarm(id=9, ends_program=True)]
    with pytest.raises(UserError, match="the measuring run ended with alarm 70331") as caught:
        _run(Bench(RIG, "Z", None, ()), {}, BLOCKS)
    assert caught.value.file == str(RIG)
    assert machine.made[-1].is_closed


@pytest.mark.parametrize("is_distance", [True, False])
def test_each_cycle_with_a_sensor_value_is_kept_also_one_at_zero(is_distance: bool) -> None:
    """The distance is the negative of the sensor value; without a set value there is NaN."""
    log = _Log("Z", is_distance)
    for sensor_mm, set_dist_mm, set_pos_mm in (
        (None, 1.0, 2.0), (-3.0, 1.0, 2.0), (0.0, None, 4.0), (0.5, 5.0, None), (None, 6.0, 6.0),
    ):  # fmt: skip
        control = SimpleNamespace(set_dist_mm=set_dist_mm, set_pos_mm=set_pos_mm, offset_mm=0.1)
        axes = {
            "X": SimpleNamespace(sensor_mm=9.0, control=None),
            "Z": SimpleNamespace(sensor_mm=sensor_mm, control=control),
        }
        links = [SimpleNamespace(name=n, set_mm=place, actual_mm=place + 0.25)
                 for n, place in (("X", 8.0), ("Z", 7.0))]  # fmt: skip
        channel: Any = SimpleNamespace(distance=SimpleNamespace(axes=axes), links=links)
        log(channel)
    found = log.signals()
    assert list(found.distance_mm) == [3.0, 0.0, -0.5]
    wanted = [1.0, math.nan, 5.0] if is_distance else [2.0, 4.0, math.nan]
    np.testing.assert_array_equal(found.wanted_mm, wanted)
    assert {*found.set_mm} == {7.0}
    assert {*found.actual_mm} == {7.25}
    assert {*found.offset_mm} == {0.1}
