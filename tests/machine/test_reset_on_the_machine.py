"""Resets and starts of a PLC side on a real machine: what the moments of its columns mean."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.time.clock import MS

RunNc = Callable[..., Any]
BASE = "probe-z.toml"


@pytest.mark.long
def test_no_function_waits_for_its_reset(run_nc: RunNc) -> None:
    """M50 is acknowledged at once: Z moves on for 300 ms, 10 mm/s, and stands v t further."""
    out = run_nc("N10 M50\nN20 G1 Z100 F600", "", "plc:reset=at=M50+300ms", base=BASE)
    channel = out.machine.channel
    assert out.column("Z.set_mm")[-1] == 130.0 - 0.01 * 300
    assert channel.resets_ns[0] - channel.start_ns == (300 + 13) * MS  # v/a with 800 mm/s2
    assert out.alarms == []


@pytest.mark.long
def test_the_run_ends_when_no_action_is_left_and_the_program_has_ended(run_nc: RunNc) -> None:
    late = "plc:V.E.LATE=0; 1 at=400ms"
    out = run_nc("N10 G4 0.05", "", late, base=BASE)
    alone_ns = out.machine.channel.end_ns - out.machine.channel.start_ns
    assert alone_ns < 100 * MS  # without a reset or a start a program end ends the run
    out = run_nc("N10 G4 0.05", "", late, "plc:program_start=at=program_end+100ms", base=BASE)
    channel = out.machine.channel
    first_ns, second_ns = channel.program_ends_ns
    assert second_ns - first_ns == 150 * MS
    assert channel.end_ns - channel.start_ns == 400 * MS
    assert channel.plc.values["LATE"] == 1.0
