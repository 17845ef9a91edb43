"""The lines of `axisrig drive`: frames written out by hand, and what is told of them."""

from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.frame import data_frame
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.tools.virtual_drive.watch import Watcher
from axisrig.kernel.profiles.cia402.ds402 import State


@pytest.mark.parametrize(
    ("can_id", "data", "found"),
    [
        (0x083, "11 86 21 00 00 00 00 00",
         "EMCY    0x8611, following error, error register 0x21"),
        (0x083, "00 00 00 00 00 00 00 00", "EMCY    reset, error register 0x00"),
        (0x583, "80 60 60 00 30 00 09 06",
         "SDO     abort of 0x6060:00 with 0x06090030, value is not allowed"),
        (0x583, "80 60 60 00 01 00 00 0F",
         "SDO     abort of 0x6060:00 with 0x0F000001, a code of the manufacturer"),
    ],
)  # fmt: skip
def test_codes_are_told_in_words(can_id: int, data: str, found: str) -> None:
    axis = SimpleNamespace(segment="can1", plant="z")
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    node: Any = SimpleNamespace(
        node_id=3,
        nmt_state=SimpleNamespace(name="OPERATIONAL"),
        state=State.SWITCHED_ON,
        image=ProcessImage(),
    )
    plant: Any = None
    lines: list[str] = []
    with ExitStack() as opened:
        watch = Watcher(settings, {"Z": node}, plant, lines.append, None, opened)
        watch(1_000_000, "can1", data_frame(can_id, bytes.fromhex(data)), False)
    assert lines == [f"    0.001000 s  Z    {found}"]
