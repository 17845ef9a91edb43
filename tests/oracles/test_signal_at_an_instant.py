"""Edges, telegrams and cycles of a source chain at the very instant of another one.

What is at or before an exchange is in its image, a telegram that ends in a cycle of the PLC is in
it, and the CNC takes what was written strictly before its cycle (docs/measuring-sources.md).
"""

from dataclasses import replace

import pytest

from axisrig.bench.oracles.sources.chain import Chain, Edges, Grid, Seen, Stamps, lasting

US, MS = 1_000, 1_000_000


@pytest.mark.parametrize(
    ("time_ns", "from_on", "after", "before"),
    [
        (12, 13, 13, 3),
        (13, 13, 23, 3),
        (14, 23, 23, 13),
        (0, 3, 3, -7),
        (3, 3, 13, -7),
        (-7, -7, 3, -17),
        (-8, -7, -7, -17),
        (22, 23, 23, 13),
    ],
)
def test_the_instants_of_a_grid(time_ns: int, from_on: int, after: int, before: int) -> None:
    """10 n + 3: the first at or after a time, the first after it, the last before it."""
    grid = Grid(10, 3)
    assert grid.from_on(time_ns) == from_on
    assert grid.after(time_ns) == after
    assert grid.before(time_ns) == before
    assert Grid(10, 13).from_on(time_ns) == from_on  # an offset of more than a period


# Stamps of a terminal

MINE = Chain(Grid(MS), Grid(MS), Grid(MS))


def edges(*at_ns: int, first: bool = True) -> Edges:
    """Alternating edges from the first level on."""
    return [(ns, first is (n % 2 == 0)) for n, ns in enumerate(at_ns)]


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize(
    ("times_ns", "image_ns", "kept_ns", "first_ns"),
    [
        # One edge: at the exchange, a nanosecond before, and with one after it
        ((2 * MS,), 2 * MS, 2 * MS, 2 * MS),
        ((2 * MS - 1,), 2 * MS, 2 * MS - 1, 2 * MS - 1),
        ((MS + 1, 2 * MS, 2 * MS + 1), 2 * MS, MS + 1, MS + 1),
        # The last one is at the exchange itself
        ((1200 * US, 1300 * US, 2 * MS), 2 * MS, 2 * MS, 1200 * US),
        ((1200 * US, 1300 * US, 2 * MS - 1), 2 * MS, 2 * MS - 1, 1200 * US),
        ((1200 * US, 1300 * US, 2 * MS + 1), 2 * MS, 1200 * US, 1200 * US),
        # One at the exchange before belongs to that one
        ((MS, MS + 1, 1200 * US), 2 * MS, 1200 * US, 1200 * US),
        ((MS, MS + 1, 1200 * US), MS, MS, MS),
        ((MS + 1, MS + 2, 1200 * US), 2 * MS, 1200 * US, MS + 1),
        ((MS - 1, MS + 1, 2 * MS), 2 * MS, 2 * MS, 2 * MS),
        # Nothing new in the image: the stamp of an earlier exchange stays
        ((1200 * US, 1300 * US, 1400 * US), 5 * MS, 1400 * US, 1200 * US),
    ],
)
def test_an_edge_at_an_exchange_has_the_stamp_of_that_exchange(
    times_ns: tuple[int, ...], image_ns: int, kept_ns: int, first_ns: int, first: bool
) -> None:
    """Rising or falling; the last or the first of those that one exchange brings."""
    course = edges(*times_ns, first=first)
    assert MINE.stamped_ns(course, image_ns, keeps_last=True) == kept_ns
    assert MINE.stamped_ns(course, image_ns, keeps_last=False) == first_ns


@pytest.mark.parametrize("offset_us", [0, 300, 999])
@pytest.mark.parametrize("filter_us", [0, 3, 700])
def test_what_a_filter_lets_through_at_an_exchange_is_stamped_then(
    filter_us: int, offset_us: int
) -> None:
    """The stamp is that of the level behind the filter, on the grid of the terminal."""
    image_ns = 5 * MS + offset_us * US
    chain = replace(MINE, terminal=Grid(MS, offset_us * US), filter_ns=filter_us * US)
    for through_ns in (image_ns, image_ns - MS):
        course = edges(through_ns - filter_us * US)
        for keeps_last in (True, False):
            assert chain.stamped_ns(course, image_ns, keeps_last=keeps_last) == through_ns


# Who looks when


@pytest.mark.parametrize("is_held", [False, True])
@pytest.mark.parametrize(
    ("edge_ns", "exchange_ns", "plc_ns", "cnc_ns"),
    [
        (2 * MS, 2 * MS, 2 * MS, 3 * MS),  # all three at once: the CNC has it a cycle later
        (2 * MS - 1, 2 * MS, 2 * MS, 3 * MS),
        (2 * MS + 1, 3 * MS, 3 * MS, 4 * MS),
    ],
)
def test_of_three_equal_cycles_the_cnc_is_one_behind(
    edge_ns: int, exchange_ns: int, plc_ns: int, cnc_ns: int, is_held: bool
) -> None:
    chain = replace(MINE, is_held=is_held)
    assert chain.seen(edges(edge_ns)) == Seen(exchange_ns, plc_ns, cnc_ns)
    assert chain.seen(edges(edge_ns, first=False)) == Seen(exchange_ns, plc_ns, cnc_ns)


@pytest.mark.parametrize(
    ("busy_us", "plc_ns", "cnc_ns"),
    [
        (0, 3 * MS, 3600 * US),
        (599, 3 * MS, 3600 * US),
        (600, 3 * MS, 4600 * US),  # written in the cycle of the CNC: that one does not have it
        (1000, 3 * MS, 4600 * US),
        (1001, 4 * MS, 5600 * US),  # of two periods: 0, 2, 4 ms; written at 5001 us
        (2000, 4 * MS, 6600 * US),
        (2001, 3 * MS, 5600 * US),  # of three: 0, 3, 6 ms
    ],
)
def test_a_plc_that_is_longer_busy_than_its_period_leaves_cycles_out(
    busy_us: int, plc_ns: int, cnc_ns: int
) -> None:
    """An edge at 2.5 ms; exchanges and PLC each ms, the CNC 600 us later."""
    chain = Chain(Grid(MS), Grid(MS), Grid(MS, 600 * US), busy_ns=busy_us * US)
    found = chain.seen(edges(2500 * US))
    assert found == Seen(plc_ns, plc_ns, cnc_ns)


@pytest.mark.parametrize(("late_ns", "exchange_ns"), [(0, 4), (1, 4), (2, 2), (3, 2), (4, 0)])
def test_an_image_is_with_the_plc_when_its_telegram_has_come(
    late_ns: int, exchange_ns: int
) -> None:
    """Exchanges at 0, 2, 4 ns, the PLC at 5 ns: at the instant of its arrival it has it."""
    chain = Chain(Grid(2), Grid(5), Grid(5), late_ns=late_ns)
    assert chain.image_ns(5) == exchange_ns


def test_a_level_between_two_looks_of_the_cnc_is_lost_unless_the_plc_holds_it() -> None:
    """PLC each 250 us, CNC each ms: at 1.6 ms it takes what was written at 1.5 ms."""
    chain = Chain(Grid(50 * US), Grid(250 * US), Grid(MS, 600 * US))
    pulse = edges(1640 * US, 1900 * US)
    assert chain.seen(pulse) is None
    held = replace(chain, is_held=True).seen(pulse)
    assert held == Seen(1750 * US, 1750 * US, 2600 * US)
    # If it is written before
    short = edges(1450 * US, 1501 * US)
    assert chain.seen(short) == Seen(1500 * US, 1500 * US, 1600 * US)
    assert replace(chain, busy_ns=99 * US).seen(short) == Seen(1500 * US, 1500 * US, 1600 * US)
    assert replace(chain, busy_ns=100 * US).seen(short) is None
    before = edges(1200 * US, 1251 * US)
    assert replace(chain, busy_ns=100 * US).seen(before) == Seen(1250 * US, 1250 * US, 1600 * US)


# A node: the telegrams as they came


NODE = Chain(
    Grid(MS, 48 * US), Grid(MS, 500 * US), Grid(MS, 600 * US),
    telegrams_ns=[n * MS + 248 * US for n in range(9)],
)  # fmt: skip


@pytest.mark.parametrize(
    ("plc_us", "image_us"),
    [
        (3248, 3048),  # the telegram ends in the cycle itself
        (3247, 2048),
        (3249, 3048),
        (248, 48),
        (8248, 8048),
        (99_000, 8048),  # no telegram any more: the last one stays
    ],
)
def test_a_telegram_that_ends_in_a_cycle_of_the_plc_is_in_it(plc_us: int, image_us: int) -> None:
    assert NODE.image_ns(plc_us * US) == image_us * US


def test_before_the_first_telegram_nothing_was_sampled() -> None:
    """Neither the first telegram nor the last one."""
    assert NODE.image_ns(247 * US) < 0
    late = replace(NODE, telegrams_ns=[5 * MS + 248 * US, 6 * MS + 248 * US])
    assert late.image_ns(3 * MS) < 0
    assert late.image_ns(5 * MS + 248 * US) == 5 * MS + 48 * US
    assert late.seen(edges(3 * MS)) == Seen(5 * MS + 48 * US, 5500 * US, 5600 * US)


@pytest.mark.parametrize(
    ("syncs_us", "image_us"),
    [
        ((1048, 2048, 3048), 3048),
        ((1048, 2048, 3247), 3247),
        ((1048, 2048, 3248), 2048),  # a SYNC at the end of the telegram is of the next one
        ((1048, 2048, 3250), 2048),
        ((3100,), 3100),
        ((3300,), 3048),  # none before it is recorded: by the cycle of the node
        ((), 3048),
    ],
)
def test_a_telegram_has_the_sample_of_the_last_sync_before_its_end(
    syncs_us: tuple[int, ...], image_us: int
) -> None:
    """Not before the cycle of the PLC, which may be much later."""
    chain = replace(NODE, syncs_ns=[us * US for us in syncs_us])
    assert chain.image_ns(3248 * US) == image_us * US
    assert chain.image_ns(3900 * US) == image_us * US


# What a filter lets through


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize(
    ("times_ns", "through_ns"),
    [
        ((10,), (15,)),
        ((10, 14), ()),  # shorter than the filter
        ((10, 15), (15, 20)),  # as long as it
        ((10, 14, 16), (21,)),
        ((10, 20, 23), (15,)),  # a gap that is too short is none
        ((10, 20, 25), (15, 25, 30)),
        ((), ()),
    ],
)
def test_a_level_comes_through_when_it_lasts_as_long_as_the_filter(
    times_ns: tuple[int, ...], through_ns: tuple[int, ...], first: bool
) -> None:
    found = lasting(edges(*times_ns, first=first), 5)
    assert [ns for ns, _ in found] == list(through_ns)
    assert [level for _, level in found] == [first is (n % 2 == 0) for n in range(len(found))]
    assert lasting(edges(*times_ns, first=first), 0) == edges(*times_ns, first=first)


# What a stamp is believed to be


@pytest.mark.parametrize(
    ("stamps", "at_ns", "believed_ns"),
    [
        (Stamps(), 1_000_000, 1_000_000),
        (Stamps(resolution_ns=100), 1_000_099, 1_000_000),
        (Stamps(resolution_ns=100), 1_000_100, 1_000_100),
        (Stamps(offset_ns=30), 1_000_000, 1_000_030),
        (Stamps(offset_ns=-30), 1_000_000, 999_970),
        (Stamps(assumed_offset_ns=30), 1_000_000, 999_970),
        (Stamps(offset_ns=40, assumed_offset_ns=30), 1_000_000, 1_000_010),
        (Stamps(100, offset_ns=30), 1_000_080, 1_000_100),  # rounded behind the offset
        (Stamps(drift_ppm=50.0), 2_000_000, 2_000_100),
        (Stamps(drift_ppm=-50.0), 2_000_000, 1_999_900),
        (Stamps(assumed_drift_ppm=1e6), 2_000_000, 1_000_000),  # twice as fast
        (Stamps(assumed_offset_ns=10, assumed_drift_ppm=1e6), 2_000_010, 1_000_000),
        (Stamps(drift_ppm=1e6, assumed_drift_ppm=1e6), 2_000_000, 2_000_000),
        (Stamps(drift_ppm=1e6, offset_ns=7, assumed_offset_ns=7), 2_000_000, 4_000_000),
    ],
)
def test_a_stamp_is_taken_back_by_what_is_assumed_of_the_clock(
    stamps: Stamps, at_ns: int, believed_ns: int
) -> None:
    """The clock shows t + offset + drift t, rounded down; docs/sources/plc-timestamp.md."""
    assert stamps.believed_ns(at_ns) == believed_ns
