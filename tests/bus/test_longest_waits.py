"""The longest wait of each identifier that the load of a bus reports."""

import pytest

from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.bus.can.load import LoadMeter
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize(("since_ms", "worst_ms"), [(9, 5), (5, 5), (2, 8)])
def test_the_longest_wait_is_that_of_what_was_sent_or_waits_still(
    since_ms: int, worst_ms: int
) -> None:
    meter = LoadMeter(1_000_000)
    meter.count_frame(0x100, False, 5 * MS)
    meter.count_frame(0x100, True, 0)
    waiting = [(data_frame(0x100, b""), since_ms * MS), (data_frame(0x050, b""), 7 * MS)]
    found = meter.figures(10 * MS, waiting).worst_delay_ns
    assert found == {0x050: 3 * MS, 0x100: worst_ms * MS, 0x8000_0100: 0}
    assert list(found) == [0x050, 0x100, 0x8000_0100]
