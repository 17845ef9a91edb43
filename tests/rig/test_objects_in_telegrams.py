"""Which objects of a drive the kernel's telegrams carry: those that its EDS has and lets be mapped.

CiA 306-1: PDOMapping = 1. Without an EDS the profile of the rig says which ones there are.
"""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.eds_changes import changed, without

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen import schedule
from axisrig.bench.rig.canopen.schedule import (
    axis_telegrams,
    has_inputs,
    has_latch_counter,
    has_touch_probe,
    knows_counter,
    latch_object_of,
)
from axisrig.bench.rig.settings import Settings

WithEds = Callable[..., Settings]
EDS = eds_text(DriveProfile())
LATCHES = {("1", "POS"): 0x60BA, ("1", "NEG"): 0x60BB, ("2", "POS"): 0x60BC, ("2", "NEG"): 0x60BD}
COUNTERS = {0x60BA: "60D5", 0x60BB: "60D6", 0x60BC: "60D7", 0x60BD: "60D8"}
PRESENT, NOT_MAPPED, MISSING = "present", "not mapped", "missing"


def with_object(index: str, state: str) -> str:
    if state == NOT_MAPPED:
        return changed(EDS, index, PDOMapping="0")
    if state == MISSING:
        return without(EDS, index)
    return EDS


@pytest.mark.parametrize("state", [PRESENT, NOT_MAPPED, MISSING])
def test_digital_inputs(with_eds: WithEds, state: str) -> None:
    settings = with_eds(with_object("60FD", state))
    assert has_inputs(settings, "Z") is (state == PRESENT)
    assert ("TPDO3" in axis_telegrams(settings, "Z")) is (state == PRESENT)


@pytest.mark.parametrize(("place", "latch"), LATCHES.items())
@pytest.mark.parametrize("state", [PRESENT, NOT_MAPPED, MISSING])
def test_the_counter_of_the_latch_that_the_axis_measures_with(
    with_eds: WithEds, tmp_path: Path, place: tuple[str, str], latch: int, state: str
) -> None:
    """CiA 402-2: 60D5 to 60D8 belong to 60BA to 60BD in their order; no other one counts."""
    (tmp_path / "lists" / "axis-z.lst").write_text(
        f"kopf.log_achs_name Z\nkenngr.measure.input {place[0]}\nkenngr.measure.edge {place[1]}\n"
    )
    settings = with_eds(with_object(COUNTERS[latch], state))
    assert latch_object_of(settings, "Z") == latch
    assert knows_counter(settings, "Z") is (state == PRESENT)
    assert has_latch_counter(settings, "Z") is (state == PRESENT)
    if state == NOT_MAPPED:
        other = with_object(next(i for i in COUNTERS.values() if i != COUNTERS[latch]), state)
        assert knows_counter(with_eds(other), "Z")


@pytest.mark.parametrize("state", [PRESENT, NOT_MAPPED, MISSING])
def test_a_touch_probe_is_there_without_being_mapped(with_eds: WithEds, state: str) -> None:
    """SDO reaches 60B8 as well."""
    settings = with_eds(with_object("60B8", state))
    assert has_touch_probe(settings, "Z") is (state != MISSING)


@pytest.mark.parametrize(
    ("is_there", "mappable", "has"),
    [(True, True, True), (True, False, False), (True, None, False), (False, None, False)],
)
def test_an_object_of_an_eds_counts_where_it_may_be_mapped(
    monkeypatch: pytest.MonkeyPatch, is_there: bool, mappable: bool | None, has: bool
) -> None:
    """PDOMapping = 0, or nothing of it, keeps it out of every telegram (CiA 306-1)."""
    asked: list[tuple[int, int]] = []

    def variable(_od: object, index: int, sub: int) -> Any:
        asked.append((index, sub))
        return SimpleNamespace(pdo_mappable=mappable) if is_there else None

    drive = SimpleNamespace(eds="own.eds", make=lambda: "profile")
    monkeypatch.setattr(schedule, "drive_of", lambda *_: drive)
    monkeypatch.setattr(schedule, "drive_dictionary", lambda *words: words)
    monkeypatch.setattr(schedule, "variable", variable)
    rig = SimpleNamespace(axis={"Z": SimpleNamespace(node_id=3)})
    settings: Any = SimpleNamespace(rig=rig)
    assert has_inputs(settings, "Z") is has
    assert has_touch_probe(settings, "Z") is is_there  # it is read by SDO alone
    assert asked == [(0x60FD, 0), (0x60B8, 0)]
