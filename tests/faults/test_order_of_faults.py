"""Faults of a run in the order of its row: each with its own act, record, axes and numbers."""

import random
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.machine.faults import injection
from axisrig.bench.machine.faults.acts import Act, Injected, nothing
from axisrig.bench.machine.faults.injection import BESIDE, build_beside, inject
from axisrig.bench.rig.reading.faults import Fault, read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
CELLS = (
    ("drop", "Z.TPDO1"), ("probe_stick", "probe"), ("drop", "Y.TPDO1"), ("encoder_freeze", "X"),
    ("sync_loss", "can1"), ("probe_stick", "probe"), ("drop", "Z.TPDO1"),
)  # fmt: skip


def test_each_fault_has_its_act_and_its_record_where_it_is_in_the_row() -> None:
    """Those beside the frames are built in before; a second one at a place draws other numbers."""
    settings = read_settings(*read_rig(RIGS / "probe-xyz.toml"), [])
    settings.faults += [
        one for kind, cell in CELLS for one in read_faults(kind, cell, settings.rig)
    ]
    beside = [number for number, (kind, _) in enumerate(CELLS) if kind in BESIDE]
    assert beside == [1, 3, 5]
    ended: list[int] = []
    acts = {number: Act(nothing, partial(ended.append, number)) for number in range(len(CELLS))}
    run: list[tuple[Fault, Act, tuple[str, ...], Injected]] = []
    moments: Any = SimpleNamespace(run=lambda *words: run.append(words))
    drawn: list[float] = []
    built = iter(number for number in acts if number not in beside)

    def build(fault: Fault, numbers: random.Random, record: Injected) -> Act:
        assert record.label == f"{fault.kind} {fault.target}"
        drawn.append(numbers.random())
        return acts[next(built)]

    records = inject(settings, moments, [acts[number] for number in beside], build, 3)
    assert [one.label for one in records] == [" ".join(cell) for cell in CELLS]
    assert [one.axis for one in records] == ["Z", "", "Y", "X", "", "", "Z"]
    assert [fault for fault, *_ in run] == settings.faults
    for _, act, *_ in run:
        act.end()
    assert ended == list(range(len(CELLS)))
    assert [record for *_, record in run] == records
    # A probe that no drive measures with alone is of all axes that have it
    assert [axes for _, _, axes, _ in run] == [
        ("Z",), ("X", "Y", "Z"), ("Y",), ("X",), ("X",), ("X", "Y", "Z"), ("Z",),
    ]  # fmt: skip
    assert len({*drawn}) == len(drawn) == 4


def test_each_fault_beside_the_frames_draws_by_the_seed_of_the_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The same numbers in every run of a seed, others with another, in the order of the row."""
    settings = read_settings(*read_rig(RIGS / "probe-xyz.toml"), [])
    settings.faults += [
        one for kind, cell in CELLS for one in read_faults(kind, cell, settings.rig)
    ]
    beside: Any = SimpleNamespace(settings=settings)

    def make(found: Any, fault: Fault, numbers: random.Random) -> Any:
        assert found is beside
        return fault.kind, numbers.random()

    monkeypatch.setattr(injection, "BESIDE", dict.fromkeys(BESIDE, make))
    first, again, other = (build_beside(beside, seed) for seed in (3, 3, 4))
    assert [kind for kind, _ in first] == ["probe_stick", "encoder_freeze", "probe_stick"]
    assert first == again
    assert not {number for _, number in first} & {number for _, number in other}
    assert len({number for _, number in first}) == 3
