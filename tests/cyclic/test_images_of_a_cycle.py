"""Images that are swapped once per cycle: what is sent, what counts, and what is forgotten."""

from collections.abc import Mapping

import pytest

from axisrig.kernel.drives.cyclic.carrier import CyclicCarrier, CyclicStart, ImagePort
from axisrig.kernel.errors import Alarm


@pytest.fixture
def segment() -> tuple[dict[str, ImagePort], CyclicCarrier, list[Mapping[str, bytes | None]]]:
    ports, sent = {"X": ImagePort(), "Y": ImagePort()}, list[Mapping[str, bytes | None]]()
    return ports, CyclicCarrier("bus", ports, sent.append), sent


def test_each_drive_has_its_own_outputs_and_they_are_sent_once(
    segment: tuple[dict[str, ImagePort], CyclicCarrier, list[Mapping[str, bytes | None]]],
) -> None:
    ports, carrier, sent = segment
    ports["X"].outputs = b"\1"
    carrier.begin_cycle()
    ports["Y"].outputs = b"\2"
    carrier.begin_cycle()
    carrier.begin_cycle()
    assert sent == [{"X": b"\1", "Y": None}, {"X": None, "Y": b"\2"}, {"X": None, "Y": None}]


def test_a_segment_is_never_late_and_reports_nothing_by_itself(
    segment: tuple[dict[str, ImagePort], CyclicCarrier, list[Mapping[str, bytes | None]]],
) -> None:
    _, carrier, _ = segment
    assert (carrier.holds_back, carrier.check()) == (False, None)
    assert (carrier.late().id, carrier.late().values) == (900031, {"segment": "bus"})


def test_an_image_counts_for_its_cycle_and_an_empty_one_is_none() -> None:
    port = ImagePort()
    counted = []
    for image in (b"", b"\0", b"\7"):
        port.receive(image)
        counted.append(port.inputs)
        port.begin_cycle()
        counted.append(port.inputs)
    assert counted == [None, None, b"\0", None, b"\7", None]


def test_the_start_of_a_drive_with_images_alone_is_over_at_once() -> None:
    ended: list[Alarm | None] = []
    CyclicStart().begin(ended.append)
    assert ended == [None]
