"""Cyclic values of two fields and axes, taken block by block."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from axisrig.bench.bus.journal import Journal
from axisrig.bench.machine.canopen.telegram_log import TelegramLog
from axisrig.bench.machine.ethercat.value_log import ValueLog
from axisrig.bench.machine.recording.cyclic_values import CyclicValues
from axisrig.bench.machine.recording.received import noted
from axisrig.bench.record.series import ACTUAL, FRAME_NS, INCREMENTS, SECOND, TARGET
from axisrig.bench.rig.canopen.io_node import NodeTelegrams
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.ethercat.image import codec_of
from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.time.clock import MS, US


def lists(columns: dict[str, pa.Array], axis: str, field: str) -> list[list[tuple[int, int]]]:
    """Pairs of instant and increments, by row."""
    parts = (columns[f"{axis}.{field}_{part}"].to_pylist() for part in (FRAME_NS, INCREMENTS))
    return [list(zip(*row, strict=True)) for row in zip(*parts, strict=True)]


def put(values: CyclicValues, axis: str, field: str, *pairs: tuple[int, int]) -> None:
    for frame_ns, increments in pairs:
        noted = values.of(axis, field)
        noted.frame_ns.append(frame_ns)
        noted.increments.append(increments)


def test_each_row_has_the_values_up_to_its_instant_and_each_block_what_none_before_had() -> None:
    values = CyclicValues()
    put(values, "X", TARGET, (5, 1), (10, 2), (11, 3), (31, 4))
    put(values, "X", ACTUAL, (7, -1), (30, -2))
    put(values, "Z", TARGET, (20, 9))
    first = values.take_columns(np.array([10, 20]), is_last=False)
    assert lists(first, "X", TARGET) == [[(5, 1), (10, 2)], [(11, 3)]]
    assert lists(first, "X", ACTUAL) == [[(7, -1)], []]
    assert lists(first, "Z", TARGET) == [[], [(20, 9)]]
    put(values, "X", TARGET, (45, 5))
    put(values, "Z", TARGET, (33, 8))
    second = values.take_columns(np.array([30, 40]), is_last=False)
    assert lists(second, "X", TARGET) == [[], [(31, 4)]]
    assert lists(second, "X", ACTUAL) == [[(30, -2)], []]
    assert lists(second, "Z", TARGET) == [[], [(33, 8)]]
    put(values, "X", ACTUAL, (70, -3))
    last = values.take_columns(np.array([50, 60]), is_last=True)
    assert lists(last, "X", TARGET) == [[(45, 5)], []]
    assert lists(last, "X", ACTUAL) == [[], [(70, -3)]]
    assert lists(last, "Z", TARGET) == [[], []]


@pytest.mark.parametrize(
    ("times", "is_last", "rows"),
    [
        ([20], True, [[5, 20, 21, 99]]),  # of one row, with what came after it
        ([20], False, [[5, 20]]),
        ([4], True, [[5, 20, 21, 99]]),
        ([4], False, [[]]),
        ([20, 21], True, [[5, 20], [21, 99]]),
        ([99, 100], True, [[5, 20, 21, 99], []]),
        ([], True, []),
    ],
)
def test_a_block_of_any_size_may_be_the_last(
    times: list[int], is_last: bool, rows: list[list[int]]
) -> None:
    """What a block has left is in the next one."""
    values = CyclicValues()
    put(values, "X", TARGET, *((at, -at) for at in (5, 20, 21, 99)))
    found = values.take_columns(np.array(times, dtype=np.int64), is_last=is_last)
    assert lists(found, "X", TARGET) == [[(at, -at) for at in row] for row in rows]
    taken = sum(map(len, rows))
    rest = values.take_columns(np.array([100]), is_last=False)
    assert lists(rest, "X", TARGET) == [[(at, -at) for at in (5, 20, 21, 99)[taken:]]]


@pytest.mark.interpreted
def test_telegrams_of_a_node_are_in_one_row_and_in_no_block_again() -> None:
    """One ends 0.3 ms after each SYNC: it belongs to the row of the next one, or to the last."""
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    log = TelegramLog([], journal, NodeTelegrams("can1", 0x194, MS, 99 * US, 600 * US))
    frame = SimpleNamespace(arbitration_id=0x194, data=b"\x01")

    def rows(ends_ms: list[float], times_ms: list[int], *, is_last: bool) -> list[list[int]]:
        taken[0]([(round(at * MS), "can1", frame, False) for at in ends_ms])
        columns = log.take_columns(np.array(times_ms) * MS, is_last=is_last)
        found: list[list[int]] = columns["plc.inputs_frame_ns"].to_pylist()
        return found

    first = rows([0.3, 1.3, 2.3], [0, 1, 2], is_last=False)
    assert first == [[], [300 * US], [1300 * US]]
    assert rows([3.3], [3], is_last=False) == [[2300 * US]]
    assert rows([4.3, 5.3], [4, 5], is_last=True) == [[3300 * US], [4300 * US, 5300 * US]]


# --- from the frames of a bus and of a line


def frame_of(can_id: int, data: bytes) -> Any:
    return SimpleNamespace(arbitration_id=can_id, data=data)


def link_of(name: str, node_id: int) -> Any:
    """A drive with the telegrams of the kernel's own mapping, second encoder included."""
    mapped = telegrams(0x60BA, counter=True, inputs=True, second=True)
    return SimpleNamespace(name=name, node_id=node_id, telegrams=mapped)


def sent(link: Any, field: str, value: int) -> tuple[int, bytes]:
    """The frame of the telegram that has a field, all other values 0."""
    for telegram in link.telegrams.values():
        fields = [mapped.field for mapped in telegram.objects]
        if field in fields:
            values = [value if name == field else 0 for name in fields]
            return telegram.cob_id(link.node_id), telegram.codec.pack(*values)
    raise KeyError(field)


@pytest.mark.interpreted
def test_values_of_a_bus_belong_to_the_axis_of_its_segment_and_identifier() -> None:
    """Node 3 on both buses, node 4 beside it without distance control; errors do not count."""
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    z, x, y = link_of("Z", 3), link_of("X", 3), link_of("Y", 4)
    log = TelegramLog([("can1", z), ("can2", x)], journal)
    (take,) = taken
    (target, data), (actual, other) = sent(z, TARGET, -5), sent(z, ACTUAL, 7)
    second = sent(x, SECOND, 123_456)
    take([
        (1 * MS, "can1", frame_of(target, data), False),
        (2 * MS, "can1", frame_of(actual, other), False),
        (3 * MS, "can1", frame_of(actual, other), True),  # destroyed
        (4 * MS, "can1", frame_of(actual, other[:-1]), False),  # of another length
        (5 * MS, "can2", frame_of(*second), False),
        (6 * MS, "can1", frame_of(*sent(y, ACTUAL, 9)), False),
        (7 * MS, "can3", frame_of(actual, other), False),
    ])  # fmt: skip
    columns = log.take_columns(np.array([9 * MS]), is_last=True)
    assert lists(columns, "Z", TARGET) == [[(1 * MS, -5)]]
    assert lists(columns, "Z", ACTUAL) == [[(2 * MS, 7)]]
    assert lists(columns, "X", SECOND) == [[(5 * MS, 123_456)]]
    assert lists(columns, "X", ACTUAL) == lists(columns, "Z", SECOND) == [[]]
    assert not any(name.startswith("Y") for name in columns)
    assert TelegramLog([], journal).take_columns(np.array([1]), is_last=True) == {}
    assert len(taken) == 1  # who wants nothing reads nothing


@pytest.mark.interpreted
def test_frames_that_are_still_in_the_journal_belong_to_the_block_that_is_taken() -> None:
    """Frames of a drive and of a node with inputs, no block of the journal full: each is in the
    row of its instant, in no later block, and none is missing at the end.
    """
    journal, link = Journal(), link_of("Z", 3)
    node = NodeTelegrams("can1", 0x194, MS, 99 * US, 600 * US)
    log = TelegramLog([("can1", link)], journal, node)

    def end(at_us: int, can_id: int, data: bytes) -> None:
        journal.entries.append((at_us * US, "can1", frame_of(can_id, data), False))

    def rows(times_ms: list[int], *, is_last: bool) -> tuple[list[Any], list[list[int]]]:
        columns = log.take_columns(np.array(times_ms) * MS, is_last=is_last)
        assert journal.entries == []
        inputs: list[list[int]] = columns["plc.inputs_frame_ns"].to_pylist()
        return lists(columns, "Z", TARGET), inputs

    for at_us in (300, 1300, 2300):
        end(at_us, 0x194, b"\x01")
        end(at_us + 1, *sent(link, TARGET, -at_us))
    targets, inputs = rows([1, 2], is_last=False)
    assert targets == [[(301 * US, -300)], [(1301 * US, -1300)]]
    assert inputs == [[300 * US], [1300 * US]]
    assert rows([3, 4], is_last=False) == ([[(2301 * US, -2300)], []], [[2300 * US], []])
    end(5300, 0x194, b"\x00")
    end(6301, *sent(link, TARGET, 7))
    targets, inputs = rows([5, 6], is_last=True)
    assert targets == [[], [(6301 * US, 7)]]
    assert inputs == [[], [5300 * US]]


@pytest.mark.interpreted
def test_values_of_a_line_are_at_the_places_of_their_axis_in_the_image() -> None:
    """Two slaves; of the frame that is back only that with the right counter, and a cyclic one."""
    journal = Journal()
    outputs, inputs = (
        tuple(mapped for t in link_of("", 1).telegrams.values() if t.is_received is is_sent
              for mapped in t.objects) for is_sent in (True, False)
    )  # fmt: skip
    sizes = [codec_of(objects).size for objects in (outputs, inputs)]
    slaves = [
        SimpleNamespace(axis=axis, outputs=(Pdo(0x1600, outputs),), inputs=(Pdo(0x1A00, inputs),))
        for axis in "XZ"
    ]
    places = [SimpleNamespace(outputs=at, inputs=at + sizes[0]) for at in (0, sum(sizes))]
    image_at = 26
    master = SimpleNamespace(
        slaves=slaves, image=SimpleNamespace(places=places),
        image_in=lambda frame: image_at if frame[-1] == 1 else None,
    )  # fmt: skip
    line: Any = SimpleNamespace(master=master)
    log = ValueLog({"ec1": line, "ec2": line}, {"Z"}, journal)

    def frame(target: int, actual: int, *, index: int = 0x80, is_right: bool = True) -> bytes:
        def packed(objects: Any, field: str, value: int) -> bytes:
            values = [value if one.field == field else 0 for one in objects]
            return bytes(codec_of(objects).pack(*values))

        of_z = packed(outputs, TARGET, target) + packed(inputs, ACTUAL, actual)
        of_x = packed(outputs, TARGET, 99) + packed(inputs, ACTUAL, 98)
        data = bytearray(bytes(image_at) + of_x + of_z + bytes([is_right]))
        data[17] = index
        return bytes(data)

    journal.entries += [
        (1 * MS, "ec1", frame(-5, 7), False),
        (2 * MS, "ec1", frame(1, 2, is_right=False), False),
        (3 * MS, "ec1", frame(3, 4, index=0x7F), False),
        (4 * MS, "can1", frame(5, 6), False),
        (5 * MS, "ec1", frame(8, -9), False),
    ]  # fmt: skip
    columns = log.take_columns(np.array([9 * MS]), is_last=True)
    assert lists(columns, "Z", TARGET) == [[(1 * MS, -5), (5 * MS, 8)]]
    assert lists(columns, "Z", ACTUAL) == [[(1 * MS, 7), (5 * MS, -9)]]
    assert not any(name.startswith("X") for name in columns)


@pytest.mark.interpreted
@pytest.mark.parametrize("lines", [0, 1])
def test_lines_without_an_axis_that_is_wanted_read_no_frames(lines: int) -> None:
    master = SimpleNamespace(
        slaves=[SimpleNamespace(axis="X", outputs=(), inputs=())],
        image=SimpleNamespace(places=[SimpleNamespace(outputs=0, inputs=0)]),
    )
    line: Any = SimpleNamespace(master=master)
    taken: list[Any] = []
    journal: Any = SimpleNamespace(add=taken.append, drain=lambda: None)
    log = ValueLog({f"ec{number}": line for number in range(lines)}, {"Z"}, journal)
    assert taken == []
    assert log.take_columns(np.array([1]), is_last=True) == {}


@pytest.mark.interpreted
def test_a_telegram_that_was_taken_stays_as_it_came() -> None:
    """The buffer may be written to again."""
    taken: list[tuple[int, bytes]] = []
    clock: Any = SimpleNamespace(now_ns=7)
    note, buffer = noted(taken, clock), bytearray(b"\x01\x02")
    note(0x181, buffer, 0.0)
    buffer[0] = 9
    clock.now_ns = 8
    note(0x181, buffer, 0.0)
    assert taken == [(7, b"\x01\x02"), (8, b"\x09\x02")]
