"""Feedhold of the PLC side on the machine; set positions by closed forms, contacts by the plant.

Z of the rig starts at 130 mm; every ramp is 1000 mm/s² unless the lists of the rig say otherwise.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axisrig.bench.campaign.single_program import run_program
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, S

RunNc = Callable[..., Any]
BASE = "probe-z.toml"
RIG = Path(__file__).parents[2] / "testplans" / "rigs" / BASE


def at_ns(out: Any, words: str) -> int:
    (time_ns,) = (note.time_ns for note in out.facts.plc if note.words == words)
    return time_ns


def set_at(out: Any, time_ns: int) -> float:
    """Set position in the row of the trace that holds an instant."""
    times = out.column("time_ns")
    return float(out.column("Z.set_mm")[np.searchsorted(times, time_ns, side="right") - 1])


def slope(out: Any) -> tuple[float, float]:
    """Acceleration and deceleration of G1, as the list has them, mm/s²; below the change-over."""
    listed = out.machine.settings.axis["Z"]
    path = "getriebe[0].lslope_profil"
    return listed.mm_s2(f"{path}.a_stufe_1"), listed.mm_s2(f"{path}.d_stufe_1")


@pytest.mark.long
def test_the_path_stands_where_the_ramp_ends_and_takes_that_much_longer(run_nc: RunNc) -> None:
    """G1 at 50 mm/s; held 0.3 s after 0.1 s. The stop costs what it lasts and both ramps."""
    program = "N10 G1 Z110 F3000"
    free = run_nc(program, "", base=BASE)
    held = run_nc(program, "", "plc:feedhold=at=100ms for=300ms", base=BASE)
    up, down = slope(held)
    on_ns, off_ns = at_ns(held, "feedhold on"), at_ns(held, "feedhold off")
    assert on_ns == held.machine.channel.start_ns + 100 * MS
    assert off_ns == on_ns + 300 * MS
    # the path begins in the cycle of the start, so 0.1 s of it are travelled
    travelled_mm = 50.0**2 / (2 * up) + 50.0 * (0.1 - 50.0 / up) + 50.0**2 / (2 * down)
    assert set_at(held, on_ns + 200 * MS) == pytest.approx(130.0 - travelled_mm, abs=1e-9)
    assert set_at(held, off_ns - MS) == set_at(held, on_ns + 200 * MS)
    # from 50 mm/s to 0 and back: half of the time of both ramps is lost
    longer_s = 0.3 - 50.0 / down + 0.5 * (50.0 / down + 50.0 / up)
    more_ns = held.machine.channel.end_ns - free.machine.channel.end_ns
    assert more_ns == pytest.approx(longer_s * S, abs=2 * held.machine.timing.period_ns)
    assert held.column("Z.set_mm")[-1] == free.column("Z.set_mm")[-1] == 110.0
    assert held.alarms == []


@pytest.mark.long
def test_blocks_without_motion_go_on_and_the_next_path_waits(run_nc: RunNc) -> None:
    out = run_nc(
        "N10 G4 0.05\nN20 M50\nN30 M7\nN40 G1 Z129 F600\nN50 M8",
        "",
        "plc:feedhold=at=10ms for=200ms; at=100ms for=150ms",
        base=BASE,
    )
    off_ns = at_ns(out, "feedhold off")
    assert off_ns == out.machine.channel.start_ns + 250 * MS  # the later one of two that overlap
    assert at_ns(out, "M7 to the PLC") < out.machine.channel.start_ns + 60 * MS
    assert set_at(out, off_ns - MS) == 130.0
    assert set_at(out, off_ns + 3 * MS) < 130.0
    assert at_ns(out, "M8 to the PLC") > off_ns


@pytest.mark.long
def test_axes_beside_the_path_go_on(run_nc: RunNc) -> None:
    """X moves by itself while Z is held; both end where they should."""
    out = run_nc(
        "N10 X[INDP_ASYN G90 G1 POS=20 FEED=6000]\nN20 G1 Z240 F3000\nN30 #WAIT INDP [X]",
        "",
        "plc:feedhold=at=20ms for=1s",
    )
    times, x_mm = out.column("time_ns"), out.column("X.set_mm")
    there_ns = int(times[(x_mm == 20.0).argmax()])
    assert there_ns < at_ns(out, "feedhold off")
    assert out.column("Z.set_mm")[-1] == 240.0
    assert out.alarms == []


@pytest.mark.long
def test_the_probe_touches_on_the_ramp_of_a_feedhold(run_nc: RunNc) -> None:
    """The run ends in the feedhold, with the place of the edge; nothing waits for its end."""
    program = 'N10 G100 Z80 F3000\nN20 #MSG SYN["z=%f", V.A.MESS.Z]\nN30 G1 Z110'
    free = run_nc(program, "", base=BASE)
    start_ns = free.machine.channel.start_ns
    late_ms = (free.edge_ns() - start_ns) // MS
    for before_ms in (5, 40):
        out = run_nc(program, "", f"plc:feedhold=at={late_ms - before_ms}ms for=500ms", base=BASE)
        assert out.alarms == []
        (record,) = out.machine.channel.records
        on_ns, off_ns = at_ns(out, "feedhold on"), at_ns(out, "feedhold off")
        assert on_ns < out.edge_ns() < on_ns + 70 * MS
        assert record.signal_ns is not None
        assert record.end_ns is not None
        assert record.end_ns < off_ns
        (measured,) = out.printed("z")
        assert measured == pytest.approx(100.0, abs=2e-3)  # 4 us of input delay and less speed
        times, set_mm = out.column("time_ns"), out.column("Z.set_mm")
        retracts_ns = int(times[(set_mm > set_at(out, off_ns)).nonzero()[0]][-1:][0])
        assert retracts_ns > off_ns
        assert set_mm[-1] == 110.0


@pytest.mark.long
def test_a_run_that_stands_in_a_feedhold_measures_as_without(run_nc: RunNc) -> None:
    program = 'N10 G100 Z80 F600\nN20 #MSG SYN["z=%f", V.A.MESS.Z]'
    (free,) = run_nc(program, "", base=BASE).printed("z")
    out = run_nc(program, "", "plc:feedhold=at=run+1s for=400ms; at=run+2s for=30ms", base=BASE)
    (held,) = out.printed("z")
    assert held == pytest.approx(free, abs=1e-5)
    assert out.machine.channel.records[0].signal_ns > at_ns_last(out, "feedhold off")


def at_ns_last(out: Any, words: str) -> int:
    return max(note.time_ns for note in out.facts.plc if note.words == words)


@pytest.mark.long
def test_an_alarm_in_a_feedhold_stops_for_good(run_nc: RunNc) -> None:
    """The drive is silent 50 ms after the path stands: class 7 does not wait for 10 s."""
    out = run_nc(
        "N10 G1 Z110 F3000",
        "",
        "plc:feedhold=at=100ms for=10s",
        "fault:drop=Z.TPDO1 at=200ms",
        base=BASE,
    )
    assert out.alarms == [900006]
    assert out.machine.channel.end_ns < out.machine.channel.start_ns + 300 * MS
    assert out.column("Z.set_mm")[-1] == set_at(out, out.machine.channel.start_ns + 190 * MS)


@pytest.mark.long
def test_a_program_that_a_feedhold_holds_says_so(tmp_path: Path) -> None:
    program = tmp_path / "held.nc"
    program.write_text("N10 G1 Z110 F3000\nM30\n", encoding="utf-8")
    changes = ["plc:limit_s=1", "plc:feedhold=at=100ms for=600s"]
    with pytest.raises(UserError, match="PLC side holds the path"):
        run_program(program, RIG, changes, (), lambda _: None)
