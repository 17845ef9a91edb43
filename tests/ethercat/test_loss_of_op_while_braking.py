"""A slave that falls out of OP while its axis brakes with the quick-stop ramp."""

import pytest
from tests.ethercat.line import Line

from axisrig.bench.drive.ethercat.node import OUTPUTS_LOST, SYNC_LOST
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS

QUICK_STOP = 0x02


@pytest.mark.parametrize(
    ("code", "emergency"),
    [("WATCHDOG", OUTPUTS_LOST), ("SYNC_ERROR", SYNC_LOST), ("FATAL_SYNC", SYNC_LOST),
     ("", OUTPUTS_LOST)],
)  # fmt: skip
@pytest.mark.parametrize("control", [0x0F, QUICK_STOP])
def test_a_drive_that_brakes_has_lost_its_master_too(
    monkeypatch: pytest.MonkeyPatch, code: str, emergency: int, control: int
) -> None:
    """605A = 6 stays in quick stop active: what 6007 says counts there as in operation."""
    line = Line()
    line.op()
    line.enable()
    line.drive.servo.image.quick_stop_option = 6
    line.cycle(control=control)
    line.wait(MS)
    line.cycle(control=control)
    expected = State.QUICK_STOP_ACTIVE if control == QUICK_STOP else State.OPERATION_ENABLED
    assert line.drive.servo.state is expected
    lost: list[int] = []
    monkeypatch.setattr(
        line.drive.servo, "connection_lost", lambda now_ns, found: lost.append(found)
    )
    if code:
        line.drive.states.fall(AlState.SAFEOP, code)
    else:
        line.ask(AlState.SAFEOP)
    assert lost == [emergency]


def test_a_drive_that_is_not_enabled_has_lost_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    line = Line()
    line.op()
    lost: list[int] = []
    monkeypatch.setattr(
        line.drive.servo, "connection_lost", lambda now_ns, found: lost.append(found)
    )
    line.drive.states.fall(AlState.SAFEOP, "WATCHDOG")
    assert lost == []
