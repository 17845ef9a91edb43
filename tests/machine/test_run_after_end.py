"""A run that goes on after its end (plc:after_end_ms): what was before stays, the rest is seen."""

from typing import Any

import numpy as np
import pytest
from tests.machine.conftest import RunNc

from axisrig.kernel.time.clock import MS

AFTER_MS = 150
DOWN = "N10 G1 Z129.5 F1200"


def rows_until(out: Any, end_ns: int) -> dict[str, Any]:
    """The columns of the trace up to an instant."""
    table = out.machine.recorder.table()
    until = np.searchsorted(table.column("time_ns").to_numpy(), end_ns, side="right")
    return {name: table.column(name).to_numpy()[:until] for name in table.column_names}


@pytest.mark.parametrize(
    ("more", "plc", "alarms"),
    [
        ("", "plc:feedhold=at=50ms for=20ms; at=400ms for=20ms", []),  # the second is after the end
        pytest.param("\nN20 M0", "plc:start_ms=500", [], marks=pytest.mark.long),
        pytest.param("\nN20 M0", "plc:optional_stop=1", [900170], marks=pytest.mark.long),
        pytest.param("", "plc:V.E.A=0; 1 at=30ms; 2 at=600ms", [], marks=pytest.mark.long),
    ],
)
def test_a_run_goes_on_and_what_was_before_stays(
    run_nc: RunNc, more: str, plc: str, alarms: list[int]
) -> None:
    """SYNC by SYNC, at least so long; the end of the program is where it was."""
    plain = run_nc(DOWN + more, "", plc, base="probe-z.toml")
    out = run_nc(DOWN + more, "", plc, f"plc:after_end_ms={AFTER_MS}", base="probe-z.toml")
    assert plain.alarms == out.alarms == alarms
    end_ns = plain.facts.end_ns
    assert out.facts.end_ns == end_ns
    assert out.facts.sim_ns - end_ns >= AFTER_MS * MS
    before, after = rows_until(plain, end_ns), rows_until(out, end_ns)
    assert list(before) == list(after)
    assert len(before["time_ns"]) > 10
    for name, values in before.items():
        assert np.array_equal(values, after[name], equal_nan=values.dtype.kind == "f"), name
    times = out.column("time_ns")
    assert len(times[times > end_ns]) >= AFTER_MS - 1
    assert set(np.diff(times)) == {MS}
    # Nobody asks for anything any more, and the axis stands
    late = times > end_ns + 100 * MS
    assert np.ptp(out.column("Z.set_mm")[late]) == 0.0
    assert np.ptp(out.column("Z.truth_mm")[late]) < 1e-3
    assert out.facts.axes["Z"].states[-1].state == "OPERATION_ENABLED"
