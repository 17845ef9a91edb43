"""The process image of a segment: where the cyclic values of each drive are in the frame.

One LRW datagram carries the outputs of all drives, then their inputs, then for each a byte that
shows a full mailbox (status of SyncManager 1), as masters map it, then the registers of slaves
without a drive.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from axisrig.kernel.drives.ethercat.settings import Pdo, RegisterInputs, SlaveSettings
from axisrig.kernel.drives.mapped import BitCodec, MappedObject

LOGICAL: Final = 0x10000
"""Logical address of the first byte."""
WORKING_COUNTER: Final = 3
"""What each drive adds to the counter of a LRW: 1 for its inputs, 2 for its outputs."""
INPUTS_COUNTER: Final = 1
"""What a slave adds that has inputs alone."""

_FORMAT = {(8, False): "B", (8, True): "b", (16, False): "H", (16, True): "h",
           (32, False): "I", (32, True): "i", (64, False): "Q", (64, True): "q"}  # fmt: skip


def objects_of(pdos: Sequence[Pdo]) -> tuple[MappedObject, ...]:
    """Return the objects of some PDOs in a row."""
    return tuple(mapped for pdo in pdos for mapped in pdo.objects)


def codec_of(objects: tuple[MappedObject, ...]) -> Any:
    """Return the codec of objects in a row: little endian, no padding; a `struct.Struct`."""
    formats = [_FORMAT.get((o.bits, o.signed)) for o in objects]
    if None in formats:
        return BitCodec(objects)
    return struct.Struct("<" + "".join(str(each) for each in formats))


def bytes_of(pdos: Sequence[Pdo]) -> int:
    """Return how many bytes some PDOs take in an image."""
    return -(-sum(mapped.bits for mapped in objects_of(pdos)) // 8)


@dataclass(frozen=True)
class Place:
    """Where the values of one drive are, counted from the begin of the image."""

    outputs: int
    output_bytes: int
    inputs: int
    input_bytes: int
    mailbox: int


class Image:
    """The places of all drives of a segment. size: in bytes. registers: begins of `others`."""

    def __init__(
        self, slaves: Sequence[SlaveSettings], others: Sequence[RegisterInputs] = ()
    ) -> None:
        outputs = [bytes_of(slave.outputs) for slave in slaves]
        inputs = [bytes_of(slave.inputs) for slave in slaves]
        out_at, in_at = 0, sum(outputs)
        boxes_at = in_at + sum(inputs)
        self.places: list[Place] = []
        for number, (out_bytes, in_bytes) in enumerate(zip(outputs, inputs, strict=True)):
            self.places.append(Place(out_at, out_bytes, in_at, in_bytes, boxes_at + number))
            out_at, in_at = out_at + out_bytes, in_at + in_bytes
        self.size = boxes_at + len(slaves)
        self.registers: list[int] = []
        for other in others:
            self.registers.append(self.size)
            self.size += other.size
        self.counter = WORKING_COUNTER * len(slaves) + INPUTS_COUNTER * len(others)
