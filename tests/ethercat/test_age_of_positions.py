"""When the control assumes that an actual position was sampled, without a line of slaves."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.cyclic.family import CyclicSegments
from axisrig.bench.machine.ethercat.family import EthercatLines
from axisrig.bench.machine.families import Installed
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.frames import Way
from axisrig.kernel.drives.ethercat.master import NEVER

PERIOD_NS, SHIFT_NS = 1_000_000, 300_000
SYNC_NS = 8_000_000
RIG = Path(__file__).parents[2] / "testplans" / "rigs" / "fixed-stop-z-profidrive.toml"


def of_images(input_us: int) -> CyclicSegments:
    """The segments of a rig of PROFIdrive with this T_I, without their drives."""
    text = parse_assignment(f"bus:bus.input_us={input_us}")
    settings = read_settings(*read_rig(RIG), [(text, as_written)])
    segments = CyclicSegments.__new__(CyclicSegments)
    bench: Any = SimpleNamespace(settings=settings)
    segments._bench = bench
    return segments


def sampled_ns(sent_ns: int, *, has_clocks: bool = True, **sample_ns: int) -> int:
    line = SimpleNamespace(
        name="line", period_ns=PERIOD_NS, shift_ns=SHIFT_NS, has_clocks=has_clocks,
        sample_ns=sample_ns,
    )  # fmt: skip
    master: Any = SimpleNamespace(line=line, sent_ns=sent_ns, falls=[], slaves=[])
    return EthercatCarrier(master).sampled_ns("X")


@pytest.mark.parametrize(
    ("sent_ns", "assumed_ns"),
    [
        (5_000_000, 4_300_000),
        (5_299_999, 4_300_000),
        (5_300_000, 4_300_000),  # what is sampled as the frame passes is in the next one
        (5_300_001, 5_300_000),
        (5_999_999, 5_300_000),
    ],
)
def test_with_sync0_it_is_the_last_one_before_the_frame(sent_ns: int, assumed_ns: int) -> None:
    assert sampled_ns(sent_ns) == assumed_ns


def test_a_drive_that_samples_later_has_the_place_of_its_own_instant() -> None:
    """125 us after SYNC0; another axis of the line has no part in it."""
    assert sampled_ns(5_400_000, X=125_000) == 4_425_000
    assert sampled_ns(5_425_000, X=125_000) == 4_425_000
    assert sampled_ns(5_426_000, X=125_000) == 5_425_000
    assert sampled_ns(5_400_000, Z=125_000) == 5_300_000


def test_without_clocks_it_is_the_frame_before() -> None:
    """Outputs and inputs of one frame: what it brings was put there by the one a period ago."""
    assert sampled_ns(5_400_000, has_clocks=False) == 4_400_000
    assert sampled_ns(400_000, has_clocks=False) == 0
    assert sampled_ns(NEVER) == 0


def test_a_frame_that_waited_is_later_than_the_shortest_whatever_its_length() -> None:
    """A byte takes 80 ns on the wire; 12 bytes are beside those of the frame, 60 at least."""
    way = Way()
    assert way.later_ns(0, 900 + 72 * 80, 60) == 0
    assert way.later_ns(5000, 5000 + 900 + 212 * 80, 200) == 0
    assert way.later_ns(9000, 9000 + 1050 + 72 * 80, 20) == 150
    assert way.later_ns(0, 850 + 72 * 80, 60) == 0
    assert way.later_ns(0, 900 + 72 * 80, 60) == 50


@pytest.mark.parametrize(("heard_ns", "assumed_ns"), [(8_155_000, 8_155_000), (7_048_000, SYNC_NS)])
def test_a_sync_that_a_drive_has_not_heard_does_not_leave_it_that_of_the_one_before(
    heard_ns: int, assumed_ns: int
) -> None:
    drives: Any = {"X": SimpleNamespace(sync_ns=heard_ns)}
    part = Installed()
    part.drives = drives
    assert part.sampled_ns("X", SYNC_NS) == assumed_ns
    assert part.sampled_ns("Y", SYNC_NS) == SYNC_NS


# --- which line an axis is on


def of_lines(**axes: str) -> Any:
    """The lines `a` and `b` of a machine, with axes on them. Only the master of `a` watches."""
    lines = EthercatLines.__new__(EthercatLines)
    rig = SimpleNamespace(axis={axis: SimpleNamespace(segment=name) for axis, name in axes.items()})
    watched = {"a": (True, 70, 3), "b": (False, 90, 8)}
    found: Any = {
        name: SimpleNamespace(
            carrier=SimpleNamespace(
                sampled_ns=lambda axis, name=name: {"aX": 11, "bY": 22}[name + axis]
            ),
            master=SimpleNamespace(
                clocks_off_ns=off_ns,
                line=SimpleNamespace(reads_differences=watches, clock_limit_ns=limit_ns),
            ),
        )
        for name, (watches, limit_ns, off_ns) in watched.items()
    }
    bench: Any = SimpleNamespace(settings=SimpleNamespace(rig=rig))
    lines.lines, lines._bench = found, bench
    return lines


@pytest.mark.interpreted
def test_an_axis_has_the_instant_and_the_clocks_of_its_own_line() -> None:
    """A limit only where the master reads how far the clocks are apart."""
    lines = of_lines(X="a", Y="b")
    assert [lines.sampled_ns(axis, SYNC_NS) for axis in "XY"] == [11, 22]
    assert [lines.clocks_off_ns(axis) for axis in "XY"] == [3, 8]
    assert [lines.clock_limit_ns(axis) for axis in "XY"] == [70, None]


@pytest.mark.parametrize(
    ("input_us", "sync_ns"), [(100, SYNC_NS), (250, SYNC_NS), (250, 12_345_678)]
)
def test_on_a_cyclic_segment_it_is_t_i_before_the_cycle(input_us: int, sync_ns: int) -> None:
    assert of_images(input_us).sampled_ns("Z", sync_ns) == sync_ns - input_us * 1000
