"""Contacts other than those of a probe on its way: at another axis, none at all, at the end."""

from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from tests.judge import stop_recordings as stops
from tests.judge.test_touches import RUN, recorded, seen
from tests.judge.test_two_axes_at_stops import recorded as two_axes
from tests.recordings import kept

from axisrig.bench.judge.fixed_stop.run import stop_runs
from axisrig.bench.judge.observed.motion import INSIDE, state_at
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import Contact, Edge, ProbeRecord
from axisrig.bench.record.kinematics import KinematicRecord
from axisrig.bench.record.measuring import Criteria
from axisrig.kernel.time.clock import MS

MET_NOTHING = "the axis met nothing during the measurement run"


@pytest.mark.parametrize(("first", "other"), [("Z", "X"), ("X", "Z")])
@pytest.mark.parametrize("rows", [3, 7])
def test_at_the_contact_of_one_axis_the_other_one_is_on_its_way(
    first: str, other: str, rows: int
) -> None:
    """At 140.3 ms; the later axis is 10 mm/s times its rows behind, and at its own speed."""
    observed = two_axes({first: 0, other: rows})
    place = seen(observed, f"contact_mm:{first}")
    assert place.value == pytest.approx(stops.STOP_MM, abs=1e-9)
    assert INSIDE not in place.note
    place = seen(observed, f"contact_mm:{other}")
    behind_mm = stops.V_MM_S * 1e-3 * rows
    assert place.value == pytest.approx(stops.STOP_MM - behind_mm, abs=1e-6)
    assert INSIDE in place.note
    for axis in (first, other):
        speed = seen(observed, f"contact_velocity_mm_s:{axis}")
        assert speed.value == pytest.approx(stops.V_MM_S, abs=1e-6)
    late = seen(observed, f"contact_to_standstill_ms:{other}")
    assert late.value == pytest.approx((stops.END_NS / 1e6) - stops.CONTACT_MS, abs=1e-5)


@pytest.mark.parametrize(
    "metric",
    ["contact_mm", "contact_velocity_mm_s", "overtravel_mm", "contact_to_standstill_ms",
     "contact_to_latch_ms"],
)  # fmt: skip
def test_an_axis_that_meets_no_stop_has_no_contact(metric: str) -> None:
    """The stop is at 50 mm, the axis goes 2 mm."""
    nothing = np.zeros(stops.ROWS)
    free = stops.recorded(
        plant={"stop_position": 0.05},
        columns={"stop_force_n": nothing, "stop_force_peak_n": nothing},
    )
    found = seen(free, metric)
    assert (found.value, found.note) == (None, MET_NOTHING)
    assert seen(stops.recorded(), metric).note != MET_NOTHING


@pytest.mark.parametrize("known_ns", [1.0, 2500.0])
def test_behind_the_last_sync_a_speed_is_that_of_its_row_and_no_way_is_known(
    known_ns: float,
) -> None:
    """Contact and edge after row 39, at 10 mm/s; the run ends before a next one."""
    contact = Contact(39_400_000, {"z": 99.606, "x": 5.0788})
    probe = ProbeRecord(True, known_ns, (contact,), (Edge(39_500_000, True),))
    run = replace(RUN, end_ns=39_800_000, signal_ns=None)
    observed = recorded(run, probes={"probe": probe})
    latch = seen(observed, "latch_mm:Z")
    way_mm = 10.0 * known_ns * 1e-9 if known_ns > 1.0 else 0.0
    assert latch.uncertainty == pytest.approx(way_mm, abs=1e-12)
    assert ("edge known to 2500 ns" in latch.note) is (known_ns > 1.0)
    assert seen(observed, "contact_mm:Z").value == 99.606
    for axis in ("Z", "X"):
        far = seen(observed, f"overtravel_mm:{axis}")
        assert (far.value, far.note) == (None, "the run ended before the next SYNC")
        speed = seen(observed, f"contact_velocity_mm_s:{axis}")
        assert (speed.value, speed.note) == (None, "no SYNC came after the contact")
    assert seen(observed, "contact_to_standstill_ms").value == pytest.approx(0.4)


def test_without_distance_control_its_metrics_say_whose_it_would_be() -> None:
    observed = recorded()
    for metric in ("offset_end_mm", "distance_error_um", "distance_dead_cycles"):
        for asked, note in ((metric, "no axis has it"),
                            (f"{metric}:X", "axis X has no distance control")):  # fmt: skip
            found = seen(observed, asked)
            assert (found.value, found.note) == (None, note)


HEAD = ("X", "Y", "Z", "C", "A")


@pytest.mark.parametrize(
    ("begin_ms", "end_ms", "axes"),
    [
        (0, None, HEAD),  # the run has no truth of X, Y, C and A
        (11, None, ("Z",)),  # it comes on after the begin of the run
        (0, 10, ("Z",)),  # it is off at its begin
    ],
)
def test_a_kinematic_that_is_not_the_one_of_a_run_leaves_its_path_to_its_axes(
    begin_ms: int, end_ms: int | None, axes: tuple[str, ...]
) -> None:
    """The block goes 5 mm along Z; its demand has gone 1 mm at 120 ms, 2 mm at its end."""
    end_ns = None if end_ms is None else end_ms * MS
    on = KinematicRecord(begin_ms * MS, end_ns, axes, (9,), 80.0)
    observed = stops.recorded()
    under = Observed(replace(observed.facts, kinematics=(on,)), observed.series)
    (run,) = stop_runs(under)
    assert run.block_mm == pytest.approx(5.0)
    assert run.path_mm[[20, 120, 399]] == pytest.approx([0.0, 1.0, 2.0])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_place_of_a_contact_is_that_of_the_stop_however_the_axis_brakes(side: float) -> None:
    """By the speed at its end the step of the contact would be a curve."""
    speed = side * np.select([stops.K == 140, stops.K == 141], [12.0, 2.0], stops.SPEED)
    observed = stops.recorded(side, columns={"velocity_mm_s": speed})
    assert stops.seen(observed, "contact_mm").value == pytest.approx(
        side * stops.STOP_MM, abs=1e-12
    )


def test_an_axis_outside_takes_part_in_a_stop_without_a_truth() -> None:
    """Its drive is real: no plant gives where it is."""
    plain = stops.recorded()
    (run,) = plain.facts.runs
    assert run.fixed_stop is not None
    both = replace(run.fixed_stop, axes=("Z", "X"), criteria={"Z": Criteria(), "X": Criteria()})
    axes = {**plain.axes, "X": replace(plain.axes["X"], is_outside=True)}
    facts = replace(plain.facts, axes=axes, runs=(replace(run, fixed_stop=both),))
    (found,) = stop_runs(Observed(facts, plain.series))
    assert list(found.truths) == found.watched == ["Z"]
    assert found.detection[0] == "Z"


def test_beside_a_stop_the_doubts_of_the_instant_and_of_the_step_add_up() -> None:
    """Z has a contact that is known badly; X is on its way, and its speed swings."""
    plain = two_axes({"Z": 0, "X": 7})
    table = plain.series.table()
    swings = {
        "Z.velocity_mm_s": np.where(stops.K == 138, 5.0, 0.0),
        "X.velocity_mm_s": 0.5 * (-1.0) ** stops.K,
    }
    for name, more in swings.items():
        values = pa.array(table[name].to_numpy() + more)
        table = table.set_column(table.column_names.index(name), name, values)
    observed = Observed(plain.facts, kept(table))
    (run,) = stop_runs(observed)
    contact = run.contact("Z")
    assert contact is not None
    assert contact.uncertainty_ns > 1000.0
    there = state_at(observed, "X", round(contact.time_ns))
    assert there is not None
    assert there.doubt_mm > 0.0
    found = stops.seen(observed, "contact_mm:X")
    way_mm = (abs(there.speed_mm_s) + there.doubt_mm_s) * contact.uncertainty_ns * 1e-9
    assert found.uncertainty == pytest.approx(way_mm + there.doubt_mm)
    assert found.value == there.position_mm
    assert stops.seen(observed, "contact_mm:Z").uncertainty == 0.0
