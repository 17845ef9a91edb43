"""The measurement of a channel by hand: which speed a run gets, and what its results become."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.measuring.run import RunRecord, RunState
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

BLOCK = Block(2, 20, "N20")
AXES = ("X", "Y", "Z")
SLOPE = Slope(1000.0, 1000.0, 1.0)


class Bench:
    """Three axes that may measure; what the path would do is noted."""

    def __init__(self, plc: Any = None, **axes: Any) -> None:
        self.clock: Any = SimpleNamespace(now_ns=5 * MS)
        self.lists = {name: axes.get(name, MeasuringAxis()) for name in AXES}
        self.may_measure = dict.fromkeys(AXES, True)
        self.path: Any = SimpleNamespace(
            settings=self._settings, position_acs_mm=lambda _axis: 0.0,
            superposed_mm=lambda _axis: 0.0,
        )  # fmt: skip
        self.links: Any = {name: self._link(name) for name in AXES}
        self.warned: list[Alarm] = []
        self.checked: list[str] = []
        given: Any = {
            "timing": SimpleNamespace(period_ns=MS, offset_ns=0),
            "settings": SimpleNamespace(error_no_signal=False), "slaves_of": lambda _axes: {},
            "offsets": SimpleNamespace(check_measuring=self.checked.append),
            "warn": self.warned.append, "plc": plc or SimpleNamespace(task=None, axis={}),
        }  # fmt: skip
        self.measurement = Measurement(self.clock, self.path, self.links, **given)

    def _settings(self, name: str) -> Any:
        return SimpleNamespace(
            name=name, measuring=self.lists[name], may_measure=self.may_measure[name], window_mm=0.1
        )

    @staticmethod
    def _link(name: str) -> Any:
        found = SimpleNamespace(
            name=name, probe_input=1, edge="POS", is_probing=False, is_actuated=False,
            settings=SimpleNamespace(probe_input=1, edge="POS"), arrival=Arrival(), orders=[],
            lag_mm=0.0,
        )  # fmt: skip
        found.arm = lambda: found.orders.append("arm")
        found.disarm = lambda: found.orders.append("disarm")
        return found

    def speed(self, type_: int, wanted: float, *moving: str, fastest: float = 1e3) -> float:
        dynamics = Dynamics(SLOPE, SLOPE, SLOPE, fastest)
        names = moving or ("Z",)
        return self.measurement.speed_mm_s(type_, BLOCK, names, names, wanted, dynamics)

    def arm(self, type_: int, *axes: str, **more: Any) -> Any:
        return self.measurement.arm(type_, axes, BLOCK, behind_mm=lambda _a, _v: 0.0, **more)


def of(stroke_mm: float, speed_mm_s: float = 16.0) -> MeasuringAxis:
    return MeasuringAxis(stroke_mm=stroke_mm, speed_mm_s=speed_mm_s)


# Speed


@pytest.mark.parametrize(
    ("type_", "wanted", "fastest", "speed"),
    [
        (1, 90.0, 1e3, 90.0), (1, 90.0, 50.0, 50.0), (3, 90.0, 1e3, 90.0), (2, 90.0, 1e3, 16.0),
        (2, 90.0, 10.0, 10.0), (4, 50.0, 1e3, 50.0),
    ],
)  # fmt: skip
def test_a_speed_is_that_of_the_block_or_of_the_axis_where_the_stroke_leaves_it(
    type_: int, wanted: float, fastest: float, speed: float
) -> None:
    """5 mm at 1000 mm/s² are 100 mm/s."""
    bench = Bench(Z=of(5.0))
    assert bench.speed(type_, wanted, fastest=fastest) == speed
    assert bench.warned == []


@pytest.mark.parametrize(
    ("wanted", "fastest", "shown"), [(150.0, 1e3, "9000"), (1500.0, 120.0, "90000")]
)
def test_900222_tells_what_was_programmed_and_the_least_stroke(
    wanted: float, fastest: float, shown: str
) -> None:
    bench = Bench(X=of(20.0), Y=of(5.0), Z=of(8.0))
    assert bench.speed(4, wanted, *AXES, fastest=fastest) == pytest.approx(100.0)
    (warning,) = bench.warned
    values = warning.values
    assert (warning.id, warning.place, values["axis"], values["stroke_mm"]) == (
        900222, BLOCK.place, "Y", "5",
    )  # fmt: skip
    assert (values["speed_mm_min"], values["corrected_mm_min"]) == (shown, "6000")


def test_900224_for_a_probe_without_a_stroke() -> None:
    bench = Bench(X=of(5.0), Y=of(0.0))
    with pytest.raises(Alarm) as caught:
        bench.speed(4, 10.0, "X", "Y")
    assert (caught.value.id, caught.value.values["axis"]) == (900224, "Y")


@pytest.mark.parametrize(("type_", "fastest"), [(1, 1e3), (2, 100.0), (4, 100.0), (5, 1e3)])
def test_at_any_override_a_run_keeps_to_the_stroke_of_its_type(type_: int, fastest: float) -> None:
    bench = Bench(Z=of(5.0))
    dynamics = Dynamics(SLOPE, SLOPE, SLOPE, 1e3)
    found = bench.measurement.within_stroke(type_, ("X", "Z"), dynamics)
    assert found.speed_max_mm_s == pytest.approx(fastest)


# Results


def test_what_an_axis_has_measured_is_gone_when_its_next_run_begins() -> None:
    bench = Bench()
    first = bench.arm(1, "X", "Z")
    first.record.latched_mm |= {"X": 1.0, "Z": 3.0}
    bench.measurement.keep(first.record)
    found = bench.measurement.measured_acs_mm
    assert [found(axis) for axis in AXES] == [1.0, None, 3.0]
    bench.arm(1, "Z")
    assert [found(axis) for axis in AXES] == [1.0, None, None]
    bench.measurement.keep(RunRecord(("X",)))
    assert found("X") is None
    bench.measurement.keep(first.record)
    bench.measurement.begin_program()
    assert [found(axis) for axis in AXES] == [None, None, None]


def test_a_record_tells_axes_inputs_and_sources() -> None:
    bench = Bench(X=MeasuringAxis(source="DRIVE"))
    bench.links["Z"].probe_input = 2
    run = bench.arm(1, "X", "Z", goes_on=True)
    (record,) = bench.measurement.records
    assert record is run.record
    assert (record.axes, record.block, record.begin_ns) == (("X", "Z"), str(BLOCK), 5 * MS)
    assert (record.inputs, record.goes_on) == ({"X": 1, "Z": 2}, True)
    assert record.sources == {"X": "DRIVE", "Z": "DRIVE"}
    assert [bench.links[axis].orders for axis in AXES] == [["disarm"], [], ["disarm"]]


def test_a_reset_leaves_no_run_without_an_end_and_results_as_they_are() -> None:
    bench = Bench()
    done, broken = bench.arm(1, "X"), bench.arm(1, "Y")
    done.record.latched_mm["X"], done.record.end_ns = 1.0, 3 * MS
    broken.record.latched_mm["Y"] = 2.0
    bench.clock.now_ns = 9 * MS
    bench.measurement.reset()
    assert (done.record.end_ns, done.record.latched_mm) == (3 * MS, {"X": 1.0})
    assert (broken.record.end_ns, broken.record.latched_mm) == (9 * MS, {})


# Before a run


@pytest.mark.parametrize("act", ["check", "prepare", "choose"])
def test_an_axis_that_may_not_measure_is_refused(act: str) -> None:
    bench = Bench()
    bench.may_measure["Y"] = False
    measurement = bench.measurement

    def wanted() -> None:
        if act == "check":
            measurement.check("Y", 1)
        elif act == "prepare":
            measurement.prepare(canon.PrepareProbe(BLOCK, ("X", "Y")))
        else:
            measurement.choose(canon.ProbeSettings(BLOCK, "Y"))

    with pytest.raises(Alarm) as caught:
        wanted()
    assert caught.value.id == (50637 if act == "choose" else 50059)
    assert (measurement.prepared, bench.checked) == (set(), [])


def test_a_preparation_ends_for_all_with_one_of_its_axes() -> None:
    bench = Bench()
    measurement = bench.measurement
    measurement.prepare(canon.PrepareProbe(BLOCK, ("X", "Y")))
    measurement.forget_prepared("Z")
    assert measurement.prepared == {"X", "Y"}
    measurement.forget_prepared("Y")
    assert measurement.prepared == set()


def test_a_run_is_checked_against_its_source_and_distance_control() -> None:
    bench = Bench(Y=MeasuringAxis(source="PLC"), Z=MeasuringAxis(source="FIXED_STOP"))
    bench.measurement.check("X", 1)
    alarm_ids = []
    for axis, type_ in (("X", 7), ("Y", 1), ("Z", 1)):
        with pytest.raises(Alarm) as caught:
            bench.measurement.check(axis, type_)
        alarm_ids.append(caught.value.id)
    assert alarm_ids == [900241, 900400, 900242]
    assert bench.checked == ["X", "X", "Y", "Z"]


@pytest.mark.parametrize("probing", [None, *AXES])
def test_nothing_is_chosen_while_a_probe_is_armed(probing: str | None) -> None:
    bench = Bench()
    if probing is not None:
        bench.links[probing].is_probing = True
    assert bench.measurement.may_choose() is (probing is None)


def test_every_axis_that_a_run_moves_or_measures_with_takes_part_in_it() -> None:
    bench = Bench()
    found = bench.measurement.state_of
    assert [found(axis) for axis in AXES] == [None] * 3
    parts: Any = bench.measurement
    parts._run = SimpleNamespace(record=RunRecord(("X",)), state=RunState.MOVING)
    parts._order = SimpleNamespace(target_mm={"Y": 2.0})
    assert [found(axis) for axis in AXES] == ["MOVING", "MOVING", None]
