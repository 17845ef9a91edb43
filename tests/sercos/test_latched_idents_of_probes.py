"""Which ident shows what each edge of each of two probes has latched, by hand.

S-0-0169 selects 1 positive, 1 negative, 2 positive, 2 negative by its bits 0 to 3; S-0-0409 to 412
show them in this order, S-0-0179 as bits, S-0-0130 to 133 where it was (SERCOS IDN).
"""

import pytest
from tests.drive_node.conftest import FakeAxis, FakeSignal
from tests.sercos.test_sercos_faults_by_hand import Hand

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.drive.sercos.profiles import make_profile
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

LATCHED = ("S-0-0409", "S-0-0410", "S-0-0411", "S-0-0412")
PLACES = ("S-0-0130", "S-0-0131", "S-0-0132", "S-0-0133")
LEVELS = ("S-0-0401", "S-0-0402")
ENABLES = ("S-0-0405", "S-0-0406")
ON, OFF = b"\x01\x00", b"\x00\x00"
EDGES_MS = (4, 8, 6, 10)
"""In the order of the idents: each probe is on between its two."""
INCREMENTS_PER_MS = (1 << 20) // 10
"""At 1 m/s, 10 mm a turn."""


class TwoProbes(Hand):
    """A drive with both probes, whose axis moves at 1 m/s."""

    def __init__(self) -> None:
        self.clock = new_scheduler()
        axis = FakeAxis(motion=lambda time_s: time_s)
        edges = ((EDGES_MS[0], EDGES_MS[1]), (EDGES_MS[2], EDGES_MS[3]))
        first, second = (FakeSignal(axis, tuple(ms * MS for ms in pair)) for pair in edges)
        self.drive = SercosDrive(
            "Z", self.clock, axis, (first, second),
            make_profile("two_probes", DriveProfile(lead_um=10_000), "rotary", 1 << 20),
        )  # fmt: skip
        self.start()

    def begin(self, select: int) -> None:
        """Begin the cycle with these edges, both probes enabled."""
        for ident, data in (("S-0-0169", bytes((select, 0))), ("S-0-0170", b"\x03\x00")):
            assert self.written(ident, data) is None
        for ident in ENABLES:
            assert self.written(ident, ON) is None

    def until(self, ms: int) -> "TwoProbes":
        while self.clock.now_ns < ms * MS:
            self.cycle(0)
        return self

    def read(self, idents: tuple[str, ...]) -> tuple[int, ...]:
        return tuple(self.number(ident) for ident in idents)


@pytest.mark.parametrize("selected", range(1, 16))
def test_each_edge_of_each_probe_is_shown_by_its_own_ident(selected: int) -> None:
    """Every choice of edges."""
    hand = TwoProbes()
    hand.begin(selected)
    hand.until(2)
    assert hand.read(LATCHED) == (0, 0, 0, 0)
    hand.until(14)
    assert hand.read(LATCHED) == tuple(selected >> k & 1 for k in range(4))
    assert hand.number("S-0-0179") == selected


@pytest.mark.parametrize("edge", range(4))
def test_an_edge_is_shown_from_when_it_comes_until_its_probe_is_no_longer_enabled(
    edge: int,
) -> None:
    """The enable bit of the other probe changes nothing."""
    hand = TwoProbes()
    hand.begin(1 << edge)
    assert hand.until(EDGES_MS[edge] - 1).number(LATCHED[edge]) == 0
    assert hand.until(EDGES_MS[edge] + 2).number(LATCHED[edge]) == 1
    mine, other = ENABLES[edge // 2], ENABLES[1 - edge // 2]
    hand.written(other, OFF)
    hand.cycle(0, 2)
    assert hand.number(LATCHED[edge]) == 1
    hand.written(mine, OFF)
    hand.cycle(0, 2)
    assert hand.read(LATCHED) == (0, 0, 0, 0)
    assert hand.number("S-0-0179") == 0


@pytest.mark.parametrize("edge", range(4))
def test_each_edge_has_its_own_place(edge: int) -> None:
    """1 mm a ms, to the increments of the delay of an input of some us."""
    hand = TwoProbes()
    hand.begin(0b1111)
    hand.until(14)
    expected = EDGES_MS[edge] * INCREMENTS_PER_MS
    assert hand.number(PLACES[edge]) == pytest.approx(expected, abs=INCREMENTS_PER_MS // 20)


@pytest.mark.parametrize(
    ("ms", "levels"), [(2, (0, 0)), (5, (1, 0)), (7, (1, 1)), (9, (0, 1)), (12, (0, 0))]
)
def test_each_probe_has_its_own_level(ms: int, levels: tuple[int, int]) -> None:
    """Whether or not the cycle of probing runs."""
    assert TwoProbes().until(ms).read(LEVELS) == levels
