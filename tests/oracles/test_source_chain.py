"""The chain from an edge to the NC cycle against a walk in steps of a microsecond."""

from dataclasses import replace

import pytest

from axisrig.bench.oracles.sources.chain import Chain, Edges, Grid, Stamps

US, MS = 1_000, 1_000_000
CHAINS = [
    Chain(Grid(2 * MS, 300 * US), Grid(2 * MS, 300 * US), Grid(MS, 600 * US)),
    Chain(Grid(500 * US), Grid(1300 * US, 100 * US), Grid(MS, 600 * US), filter_ns=250 * US),
    Chain(Grid(10 * MS, 7 * US), Grid(4 * MS), Grid(MS, 0), busy_ns=9 * MS),
    Chain(Grid(MS), Grid(MS), Grid(MS)),
]


def _walked(chain: Chain, edges: Edges, *, is_held: bool = False) -> tuple[int, ...] | None:
    """Go on by a microsecond until the CNC sees the level; instants are whole microseconds here.

    Each participant has what it took last: terminal, PLC, CNC.
    """
    pending = [(edge_ns + chain.filter_ns, level) for edge_ns, level in edges]
    image = output = level = False
    image_ns = plc_ns = plc_free_ns = 0
    written: list[tuple[int, int, int, bool]] = []
    for now_ns in range(0, 60 * MS, US):
        for place, (due_ns, after) in enumerate(pending):
            if due_ns == now_ns:
                later_ns = [at_ns for at_ns, _ in edges[place + 1 :]]
                lasts = not later_ns or later_ns[0] >= edges[place][0] + chain.filter_ns
                level = after if lasts else level
        if (now_ns - chain.terminal.offset_ns) % chain.terminal.period_ns == 0:
            image, image_ns = level, now_ns
        is_plc = now_ns >= chain.plc.offset_ns
        is_plc = is_plc and (now_ns - chain.plc.offset_ns) % chain.plc.period_ns == 0
        if (now_ns - chain.cnc.offset_ns) % chain.cnc.period_ns == 0:
            taken = [each for each in written if each[0] < now_ns]
            if taken and taken[-1][3]:
                return taken[-1][1], taken[-1][2], now_ns
        if is_plc and now_ns >= plc_free_ns:
            plc_free_ns, plc_ns = now_ns + chain.busy_ns, now_ns
            was, output = output, image or (is_held and output)
            seen = written[-1][1:3] if is_held and was else (image_ns, plc_ns)
            written.append((now_ns + chain.busy_ns, *seen, output))
    return None


@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("edge_us", [1, 999, 1000, 1300, 3050, 5300, 7777])
def test_the_closed_form_is_the_walk(chain: Chain, edge_us: int) -> None:
    edges = [(edge_us * US, True)]
    found = chain.seen(edges)
    assert found is not None
    assert tuple(found) == _walked(chain, edges)


@pytest.mark.parametrize("is_held", [False, True])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("step_us", [37, 240, 251, 700, 1900])
def test_a_level_that_comes_and_goes_is_seen_where_somebody_looks(
    chain: Chain, step_us: int, is_held: bool
) -> None:
    """A probe that bounces seven times: on, off, ... on; and one that stays off in the end."""
    edges = [((1003 + n * step_us) * US, n % 2 == 0) for n in range(7)]
    for course in (edges, edges[:6], edges[:2]):
        found = replace(chain, is_held=is_held).seen(course)
        walked = _walked(chain, course, is_held=is_held)
        assert (None if found is None else tuple(found)) == walked


def test_a_node_is_read_with_the_telegram_that_came() -> None:
    """SYNC each 2 ms, sampled 48 us later; the telegram 200 us after that, then 900 and 300 us."""
    ends_ns = [n * 2 * MS + {3: 948, 4: 348}.get(n, 248) * US for n in range(9)]
    cnc, plc = Grid(2 * MS, 600 * US), Grid(333 * US, 300 * US)
    chain = Chain(Grid(2 * MS, 48 * US), plc, cnc, late_ns=10 * US, telegrams_ns=ends_ns)
    # Last cycles of the PLC before 4.6 ms and 8.6 ms: 300 + 12 x 333, 300 + 24 x 333
    for n, plc_us, cnc_us in ((2, 4296, 4600), (3, 8292, 8600)):
        edge_ns = n * 2 * MS + 48 * US  # at the SYNC: it counts
        assert chain.seen([(edge_ns, True)]) == (edge_ns, plc_us * US, cnc_us * US)
    assert chain.seen([(17 * MS, True)]) is None  # no telegram any more


def test_a_node_samples_at_the_syncs_that_came() -> None:
    """One of them waited for the bus until 155 us; an edge at 106 us is in its telegram."""
    syncs_ns = [n * MS + {2: 155}.get(n, 48) * US for n in range(9)]
    ends_ns = [sync_ns + 180 * US for sync_ns in syncs_ns]
    chain = Chain(Grid(MS, 48 * US), Grid(MS, 550 * US), Grid(MS, 600 * US), telegrams_ns=ends_ns)
    edges = [(2 * MS + 106 * US, True)]
    assert chain.seen(edges) == (3 * MS + 48 * US, 3 * MS + 550 * US, 3 * MS + 600 * US)
    as_they_came = replace(chain, syncs_ns=syncs_ns).seen(edges)
    assert as_they_came == (2 * MS + 155 * US, 2 * MS + 550 * US, 2 * MS + 600 * US)


@pytest.mark.parametrize("drift_ppm", [-100.0, 0.0, 37.0])
def test_a_stamp_is_believed_where_the_clock_is_known(drift_ppm: float) -> None:
    stamps = Stamps(1, 55, drift_ppm, 55, drift_ppm)
    assert stamps.believed_ns(1_234_570_890) == pytest.approx(1_234_570_890, abs=1)
    assert Stamps(1000).believed_ns(1_234_570_890) == 1_234_570_000


@pytest.mark.parametrize("keeps_last", [False, True])
def test_of_several_edges_in_an_exchange_the_terminal_keeps_the_stamp_of_one(
    keeps_last: bool,
) -> None:
    """Exchange each ms; filter 3 us. Rising at 1.2, 1.4 and 2.5 ms, off between."""
    edges = [(1200, True), (1300, False), (1400, True), (1600, False), (2500, True)]
    course = [(at_us * US, level) for at_us, level in edges]
    chain = Chain(Grid(MS), Grid(MS), Grid(MS), filter_ns=3 * US)
    first = chain.stamped_ns(course, 2 * MS, keeps_last=keeps_last)
    assert first == (1403 if keeps_last else 1203) * US
    assert chain.stamped_ns(course, 3 * MS, keeps_last=keeps_last) == 2503 * US
