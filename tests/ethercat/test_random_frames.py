"""Whatever a master sends: slaves go on, answer, and come to the same end each time."""

import hashlib
import random
import struct

import pytest
from tests.ethercat.line import ACK, INIT, OP, PREOP, SAFEOP, Line, frame, physical

from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.kernel.time.clock import US

PLACES = (
    0x0010, 0x0100, 0x0120, 0x0120, 0x0120, 0x0130, 0x0200, 0x0400, 0x0420, 0x0442, 0x0500, 0x0502,
    0x0504, 0x0508, 0x0600, 0x0610, 0x0620, 0x0800, 0x0808, 0x0810, 0x0818, 0x080E, 0x0900, 0x0910,
    0x0918, 0x0920, 0x0928, 0x092C, 0x0930, 0x0980, 0x0981, 0x0990, 0x09A0, 0x09A4, 0x09A8, 0x09B0,
    0x0F80, 0x0FFE, 0x1000, 0x1080, 0x1800, 0x1C00, 0x2FF8, 0x2FFF, 0x3000, 0xFFFF,
)  # fmt: skip


def any_datagram(draw: random.Random) -> tuple[int, int, bytes]:
    command = draw.randrange(16)
    if command in (10, 11, 12):
        return command, draw.choice((0, 4, 20, 1 << 16)), draw.randbytes(draw.randrange(1, 40))
    size = draw.choice((0, 1, 2, 4, 8, 16, 32, 128))
    data = draw.randbytes(size)
    place = draw.choice(PLACES)
    if place == 0x0120:
        data = struct.pack("<H", draw.choice((INIT, PREOP, SAFEOP, OP)) | draw.choice((0, ACK)))
    elif place in (0x0900, 0x0990) or draw.random() < 0.2:
        data = bytes(len(data))
    elif place == 0x1000 and draw.random() < 0.8:
        # A mailbox message of which something is right
        body = struct.pack("<H", draw.choice((2, 8, 3)) << 12) + draw.randbytes(draw.randrange(40))
        head = struct.pack("<HHBB", draw.choice((len(body), 500, 0)), 0, 0, draw.randrange(256))
        data = (head + body)[:128].ljust(128, b"\x00")
    return physical(command, draw.choice((0, 0, 0, -1, 0x1001)), place, data)


def play(seed: int, count: int) -> str:
    draw = random.Random(seed)
    line = Line(2, settings=[SlaveSettings(1, drift_ppm=50.0), SlaveSettings(2, sample_ns=-1000)])
    if seed % 2:
        line.op()
    for n in range(count):
        if n % 60 == 0:
            line.wait(500 * US)  # until all frames are back
        if n % 60 == 0 and line.al()[0] != OP and draw.random() < 0.7:
            # Back to where something can go wrong
            line.write(0x0010, 0, 2)
            line.write(0x0980, 0, 2)
            line.ask(INIT | ACK)
            line.one(2, 0, 0x0600, bytes(64))
            line.preop()
        line.segment.send(frame(*(any_datagram(draw) for _ in range(draw.randrange(1, 4)))))
        line.wait(draw.choice((20, 150, 1000)) * US)
    line.wait(500 * US)
    assert len(line.back) >= count
    return hashlib.sha256(repr(line.back).encode()).hexdigest()


@pytest.mark.parametrize("seed", range(2))
def test_random_frames_are_answered_the_same_each_time(seed: int) -> None:
    assert play(seed, 150) == play(seed, 150)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(2, 40))
def test_more_random_frames_are_answered(seed: int) -> None:
    play(seed, 1500)
