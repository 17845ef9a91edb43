"""The file of what masters store in virtual drives, and interfaces that are lost and come back."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.real_segment import OutsideSegment
from axisrig.bench.tools.virtual_drive.parameters import ParameterFile
from axisrig.bench.tools.virtual_drive.serve import DriveServer, Trace
from axisrig.kernel.cosim.plant.outputs import (
    DEMAND_POSITION,
    MOTOR_POSITION,
    POSITION,
    VELOCITY,
)
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, S
from axisrig.kernel.time.scheduler import new_scheduler

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


class Memory:
    """What one drive keeps."""

    def __init__(self, **stored: int) -> None:
        self.stored: dict[tuple[int, int], int] = {}

    def load(self, stored: dict[tuple[int, int], int]) -> None:
        self.stored = dict(stored)


def opened(path: Path, **memories: Memory) -> ParameterFile:
    given: Any = memories
    return ParameterFile(path, given)


def test_each_drive_gets_what_it_has_stored_in_its_life_before(tmp_path: Path) -> None:
    """Indices and sub-indices are hexadecimal, values are not."""
    path = tmp_path / "drives.json"
    content = {"X": {"1017:00": 500, "1A00:0A": 0x60640020}, "Z": {"6065:00": 2500}, "A": {}}
    path.write_text(json.dumps(content), encoding="utf-8")
    x, y, z = Memory(), Memory(), Memory()
    file = opened(path, X=x, Y=y, Z=z)
    assert x.stored == {(0x1017, 0): 500, (0x1A00, 10): 0x60640020}
    assert (y.stored, z.stored) == ({}, {(0x6065, 0): 2500})
    assert not file.look()  # nothing new: the file stays as it is
    assert json.loads(path.read_text()) == content


def test_what_is_stored_is_written_once_and_read_again(tmp_path: Path) -> None:
    """Values of drives that are not there this time stay in the file."""
    path = tmp_path / "drives.json"
    path.write_text('{"A": {"1017:00": 7}}', encoding="utf-8")
    y, z = Memory(), Memory()
    file = opened(path, Y=y, Z=z)
    for stored, is_new in (
        ({(0x6065, 0): 1, (0x1005, 0): 0x80, (0x1016, 0x1F): -1}, True),
        ({(0x6065, 0): 1, (0x1005, 0): 0x80, (0x1016, 0x1F): -1}, False),
        ({(0x6065, 0): 2}, True),
        ({}, True),
        ({(0x1016, 0x1F): -1, (0x1A00, 10): 9}, True),
    ):
        z.stored = stored
        assert file.look() is is_new
        assert not file.look()
        again, other = Memory(), Memory()
        opened(path, Z=again, A=other)
        assert (again.stored, other.stored) == (stored, {(0x1017, 0): 7})
    assert [each.name for each in tmp_path.iterdir()] == ["drives.json"]


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", '{"Z": 1}', '{"Z": {"1017": "much"}}', '{"Z": {"10G7:00": 1}}',
        '{"Z": {"1017": 1}}', '{"Q": [1]}',
    ],
)  # fmt: skip
def test_another_file_is_refused_and_kept(tmp_path: Path, text: str) -> None:
    path = tmp_path / "notes.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="no file of stored parameters") as refused:
        opened(path, Z=Memory())
    assert refused.value.file == str(path)
    assert path.read_text() == text


class Interface(OutsideSegment):
    """An interface that is opened again when `is_there`; `tries` are counted."""

    def __init__(self) -> None:  # nothing is opened
        self.lost, self.is_there, self.tries = None, False, 0

    def reopen(self) -> bool:
        self.tries += 1
        if self.is_there:
            self.lost = None
        return self.is_there


def test_a_lost_interface_is_tried_once_a_second_until_it_is_there() -> None:
    """Of two the second one is lost, comes back, and is lost again at once."""
    lines: list[tuple[int, str]] = []
    server = DriveServer.__new__(DriveServer)
    first, second = Interface(), Interface()
    server.segments, server._tried_ns = {"can1": first, "can2": second}, {}
    on: Any = server
    on.scheduler = SimpleNamespace(now_ns=0)
    on._watcher = SimpleNamespace(report=lambda ns, axis, kind, text: lines.append((ns, text)))

    def mend(at_ms: int) -> int:
        on.scheduler.now_ns = at_ms * MS // 2  # the drives lag
        server._mend(at_ms * MS)
        return second.tries

    assert mend(10) == 0
    second.lost = "adapter is gone"
    tried = [mend(at_ms) for at_ms in (20, 500, 1019, 1020, 1021, 2019)]
    assert tried == [1, 1, 1, 2, 2, 2]
    second.is_there = True
    assert (mend(2020), mend(2021)) == (3, 3)
    second.lost = "adapter is gone again"
    second.is_there = False
    assert mend(2022) == 4  # a new loss has its line, and is tried at once
    assert first.tries == 0
    assert lines == [
        (10 * MS, "can2 is lost: adapter is gone"),
        (1010 * MS, "can2 is there again"),
        (1011 * MS, "can2 is lost: adapter is gone again"),
    ]
    assert S == 1000 * MS


# --- what is kept at each SYNC


def test_a_trace_has_the_truth_of_each_plant_in_mm_at_each_sync() -> None:
    motions: dict[str, list[float]] = {"X": [0.0] * 32, "Z": [0.0] * 32}
    axes: Any = {name: SimpleNamespace(motion=motion) for name, motion in motions.items()}
    trace = Trace(axes)
    for row in (1, 2):
        for sign, motion in zip((1, -1), motions.values(), strict=True):
            for n, place in enumerate((POSITION, VELOCITY, MOTOR_POSITION, DEMAND_POSITION), 1):
                motion[place] = sign * (row * 10 + n) * 1e-3
        trace.add(row * MS)
    found = {name: column.to_pylist() for name, column in trace.columns().items()}
    assert found == {
        "time_ns": [MS, 2 * MS],
        "X.truth_mm": pytest.approx([11, 21]), "X.velocity_mm_s": pytest.approx([12, 22]),
        "X.motor_mm": pytest.approx([13, 23]), "X.demand_mm": pytest.approx([14, 24]),
        "Z.truth_mm": pytest.approx([-11, -21]), "Z.velocity_mm_s": pytest.approx([-12, -22]),
        "Z.motor_mm": pytest.approx([-13, -23]), "Z.demand_mm": pytest.approx([-14, -24]),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("nodes", "period_us"),
    [([], 0), ([(4000, 9000)], 4000), ([(0, 9000)], 9000), ([(1000, 9), (0, 2000)], 2000)],
)
def test_the_sync_advances_by_1006_or_else_by_60c2_the_longest_of_all(
    nodes: list[tuple[int, int]], period_us: int
) -> None:
    server = DriveServer.__new__(DriveServer)
    on: Any = server
    on.nodes = {
        str(number): SimpleNamespace(
            image=SimpleNamespace(sync_period_us=own_us),
            servo=SimpleNamespace(
                interpolation=SimpleNamespace(period_ns=lambda other=other_us: other * US)
            ),
        )
        for number, (own_us, other_us) in enumerate(nodes)
    }
    assert server._sync_period_ns() == period_us * US


def test_a_row_is_taken_at_each_sync_when_the_nodes_have_acted_on_it() -> None:
    """CiA 301: identifier 0x80; other frames, and one with 29 bits, are none."""
    server = DriveServer.__new__(DriveServer)
    on: Any = server
    on.scheduler = new_scheduler()
    rows: list[int] = []
    on._trace = SimpleNamespace(add=rows.append)
    for at_ms, can_id, is_extended in (
        (1, 0x80, False), (2, 0x81, False), (3, 0x80, True), (4, 0x80, False),
    ):  # fmt: skip
        on.scheduler.run_until(at_ms * MS)
        frame: Any = SimpleNamespace(arbitration_id=can_id, is_extended_id=is_extended)
        server._on_frame(0, "can1", frame, False)
        assert at_ms * MS not in rows
    on.scheduler.run_until(5 * MS)
    assert rows == [MS, 4 * MS]
