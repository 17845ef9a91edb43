"""A measuring run of `axisrig tune` around its machine: blocks, what is kept, how it may end."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.machine import SimulatedTimeoutError
from axisrig.bench.record.series import SECOND, TARGET
from axisrig.bench.tools.tune import measure
from axisrig.bench.tools.tune.measure import Bench, _run
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
