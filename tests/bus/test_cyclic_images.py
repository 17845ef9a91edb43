"""Images that are swapped in each cycle, and what faults make of them (`bench.bus.cyclic`)."""

from collections.abc import Mapping

from axisrig.bench.bus.cyclic.segment import CyclicSegment, Instants
from axisrig.bench.bus.hits import Hits
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

IMAGES = Mapping[str, bytes | None]


class Counting:
    """A drive whose inputs are the number of its samples; it keeps each image that it gets."""

    def __init__(self) -> None:
        self.inputs = b""
        self.samples = 0
        self.taken: list[bytes | None] = []

    def sample(self) -> None:
        self.samples += 1

    def exchange(self, outputs: bytes | None) -> bytes:
        self.taken.append(outputs)
        self.inputs = bytes([self.samples])
        return self.inputs

    def cycle(self) -> None:
        pass


class Line:
    """Two drives, X with the faults; what came of each in 10 cycles."""

    def __init__(self, **faults: list[Hits]) -> None:
        clock = new_scheduler()
        self.nodes = {"X": Counting(), "Z": Counting()}
        self.came: dict[str, list[bytes]] = {"X": [], "Z": []}
        segment = CyclicSegment(
            clock, self.nodes, Instants(MS), lambda axis, inputs: self.came[axis].append(inputs)
        )
        for kind, hits in faults.items():
            getattr(segment, kind)["X"] += [one.falls for one in hits]
        for k in range(10):
            images: IMAGES = {"X": bytes([k]), "Z": bytes([100 + k])}
            segment.begin(images)
            clock.run_until((k + 1) * MS)


SENT = [bytes([k + 1]) for k in range(10)]


def test_an_image_that_is_late_is_that_of_the_exchange_before() -> None:
    """In the fifth to the seventh exchange; before the first one there is none."""
    line = Line(late=[Hits(skip=4, count=3)])
    assert line.came == {"X": [*SENT[:4], *SENT[3:6], *SENT[7:]], "Z": SENT}
    assert Line(late=[Hits(count=1)]).came["X"] == [b"", *SENT[1:]]


def test_each_fault_counts_the_images_of_its_drive_by_itself() -> None:
    """Two that begin together are over together, whichever is asked first."""
    line = Line(lost=[Hits(skip=2, count=2), Hits(skip=3, count=3)], missed=[Hits(skip=8, count=1)])
    lost = range(2, 6)
    expected = [None if k in lost else bytes([k]) for k in range(10)]
    assert line.nodes["X"].taken == expected
    assert line.nodes["Z"].taken == [bytes([100 + k]) for k in range(10)]
    assert line.came["X"] == [*SENT[:8], b"", SENT[9]]


def test_a_fault_counts_the_images_that_are_lost_for_another_reason() -> None:
    """Of the first three exchanges each image is lost anyway; the fault has its third one then."""
    clock = new_scheduler()
    nodes = {"X": Counting(), "Z": Counting()}
    segment = CyclicSegment(clock, nodes, Instants(MS), lambda _axis, _inputs: None)
    segment.loses = lambda axis: axis == "X" and segment.exchanges <= 3
    for axis in nodes:
        segment.lost[axis].append(Hits(skip=2, count=3).falls)
    for k in range(8):
        segment.begin({axis: bytes([k]) for axis in nodes})
        clock.run_until((k + 1) * MS)
    lost = {"X": {0, 1, 2, 3, 4}, "Z": {2, 3, 4}}
    for axis, node in nodes.items():
        assert node.taken == [None if k in lost[axis] else bytes([k]) for k in range(8)]
