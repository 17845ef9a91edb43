"""What #MEAS PREPARE has named, what a reset leaves of a run, and which axes a run names."""

from typing import Any

import pytest
from tests.channel.probing.test_begin_of_a_run import Runs
from tests.channel.probing.test_measurement_by_hand import AXES, BLOCK, Bench

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import EXTERNAL, PLC
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS


def prepared(*blocks: tuple[str, ...]) -> Bench:
    bench = Bench()
    for axes in blocks:
        bench.measurement.prepare(canon.PrepareProbe(BLOCK, axes))
    return bench


def test_what_is_prepared_later_joins_what_is_prepared_already() -> None:
    bench = prepared(("X",), ("Y", "Z"))
    assert bench.measurement.prepared == {"X", "Y", "Z"}


@pytest.mark.parametrize("axis", ["X", "Y"])
def test_an_axis_that_is_homed_takes_the_preparation_of_all_along(axis: str) -> None:
    bench = prepared(("X",), ("Y",))
    bench.measurement.forget_prepared("Z")
    assert bench.measurement.prepared == {"X", "Y"}
    bench.measurement.forget_prepared(axis)
    assert bench.measurement.prepared == set()


def test_an_axis_that_must_not_measure_is_prepared_with_no_other() -> None:
    bench = Bench()
    bench.may_measure["Y"] = False
    with pytest.raises(Alarm) as refused:
        bench.measurement.prepare(canon.PrepareProbe(BLOCK, ("X", "Y")))
    assert (refused.value.id, refused.value.values["axis"]) == (50059, "Y")
    assert bench.measurement.prepared == set()


def moving(**target: float) -> Runs:
    bench = Runs()
    bench.go(1, 10.0, **target)
    return bench


def test_a_reset_breaks_a_run_off_without_a_result() -> None:
    bench = moving(Z=5.0)
    orders = bench.links["Z"].orders
    assert orders[-1] == "arm"
    orders.clear()
    bench.clock.now_ns += 7 * MS
    bench.measurement.reset()
    assert (orders, bench.measurement.is_active) == (["disarm"], False)
    (record,) = bench.measurement.records
    assert (record.end_ns, record.latched_mm) == (bench.clock.now_ns, {})
    assert bench.measurement.measured_acs_mm("Z") is None
    bench.measurement.reset()
    assert orders == ["disarm"]


def test_an_end_of_a_run_stays_when_a_reset_comes_later() -> None:
    bench = moving(Z=5.0)
    (record,) = bench.measurement.records
    bench.measurement.abort()
    record.end_ns, record.latched_mm = 3 * MS, {"Z": 1.0}
    bench.clock.now_ns = 100 * MS
    bench.measurement.reset()
    assert (record.end_ns, record.latched_mm) == (3 * MS, {"Z": 1.0})


def test_the_axes_come_to_rest_once_the_set_path_has_ended_not_in_their_windows() -> None:
    """The SYNC of the rest is the first one after the path with a still encoder."""
    bench = moving(Z=5.0)
    reported: list[bool] = []
    rest: Any = bench.measurement._standstill
    look = rest.look
    rest.look = lambda has_ended: reported.append(has_ended) or look(has_ended)
    bench.path.has_stopped = True
    bench.measurement.step()
    bench.path.has_stopped, bench.path.is_in_position = False, lambda: True
    bench.measurement.step()
    assert reported == [True, False]


@pytest.mark.parametrize("programmed", [("X",), ("Y", "X")])
def test_900103_names_the_axes_of_the_block_and_not_those_that_a_system_turns(
    programmed: tuple[str, ...],
) -> None:
    bench = Runs()
    target = dict.fromkeys(AXES, 0.0)
    command = canon.MeasuringRun(BLOCK, target, programmed, programmed, 600.0, 1)
    with pytest.raises(Alarm) as refused:
        bench.measurement.begin(command)
    assert (refused.value.id, refused.value.values["axes"]) == (900103, " ".join(programmed))


def test_every_axis_of_a_run_is_noted_with_its_own_source() -> None:
    bench = Bench()
    bench.measurement._at_plc.choose = lambda axis, *_any: bench.links[axis]  # type: ignore[method-assign]
    for axis, source in (("Z", PLC), ("Y", EXTERNAL)):
        bench.measurement.choose(canon.ProbeSettings(BLOCK, axis, source=source))
    bench.arm(1, "Z", "Y", "X")
    assert bench.measurement.records[-1].sources == {"Z": PLC, "Y": EXTERNAL, "X": "DRIVE"}


@pytest.mark.parametrize(("axis", "takes_part"), [("X", True), ("Y", True), ("Z", False)])
def test_an_axis_takes_part_that_moves_or_measures(axis: str, takes_part: bool) -> None:
    """X moves and Y measures."""
    bench = Runs()
    bench.measurement.begin(canon.MeasuringRun(BLOCK, {"X": 5.0}, ("X",), ("Y",), 600.0, 1))
    assert (bench.measurement.state_of(axis) is not None) is takes_part
    bench.measurement.abort()
    assert bench.measurement.state_of(axis) is None
