"""A master that knows every object and writes anything into them: no exception, all can be read."""

from collections.abc import Callable
from random import Random
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.objects import ObjectRow, variables
from axisrig.bench.drive.cia402.dictionary.profiles import named_profile, profile_names
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]

ROWS = [row for row in variables().values() if row.index >= 0x6000]
WRITABLE = [row for row in ROWS if row.access == "rw"]
WORDS = (0x0F, 0x0F, 0x0F, 0x1F, 0x3F, 0x5F, 0x10F, 0x80, 0x00, 0x02, 0x06, 0x07)


def odd_value(random: Random, bits: int) -> int:
    """Small, extreme or any."""
    small = [0, 1, 2, 3, 6, 8, 9, 10, 0x11, 0x33]
    extreme = [(1 << bits) - 1, 1 << bits - 1, (1 << bits - 1) - 1]
    kind = random.choice([small, extreme, [random.randrange(1 << bits)]])
    return random.choice(kind) & (1 << bits) - 1


def request(head: int, row: ObjectRow, value: int = 0) -> bytes:
    place = bytes((head, row.index & 0xFF, row.index >> 8, row.sub or 0))
    return place + value.to_bytes(4, "little")


class OddMaster:
    """Sends requests to drive 3 without waiting for answers."""

    def __init__(self, random: Random, bench: Any) -> None:
        self.random = random
        self.send: Callable[[int, bytes], None] = bench.master.send_message

    def write(self, row: ObjectRow, value: int | None = None) -> None:
        bits = row.data_type.bits
        if value is None:
            value = odd_value(self.random, bits)
        self.send(0x603, request(0x23 | 4 - bits // 8 << 2, row, value))

    def read(self, row: ObjectRow) -> None:
        self.send(0x603, request(0x40, row))

    def map(self, communication: int, cob_id: int, pdo: str) -> None:
        """Fill a PDO with whatever may stand in it, by the procedure of the standard."""
        rows = variables()
        mapping = communication + 0x200
        self.write(rows[communication, 1], 1 << 31 | cob_id)
        self.write(rows[mapping, 0], 0)
        pool = [row for row in ROWS if row.pdo == pdo]
        free, sub = 64, 0
        for row in self.random.sample(pool, len(pool)):
            if row.data_type.bits <= free and sub < 8:
                free, sub = free - row.data_type.bits, sub + 1
                entry = row.index << 16 | (row.sub or 0) << 8 | row.data_type.bits
                self.write(rows[mapping, sub], entry)
        self.write(rows[mapping, 0], sub)
        self.write(rows[communication, 2], self.random.choice([1, 255]))
        self.write(rows[communication, 1], cob_id)


@pytest.mark.parametrize("seed", range(24))
def test_anything_in_any_object(drive_bench: Make, seed: int) -> None:
    random = Random(seed)
    profile = named_profile(random.choice(profile_names()))
    bench = drive_bench(inputs=([15 * MS, 25 * MS, 80 * MS], None), profile=profile)
    master = OddMaster(random, bench)
    for row in WRITABLE:
        if random.random() < 0.2:
            master.write(row)
    master.map(0x1401, 0x303, "rx")
    for number in (1, 2, 3):
        master.map(0x1800 + number, 0x4000_0183 + 0x100 * number, "tx")
    master.write(variables()[0x6060, 0], random.choice([1, 3, 6, 8, 9, 10]))
    bench.operational(60)
    for cycle in range(60):
        bench.run_to_ms(61 + cycle)
        word = (0x06, 0x07, 0x0F)[cycle] if cycle < 3 else random.choice(WORDS)
        target = odd_value(random, 32).to_bytes(4, "little")
        probe = random.choice([0, 0x11, 0x1111, 0x2121]).to_bytes(2, "little")
        master.send(0x203, word.to_bytes(2, "little") + target + probe)
        if random.random() < 0.5:
            master.send(0x303, random.randbytes(8))
        master.send(0x80, b"")
        master.write(random.choice(WRITABLE))
        master.read(random.choice(ROWS))
    bench.run_to_ms(300)
    begin = len(bench.frames(0x583))
    for row in ROWS:
        master.read(row)
    bench.run_to_ms(400)
    answers = bench.frames(0x583)[begin:]
    assert len(answers) == len(ROWS)
    read = [data for data in answers if data[0] & 0xE3 == 0x43]
    assert len(read) == sum(profile.has_object(*row.key) for row in ROWS)
