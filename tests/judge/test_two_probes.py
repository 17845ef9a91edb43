"""Two probes in one measurement run: the first contact, the first edge, the worse knowledge.

As `test_touches.py`: the run is from 5 to 30.6 ms, its signal in the cycle at 12.6 ms.
"""

from collections.abc import Mapping
from dataclasses import replace

import pytest
from tests.judge.test_touches import BLIND, NO_CONTACT, NONE, PROBE, RUN, recorded, seen

from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import Contact, Deflection, Edge, ProbeRecord
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.kernel.time.clock import MS

EARLY = ProbeRecord(True, 5.0, (Contact(9 * MS, {"x": 5.018}),), (Edge(9_100_000, True),))
BEFORE = ProbeRecord(True, 1.0, (), (Edge(2 * MS, True), Edge(4 * MS, False)))
LATER = ProbeRecord(True, 7.0, (), (Edge(11 * MS, False), Edge(12 * MS, True)))


def wired(x: ProbeRecord, z: ProbeRecord, turn: int = 1) -> Observed:
    """One probe at each drive; turn: -1 lists everything from its end."""
    probes = dict([("at_x", x), ("at_z", z)][::turn])
    run = replace(RUN, axes=RUN.axes[::turn])
    signals = ({"signals": {"probe_1": name}} for name in ("at_x", "at_z"))
    return recorded(run, probes=probes, x=next(signals), z=next(signals))


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("one", "other", "edge_ns", "contact_ns", "known_ns"),
    [
        (EARLY, PROBE, 9_100_000, 9 * MS, 5.0),
        (LATER, PROBE, 10_500_000, 10_400_000, 7.0),
        (LATER, EARLY, 9_100_000, 9 * MS, 7.0),
        (BEFORE, LATER, 11 * MS, None, 7.0),  # what was before the run is none of it
        (NONE, LATER, 11 * MS, None, 7.0),
        (NONE, BEFORE, None, None, 1.0),
        (BLIND, EARLY, 9_100_000, 9 * MS, 5.0),
    ],
)
def test_the_first_edge_and_contact_of_any_probe_count(
    one: ProbeRecord,
    other: ProbeRecord,
    edge_ns: int | None,
    contact_ns: int | None,
    known_ns: float,
    turn: int,
) -> None:
    """Whichever is wired to the first axis, and whichever axis comes first."""
    for x, z in ((one, other), (other, one)):
        observed = wired(x, z, turn)
        found = touch(observed, None)
        assert found is not None
        assert (found.edge_ns, found.edge_uncertainty_ns) == (edge_ns, known_ns)
        assert (found.contact and found.contact.time_ns) == contact_ns
        reaction = seen(observed, "reaction_ms")
        if edge_ns is None:
            assert (reaction.value, reaction.note) == (
                None, "no edge was seen in the measurement run",
            )  # fmt: skip
        else:
            assert reaction.value == pytest.approx((12_600_000 - edge_ns) / MS)
            assert reaction.uncertainty == pytest.approx(known_ns * 1e-6)


@pytest.mark.parametrize("turn", [1, -1])
def test_a_touch_has_the_edges_of_each_probe_in_the_run(turn: int) -> None:
    found = touch(wired(PROBE, LATER, turn), None)
    assert found is not None
    times = [tuple(edge.time_ns for edge in edges) for edges in found.edges]
    assert times == [(10_500_000, 20 * MS), (11 * MS, 12 * MS)][::turn]


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("one", "other", "note"),
    [
        (NONE, NONE, "the probe met nothing during the measurement run"),
        (NONE, BLIND, "the probe met nothing during the measurement run"),
        (BLIND, BLIND, NO_CONTACT),
    ],
)
def test_nothing_was_met_where_one_of_the_probes_would_have_given_it(
    one: ProbeRecord, other: ProbeRecord, note: str, turn: int
) -> None:
    for x, z in ((one, other), (other, one)):
        found = seen(wired(x, z, turn), "contact_to_standstill_ms")
        assert (found.value, found.note) == (None, note)


# The largest deflection


def bent(*sizes_mm: float) -> ProbeRecord:
    return replace(PROBE, deflections=tuple(Deflection(mm, mm / 100) for mm in sizes_mm))


def sizes(probe: ProbeRecord) -> list[float]:
    return [each.mm for each in probe.deflections]


METRIC = "probe_deflection_mm_max"


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize(
    ("x", "z", "values"),
    [
        (bent(0.2), bent(0.5, 0.1), {"": 0.5, ":X": 0.2, ":Z": 0.5}),
        (bent(0.2), NONE, {"": 0.2, ":X": 0.2, ":Z": 0.0}),
        (bent(0.2), BLIND, {"": None, ":X": 0.2, ":Z": None}),
        (BLIND, bent(0.2), {"": None, ":X": None, ":Z": 0.2}),
        (BLIND, BLIND, {"": None, ":X": None, ":Z": None}),
    ],
)
def test_a_largest_deflection_is_known_where_all_its_probes_give_contacts(
    x: ProbeRecord, z: ProbeRecord, values: Mapping[str, float | None], turn: int
) -> None:
    """One that gives none may have been deflected farther. Of an axis its own probe counts."""
    observed = wired(x, z, turn)
    for of, value in values.items():
        found = seen(observed, METRIC + of)
        assert found.value == value
        assert (found.note == NO_CONTACT) is (value is None)
        if value:
            assert found.uncertainty == pytest.approx(value / 100)
            names = [name for name, probe in (("at_x", x), ("at_z", z)) if value in sizes(probe)]
            assert found.note.partition(": ")[0] in names


@pytest.mark.parametrize("names", [("of_plc", "probe"), ("probe", "of_plc")])
def test_a_probe_of_the_plc_that_gives_no_contact_hides_the_largest_deflection(
    names: tuple[str, str],
) -> None:
    """It is of every axis; one that nothing is wired to hides nothing."""
    records = {"probe": bent(0.3), "of_plc": BLIND}
    probes = {name: records[name] for name in names}
    task = PlcTaskRecord(MS, 0, 0, MS, 0, probes=("of_plc",))
    for of in ("", ":X", ":Z"):
        assert seen(recorded(probes=probes, plc_task=task), METRIC + of).note == NO_CONTACT
        assert seen(recorded(probes=probes), METRIC + of).value == 0.3
