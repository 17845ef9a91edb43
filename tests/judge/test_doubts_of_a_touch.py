"""Several causes of doubt at once: each adds its part, and probes of PLC and drives both count.

As `test_touches.py`: Z goes with 10 mm/s, X with 2 mm/s.
"""

from dataclasses import replace

import pytest
from tests.judge.test_touches import NONE, PROBE, RUN, recorded, seen

from axisrig.bench.record.axes import Deflection, ProbeRecord
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.kernel.time.clock import MS

BELIEVED_MM, KNOWN_NS = 0.25, 3000.0


@pytest.mark.parametrize(
    ("metric", "of_run", "way", "known"),
    [
        ("latch_mm:Z", {"Z": BELIEVED_MM}, 10.0 * KNOWN_NS * 1e-9, "edge known to 3000 ns"),
        ("latch_mm:X", {"X": BELIEVED_MM}, 2.0 * KNOWN_NS * 1e-9, "edge known to 3000 ns"),
        ("latch_error_um:Z", {"Z": BELIEVED_MM}, 10e3 * KNOWN_NS * 1e-9, "events 3001 ns"),
    ],
)
def test_what_is_unproved_and_what_is_known_badly_add_up(
    metric: str, of_run: dict[str, float], way: float, known: str
) -> None:
    """The value is believed within 0.25 mm, the edge known to 3 us at the speed of the axis."""
    scale = 1e3 if "_um" in metric else 1.0
    latched = replace(RUN, latched_mm={"Z": 99.8965, "X": 5.021})
    coarse = {"probe": replace(PROBE, edge_uncertainty_ns=KNOWN_NS)}
    runs = {"sure": latched, "doubted": replace(latched, doubt_mm=of_run)}
    exact = {"probe": replace(PROBE, edge_uncertainty_ns=0.0)}
    sure = seen(recorded(runs["sure"], probes=exact), metric)
    both = seen(recorded(runs["doubted"], probes=coarse), metric)
    assert both.value == sure.value
    assert both.uncertainty - sure.uncertainty == pytest.approx(BELIEVED_MM * scale + way, rel=1e-6)
    assert f"latch of axis {metric[-1]} unproved: believed within 0.25 mm" in both.note
    assert known in both.note
    assert "unproved" not in sure.note


def bent(*sizes_mm: float) -> ProbeRecord:
    return replace(PROBE, deflections=tuple(Deflection(mm, mm / 50) for mm in sizes_mm))


@pytest.mark.parametrize("names", [("of_plc", "probe"), ("probe", "of_plc")])
@pytest.mark.parametrize(
    ("of_plc", "of_drive", "name", "largest_mm"),
    [
        (bent(0.25), bent(0.5), "probe", 0.5),
        (bent(0.5), bent(0.25), "of_plc", 0.5),
        (NONE, bent(0.125, 0.25), "probe", 0.25),
        (bent(0.25, 0.125), NONE, "of_plc", 0.25),
    ],
)
def test_the_largest_deflection_is_of_a_probe_at_a_drive_or_at_the_plc(
    of_plc: ProbeRecord, of_drive: ProbeRecord, name: str, largest_mm: float, names: tuple[str, str]
) -> None:
    records = {"probe": of_drive, "of_plc": of_plc}
    task = PlcTaskRecord(MS, 0, 0, MS, 0, probes=("of_plc",))
    observed = recorded(probes={each: records[each] for each in names}, plc_task=task)
    for of in ("", ":X", ":Z"):
        found = seen(observed, f"probe_deflection_mm_max{of}")
        assert found.value == largest_mm
        assert found.uncertainty == largest_mm / 50
        assert found.note.startswith(f"{name}: ")


def test_a_largest_deflection_has_its_own_doubt() -> None:
    """A smaller one that is known worse does not count."""
    probe = replace(PROBE, deflections=(Deflection(0.25, 0.125), Deflection(0.5, 0.0625)))
    found = seen(recorded(probes={"probe": probe}), "probe_deflection_mm_max")
    assert (found.value, found.uncertainty) == (0.5, 0.0625)


def test_a_probe_that_nothing_is_wired_to_has_no_deflection() -> None:
    loose = {"signals": {}}
    observed = recorded(probes={"probe": bent(0.5)}, x=loose, z={"signals": {"probe_2": "probe"}})
    for of, value in (("", 0.5), (":Z", 0.5)):
        assert seen(observed, f"probe_deflection_mm_max{of}").value == value
    found = seen(observed, "probe_deflection_mm_max:X")
    assert (found.value, found.note) == (None, "no probe is wired to the axis")
