"""The chain from an edge to the NC cycle against a walk in steps of a microsecond."""

import pytest

from axisrig.bench.oracles.sources.chain import Chain, Grid, believed_ns

US, MS = 1_000, 1_000_000
CHAINS = [
    Chain(Grid(2 * MS, 300 * US), Grid(2 * MS, 300 * US), Grid(MS, 600 * US)),
    Chain(Grid(500 * US), Grid(1300 * US, 100 * US), Grid(MS, 600 * US), filter_ns=250 * US),
    Chain(Grid(10 * MS, 7 * US), Grid(4 * MS), Grid(MS, 0), busy_ns=9 * MS),
    Chain(Grid(MS), Grid(MS), Grid(MS)),
]


def _walked(chain: Chain, edge_ns: int) -> tuple[int, int, int]:
    """Go on by a microsecond until each has seen it; instants are whole microseconds here."""
    now_ns, plc_free_ns = 0, 0
    exchange_ns = plc_ns = None
    while True:
        is_exchange = (now_ns - chain.terminal.offset_ns) % chain.terminal.period_ns == 0
        if exchange_ns is None and is_exchange and now_ns >= edge_ns + chain.filter_ns:
            exchange_ns = now_ns
        is_plc = now_ns >= chain.plc.offset_ns
        is_plc = is_plc and (now_ns - chain.plc.offset_ns) % chain.plc.period_ns == 0
        if is_plc and now_ns >= plc_free_ns:
            plc_free_ns = now_ns + chain.busy_ns
            if plc_ns is None and exchange_ns is not None:
                plc_ns = now_ns
        is_cnc = (now_ns - chain.cnc.offset_ns) % chain.cnc.period_ns == 0
        if plc_ns is not None and is_cnc and now_ns > plc_ns + chain.busy_ns:
            assert exchange_ns is not None
            return exchange_ns, plc_ns, now_ns
        now_ns += US


@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("edge_us", [1, 999, 1000, 1300, 3050, 5300, 7777])
def test_the_closed_form_is_the_walk(chain: Chain, edge_us: int) -> None:
    assert tuple(chain.seen(edge_us * US)) == _walked(chain, edge_us * US)


@pytest.mark.parametrize("drift_ppm", [-100.0, 0.0, 37.0])
def test_a_stamp_is_believed_where_the_clock_is_known(drift_ppm: float) -> None:
    chain = Chain(Grid(MS), Grid(MS), Grid(MS), filter_ns=3_000)
    stamp = chain.stamped(1_234_567_890, 1, 55, drift_ppm)
    assert believed_ns(stamp, 55, drift_ppm) == pytest.approx(1_234_570_890, abs=1)
