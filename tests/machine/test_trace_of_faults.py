"""What the trace shows when a drive is lost: time goes on, and so does the axis."""

import numpy as np
import pytest

from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import Scenario

INPUTS = ("plc:V.E.FEED1=900", "plc:V.E.FEED2=300", "plc:V.E.RETRACT=0.2")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", ["power_loss=Z", "bus_off=Z", "sync_loss=can1"])
def test_rows_go_on_when_no_sync_reaches_the_drive(kind: str) -> None:
    _, machine = examine(Scenario(0, 1, (*INPUTS, f"fault:{kind} at=motion+30ms")))
    assert machine is not None
    trace = machine.recorder.table()
    times = trace.column("time_ns").to_numpy()
    assert np.diff(times).min() > 0
    # Each row lies between the request of its SYNC and its NC cycle, 600 us later
    assert (np.diff(times // 1_000_000) == 1).all()
    assert (times % 1_000_000).max() <= 600_000
    # A moving axis is never shown at the same place twice
    is_moving = np.abs(trace.column("Z.velocity_mm_s").to_numpy()[:-1]) > 1.0
    assert is_moving.sum() > 10
    assert (np.diff(trace.column("Z.truth_mm").to_numpy())[is_moving] != 0).all()


@pytest.mark.long
@pytest.mark.parametrize(
    "kind", ["drop=Z.TPDO1", "sync_loss=Z", "drop=Z.RPDO1", "reset=Z command=stop"]
)
def test_the_run_goes_on_after_an_alarm_until_the_axis_stands(kind: str) -> None:
    """The last rows show the halt; the program ended before, and the SYNCs went on."""
    _, machine = examine(Scenario(0, 1, (*INPUTS, f"fault:{kind} at=motion+30ms")))
    assert machine is not None
    trace = machine.recorder.table()
    times = trace.column("time_ns").to_numpy()
    velocity = trace.column("Z.velocity_mm_s").to_numpy()
    assert machine.channel.alarms
    alarm_ns = machine.channel.alarm_ns[0]
    assert abs(velocity[times <= alarm_ns][-1]) > 1.0
    assert np.abs(velocity[-10:]).max() < 0.2
    assert alarm_ns <= machine.end_ns < times[-1] <= machine.end_ns + 501_000_000


@pytest.mark.long
def test_a_drive_that_is_gone_does_not_hold_the_end_up() -> None:
    _, machine = examine(Scenario(0, 1, (*INPUTS, "fault:power_loss=Z at=motion+30ms")))
    assert machine is not None
    times = machine.recorder.table().column("time_ns").to_numpy()
    assert times[-1] - machine.end_ns <= 501_000_000
