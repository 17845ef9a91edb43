"""Edges placed about the SYNC in which an axis comes to rest at the target of its run.

The axis of these tests is x' = Kv (demand - x), so its position is known at any instant, and so are
the values of 6064 without asking the kernel. It comes to rest in the first SYNC after the last
change of what was sent with 6064 inside the window and changed by at most one increment. An edge
with its delay up to that SYNC counts, one a nanosecond later does not.
"""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.measuring.latest_edge import StampClock

Make = Callable[..., Any]
MS, US = 1_000_000, 1_000
INCREMENTS_PER_MM = 2**20 / 10
TARGET_MM, WINDOW_MM, FAR_MM = 129.0, 0.001, 0.0
SYNC_NS = 48 * US  # 48 bits at 1 Mbit/s up to the end of the frame
STAMPED = (
    "pdo,transmission,inhibit_100us,index,sub,bits,signed,field,note\n"
    "RPDO1,1,0,0x6040,0,16,no,controlword,\nRPDO1,1,0,0x607A,0,32,yes,target,\n"
    "RPDO1,1,0,0x60B8,0,16,no,probe_function,\nTPDO1,1,0,0x6041,0,16,no,statusword,\n"
    "TPDO1,1,0,0x6064,0,32,yes,actual,\nTPDO1,1,0,0x60B9,0,16,no,probe_status,\n"
    "TPDO2,1,0,latch,0,32,yes,latch,\nTPDO2,1,0,stamp,0,32,no,,\n"
)


class Rig:
    """Makes runs of one kind, each with an edge of its own."""

    def __init__(self, make: Make, words: Any, kind: int, **options: Any) -> None:
        self._make, self._words, self._kind, self._options = make, words, kind, options
        self.delay_ns = options["profile"].input_delay_ns

    def run(self, edge_ns: int | None) -> Any:
        """Run to the target with a probe that goes up at an instant."""
        words = self._words
        axis = words.axis("Z", start_mm=130.0, window_mm=WINDOW_MM, measuring_mm_s=10.0)
        bench = self._make(axis, plane_mm=FAR_MM, **self._options)
        bench.world.probe.is_deflected = lambda at: edge_ns is not None and at >= edge_ns
        run = words.probe(1, 600.0, self._kind, Z=TARGET_MM)
        return bench.run([run, words.wait(1), words.end()])

    def rest_sync_ns(self) -> int:
        """Delivery of the SYNC in which the axis comes to rest, where no edge comes."""
        bench = self.run(None)
        sent = [(s.time_ns, s.sent_mm[0]) for s in bench.samples]
        ended_ns = max(t for (_, a), (t, b) in pairwise(sent) if a != b)
        syncs = [t for t in bench.sync_ns() if t < bench.channel.end_ns]
        axis = bench.axes["Z"]
        found = [round(axis.position_at(t) * 1e3 * INCREMENTS_PER_MM) for t in syncs]
        return next(
            t
            for t, before, here in zip(syncs[1:], found, found[1:], strict=False)
            if t > ended_ns
            and abs(here / INCREMENTS_PER_MM - TARGET_MM) <= WINDOW_MM
            and abs(here - before) <= 1
        )


def profile(status: int, value: int = 0) -> DriveProfile:
    return DriveProfile(input_delay_ns=4 * US, status_delay_cycles=status, value_delay_cycles=value)


@pytest.fixture
def stamped(tmp_path: Path) -> str:
    path = tmp_path / "stamped.csv"
    path.write_text(STAMPED)
    return str(path)


# Latch instant less the SYNC of the standstill, ns
ABOUT = (-20 * MS, -MS, -1, 0, 1, MS // 2, MS, 3 * MS, 8 * MS, 15 * MS)


@pytest.mark.parametrize(("status", "value"), [(0, 0), (2, 1)], ids=["prompt", "slow"])
@pytest.mark.parametrize("has_stamps", [False, True], ids=["status", "stamp"])
@pytest.mark.long
def test_an_edge_counts_up_to_the_standstill(
    channel_bench: Make, words: Any, stamped: str, status: int, value: int, has_stamps: bool
) -> None:
    options: dict[str, Any] = {"profile": profile(status, value)}
    if has_stamps:
        options |= {"pdo_map": stamped, "stamps": StampClock(sync_ns=SYNC_NS)}
    rig = Rig(channel_bench, words, 1, **options)
    rest_ns = rig.rest_sync_ns()
    for late_ns in ABOUT:
        bench = rig.run(rest_ns + late_ns - rig.delay_ns)
        (record,) = bench.channel.records
        counts = late_ns <= 0
        assert (record.has_signal, bench.alarm_ids) == (counts, []), late_ns
        assert bench.channel.measurement_ok("Z") is counts
        if counts:
            latch_mm = bench.axes["Z"].position_at(rest_ns + late_ns) * 1e3
            assert record.latched_mm["Z"] == pytest.approx(latch_mm, abs=1 / INCREMENTS_PER_MM)


@pytest.mark.long
@pytest.mark.parametrize("late_ns", [0, 1, 15 * MS])
def test_type_2_does_not_hide_its_alarm(channel_bench: Make, words: Any, late_ns: int) -> None:
    """Up to 16 cycles after the standstill an edge once took the place of the alarm."""
    rig = Rig(channel_bench, words, 2, profile=profile(0))
    bench = rig.run(rig.rest_sync_ns() + late_ns - rig.delay_ns)
    assert bench.alarm_ids == ([] if late_ns == 0 else [900004])


@pytest.mark.long
def test_the_axis_comes_to_rest_long_after_it_has_entered_its_window(
    channel_bench: Make, words: Any
) -> None:
    """10 mm/s at Kv 40 leave 0.25 mm; from there to 1 um takes ln(250)/40 s, to an increment and
    cycle ln(250 Kv T 105)/40 s: the edges in between are measurements."""
    rig = Rig(channel_bench, words, 1, profile=profile(0))
    bench = rig.run(None)
    (record,) = bench.channel.records
    entered = next(
        s.time_ns
        for s in bench.samples
        if s.sent_mm[0] == TARGET_MM
        and abs(bench.axes["Z"].position_at(s.time_ns) * 1e3 - TARGET_MM) < WINDOW_MM
    )
    assert rig.rest_sync_ns() - entered > 20 * MS
    assert 0 < record.end_ns - rig.rest_sync_ns() < MS


@pytest.mark.long
def test_an_edge_within_the_overtravel_is_a_measurement(channel_bench: Make, words: Any) -> None:
    """P-AXIS-00467 moves the end of the run: 0.5 mm behind the target, 0.3 mm before the end."""
    for plane_mm, counts in ((128.5, True), (128.1, False)):
        axis = words.axis("Z", start_mm=130.0, probing_offset_mm=0.8, window_mm=WINDOW_MM)
        bench = channel_bench(axis, plane_mm=plane_mm)
        bench.run([words.probe(1, 600.0, 2, Z=TARGET_MM), words.wait(1), words.end()])
        assert bench.alarm_ids == ([] if counts else [900004])
        if counts:
            measured = bench.channel.measured_acs_mm("Z")
            assert measured == pytest.approx(plane_mm, abs=1 / INCREMENTS_PER_MM)
            assert measured - TARGET_MM == pytest.approx(-0.5, abs=1 / INCREMENTS_PER_MM)


@pytest.mark.long
def test_a_second_run_without_a_signal_leaves_nothing_of_the_first(
    channel_bench: Make, words: Any
) -> None:
    """P-CHAN-00176 = 0. Also while it is under way the axis has no result."""
    bench = channel_bench(words.axis("Z", start_mm=130.0), plane_mm=120.0)
    known: dict[str, set[float | None]] = {}

    def note(channel: Any) -> None:
        runs = [r for r in channel.records if r.begin_ns < bench.scheduler.now_ns]
        if runs and (runs[-1].end_ns is None or len(runs) == 2):
            known.setdefault(str(len(runs)), set()).add(channel.measured_acs_mm("Z"))

    bench.channel.observers.append(note)
    first, second = words.probe(1, 600.0, Z=110.0), words.probe(3, 600.0, Z=125.0)
    back = words.move(2, 6000.0, Z=130.0)
    bench.run([first, words.wait(1), back, second, words.wait(3), words.end()])
    assert [record.has_signal for record in bench.channel.records] == [True, False]
    assert bench.alarm_ids == []
    assert not bench.channel.measurement_ok("Z")
    assert known == {"1": {None}, "2": {None}}
