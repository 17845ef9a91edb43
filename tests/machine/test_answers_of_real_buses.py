"""What a cycle on a real CAN bus waits for: those of its drives that answer each SYNC."""

from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.canopen import family
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


class Outside:
    """A real segment."""

    def __init__(self) -> None:
        self.expected: list[int] = []

    def expect(self, identifiers: Iterable[int]) -> None:
        self.expected = list(identifiers)


def link(node_id: int, *telegrams: tuple[str, int, int]) -> Any:
    made = {
        name: SimpleNamespace(name=name, transmission=kind, cob_id=lambda node, at=at: at + node)
        for name, kind, at in telegrams
    }
    return SimpleNamespace(node_id=node_id, telegrams=made)


def test_it_waits_for_what_answers_each_sync_of_its_own_real_drives(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """X and Y are real, Z is simulated beside them; Y is on a bus of its own."""
    settings = read_settings(*read_rig(RIGS / "probe-xyz.toml"), [])
    for name, segment in (("X", "can1"), ("Y", "can2"), ("Z", "can1")):
        axis = settings.rig.axis[name].model_copy(update={"segment": segment})
        settings.rig.axis[name] = axis
    monkeypatch.setattr(family, "OutsideSegment", Outside)
    monkeypatch.setattr(family, "outside_axes", lambda _: frozenset("XY"))
    answers = (("TPDO1", 1, 0x180), ("TPDO2", 1, 0x280))
    buses: Any = SimpleNamespace(
        _bench=SimpleNamespace(settings=settings),
        segments={"can1": Outside(), "can2": Outside(), "can3": SimpleNamespace()},
        links={
            "X": link(1, *answers, ("TPDO3", 254, 0x380), ("RPDO1", 1, 0x200)),
            "Y": link(2, ("TPDO1", 1, 0x180), ("TPDO4", 2, 0x480)),
            "Z": link(3, *answers),
        },
    )
    family.CanBuses._expect_answers(buses)
    assert buses.segments["can1"].expected == [0x181, 0x281]
    assert buses.segments["can2"].expected == [0x182]
