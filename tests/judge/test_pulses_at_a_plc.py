"""Short pulses of a probe at a PLC: a value is known where each way of the edges has a signal."""

from dataclasses import replace

import pytest
from tests.judge.test_signal_at_plc import CYCLE_NS, SYNC_NS, TASK, found, left

from axisrig.bench.judge.latch.sources import UNSEEN
from axisrig.kernel.time.clock import MS, US


@pytest.mark.parametrize(
    ("begin_us", "end_us", "known_ns", "is_seen"),
    [
        (12_200, 12_400, 1.0, True),  # on at the exchange at 12.3 ms
        (12_200, 12_400, 99_000.0, True),
        (12_200, 12_350, 200_000.0, False),  # 0.2 ms earlier or later it is not
        (12_250, 12_700, 100_000.0, False),  # 0.1 ms later
        (11_900, 12_350, 100_000.0, False),  # 0.1 ms earlier
        (12_000, 12_600, 200_000.0, True),
    ],
)
def test_a_pulse_gives_a_value_where_it_is_at_an_exchange_however_its_edges_are(
    begin_us: int, end_us: int, known_ns: float, is_seen: bool
) -> None:
    edges = [(begin_us * US, True), (end_us * US, False)]
    observed = left(edges, 12 * MS + CYCLE_NS, 12 * MS + SYNC_NS, known_ns=known_ns)
    for one in found(observed):
        if is_seen:
            assert one.value == pytest.approx(0.0, abs=1e-9)
            assert one.uncertainty == 0.0
        else:
            assert (one.value, one.note) == (None, UNSEEN)


@pytest.mark.parametrize(
    ("source", "jitter_um"),
    [
        ("PLC", 0.0),  # the SYNC of a cycle does not jitter
        ("PLC_FIRST_EVENT", 0.0),
        ("PLC_EXT_LATCH_CONTROL", 0.0),
        ("PLC_TIMESTAMP", 20.0),  # 10 mm/s in 2 ms
    ],
)
def test_the_jitter_of_a_stamp_is_in_doubt_where_the_stamp_gives_the_value(
    source: str, jitter_um: float
) -> None:
    edges = [(10_400 * US, True)]
    sure, unsure = (
        found(
            left(edges, 12 * MS + CYCLE_NS, 12 * MS + SYNC_NS, source=source,
                 task=replace(TASK, stamp_jitter_ns=jitter_ns))
        )[1]
        for jitter_ns in (0, 2 * MS)
    )  # fmt: skip
    assert unsure.value == sure.value
    assert unsure.uncertainty - sure.uncertainty == pytest.approx(jitter_um, rel=1e-6)
    assert ("jitter of the stamp" in unsure.note) is bool(jitter_um)
    assert "jitter" not in sure.note
