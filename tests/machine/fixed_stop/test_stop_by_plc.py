"""Torque limit and lag window of the drive, set by the PLC side (FCT-C4 7.3, notice)."""

from pathlib import Path

import pytest
from tests.machine.conftest import RIGS, run_files
from tests.machine.fixed_stop.conftest import DETECT, RunStop, StopOutcome

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

BY_PLC = """\
%by_plc
N010 #MEAS MODE[7]
N020 G0 G90 Z100
N030 M50
N050 G100 Z150 F600
N060 #MSG SYN["MESS=%.9f", V.A.MESS.Z]
N070 G1 Z110 F600
N080 M51
N090 #DRIVE RD [AX=Z KEY=TORQUE_LIMIT P=V.P.T]
N100 #MSG SYN["limit=%d", V.P.T]
N110 M30
"""
LAG = {"pos_lag_limit": 15_000, "min_time": 100_000}
STOP_MM, FEED_MM_S, KV = 120.0, 10.0, 40.0
IN_FRONT = "plant:z.position_start_mm=100"


@pytest.mark.long
def test_a_run_with_limits_of_the_plc_side_is_that_with_limits_of_the_program(
    run_stop: RunStop, tmp_path: Path
) -> None:
    by_program = run_stop(STOP_MM, **LAG)
    program = tmp_path / "plc.nc"
    program.write_text(BY_PLC, encoding="utf-8")
    settings = [f"{DETECT}{name}={value}" for name, value in LAG.items()]
    given = [
        "set:Z.kenngr.measure.signal=FIXED_STOP",
        "plant:z.stop_position_mm=120",
        IN_FRONT,
        "plc:Z.torque_limit=400 at=M50; 50000 at=M51",
        "plc:Z.lag_window=0xFFFFFFFF at=M50; 1048575 at=M51",
    ]
    by_plc = StopOutcome(run_files(program, RIGS / "drive-functions.toml", [*settings, *given]))
    assert by_plc.alarms == []
    assert by_plc.outcome.printed("limit") == [5000]
    assert by_plc.record.latched_mm == pytest.approx(by_program.record.latched_mm, abs=1e-4)
    times = [note.time_ns for note in by_plc.outcome.facts.plc if "has taken it" in note.words]
    first, second, third, fourth = times
    assert first < second < by_plc.record.begin_ns
    assert by_plc.record.end_ns is not None
    assert by_plc.record.end_ns < third < fourth


@pytest.mark.long
def test_restoring_the_limit_behind_the_run_moves_nothing(run_stop: RunStop) -> None:
    """The lag is gone: 1 s behind the run the drive gets its full torque, and the axis stays.

    Within 0.5 um, which are 10 N at 20 N/um.
    """
    restore = "plc:Z.torque_limit=50000 at=run_end+1s"
    found = run_stop(STOP_MM, restore, end="N200 G4 2", **LAG)
    events = found.outcome.facts.plc
    (restored_ns,) = [note.time_ns for note in events if "50000: the drive has" in note.words]
    times, truth_mm = found.outcome.column("time_ns"), found.outcome.column("Z.truth_mm")
    before_mm = truth_mm[times < restored_ns][-1]
    assert before_mm > STOP_MM + 0.02
    assert truth_mm[times > restored_ns].max() - before_mm < 5e-4
    assert found.alarms == []


@pytest.mark.provokes(900005, 7, axis="Z")
@pytest.mark.parametrize("time_out_ms", [0, 50])
@pytest.mark.long
def test_a_lag_window_left_active_ends_the_run_with_the_fault_of_the_drive(
    run_stop: RunStop, time_out_ms: int
) -> None:
    """8611 at (first |60F4| > 6065) + 6066; nothing is measured.

    Physics 2(c), 2(d): the lag of the drive is v/Kv + v (t - t_c) - d once it stands at the stop, d
    its penetration; t_c and d are the plant's own. 2 mm are 209715 increments. The lag limit of the
    run would be reached later.
    """
    window_mm = 2.0
    faulted = run_stop(
        STOP_MM,
        IN_FRONT,
        "plc:Z.lag_window=209715 at=run",
        f"plc:Z.lag_window_time={time_out_ms} at=run",
        pos_lag_limit=30_000,
        min_time=100_000,
    )
    assert faulted.alarms == [900005]
    (alarm,) = faulted.outcome.machine.channel.alarms
    assert "8611" in str(alarm)
    assert faulted.record.latched_mm == {}
    assert faulted.stop.detected_ns is None
    assert faulted.stop.watch_on_ns is not None
    assert faulted.outcome.machine.links["Z"].watches_lag
    assert faulted.outcome.printed("MERF") == []
    times, truth_mm = faulted.outcome.column("time_ns"), faulted.outcome.column("Z.truth_mm")
    row = int((truth_mm > STOP_MM).argmax())
    contact_ns = times[row] - (truth_mm[row] - STOP_MM) / FEED_MM_S * 1e9
    pressed = (times > contact_ns + 150 * MS) & (times < contact_ns + 170 * MS)
    depth_mm = float(truth_mm[pressed].mean()) - STOP_MM
    due_s = (window_mm - FEED_MM_S / KV + depth_mm) / FEED_MM_S + time_out_ms / 1e3
    states = faulted.outcome.machine.part_of["Z"].states["Z"]
    fault_ns = next(s.time_ns for s in states if s.state == State.FAULT_REACTION_ACTIVE.name)
    assert (fault_ns - contact_ns) / 1e9 == pytest.approx(due_s, abs=2e-3)
