"""The lines of `axisrig drive` about drives of SERCOS: idents, and lengths by their scaling."""

from contextlib import ExitStack
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.tools.virtual_drive.watch import EthercatWatcher
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class Scaled(SercosDrive):
    """A drive of SERCOS as a master has set it: 400 units in 2 turns of 5 mm."""

    state = State.OPERATION_ENABLED

    def __init__(self) -> None:
        instants = [SimpleNamespace(instant_ns=ms * MS) for ms in (3, 4, 5, 6)]
        probes = [
            SimpleNamespace(latches={True: up, False: down})
            for up, down in (instants[:2], instants[2:])
        ]
        own: Any = self
        own.states = SimpleNamespace(state=AlState.OP, code=0)
        image = ProcessImage()
        image.feed, image.feed_shaft = 400, 2
        own.front = SimpleNamespace(control=0xE000)
        own.servo = SimpleNamespace(touch_probe=SimpleNamespace(probes=probes), image=image)
        own.profile = SimpleNamespace(lead_um=5000, units_per_mm=1.0)


def test_a_drive_of_sercos_has_its_own_words_and_its_scaling() -> None:
    """S-0-0032, S-0-0134, S-0-0130 to 0133; 40 units are 1 mm."""
    axis = SimpleNamespace(plant="z", probe_1=None, probe_2=None)
    settings: Any = SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}))
    plant: Any = SimpleNamespace(probes={})
    drive, lines = Scaled(), list[str]()
    with ExitStack() as opened:
        watch = EthercatWatcher(settings, {"Z": drive}, plant, lines.append, None, opened)
        drive.image.mode = 11
        drive.state = State.FAULT  # type: ignore[misc]
        for number, edge in ((1, "positive"), (1, "negative"), (2, "positive"), (2, "negative")):
            setattr(drive.image, f"latch_{number}_{edge}", 40 * number)
            setattr(drive.image, f"count_{number}_{edge}", 1)
        watch.look(9 * MS)
    assert [" ".join(line.split()[3:]) for line in lines] == [
        "mode 0 -> 11 (S-0-0032)",
        "state OPERATION_ENABLED -> FAULT (S-0-0134 = 0xE000)",
        "latch probe 1, S-0-0130 = 40 = 1.000000 mm",
        "latch probe 1, S-0-0131 = 40 = 1.000000 mm",
        "latch probe 2, S-0-0132 = 80 = 2.000000 mm",
        "latch probe 2, S-0-0133 = 80 = 2.000000 mm",
    ]
    assert [line.split()[0] for line in lines[2:]] == [f"0.00{ms}000" for ms in (3, 4, 5, 6)]
