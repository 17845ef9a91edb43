"""Marks and findings of all topics together: by time, then by kind and words."""

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.judge.observed.event import Event
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.observed.topic import Topic
from axisrig.bench.judge.topics import events, findings
from axisrig.bench.record.facts import MessageRecord, PlcNote
from axisrig.kernel.time.clock import MS

SERIES = kept(pa.table({"time_ns": np.arange(3, dtype=np.int64) * MS}))
NOTES = (PlcNote(2 * MS, "z first", "a.py:1"), PlcNote(2 * MS, "a second", "a.py:2"),
         PlcNote(1 * MS, "early", "a.py:3"))  # fmt: skip
LATER = Event(3 * MS, "mark", "later")
SAME = [
    Event(2 * MS, "pdo", "a"),
    Event(2 * MS, "alarm", "c"),
    Event(2 * MS, "mark", "zz"),
    Event(2 * MS, "alarm", "b", "Z", True),
]
BEGIN = Event(0, "mark", "begin")


def topics(turn: int) -> list[Topic]:
    first = Topic("first", {}, lambda _: [LATER, *SAME[:2]], lambda _: [1, "one"])
    second = Topic("second", {}, lambda _: [*SAME[2:], BEGIN], lambda _: [2.5, "two"])
    return [first, second, Topic("third", {}, lambda _: [])][::turn]


@pytest.mark.parametrize("turn", [1, -1])
def test_marks_are_in_the_order_of_time_kind_and_words(turn: int) -> None:
    """Whichever topic they are of. What the PLC notes at one instant stays as it came."""
    found = events(Observed(facts(plc=NOTES), SERIES), topics(turn))
    assert [(mark.time_ns // MS, mark.kind, mark.label) for mark in found] == [
        (0, "mark", "begin"),
        (1, "mark", "early"),
        *((2, "alarm", "b"), (2, "alarm", "c")),
        *((2, "mark", "zz"), (2, "mark", "z first"), (2, "mark", "a second")),
        (2, "pdo", "a"),
        (3, "mark", "later"),
    ]
    assert [(mark.axis, mark.is_warning) for mark in found if mark.label == "b"] == [("Z", True)]


@pytest.mark.parametrize("turn", [1, -1])
def test_findings_of_all_topics_are_found_by_their_kind(turn: int) -> None:
    left = facts(plc=NOTES[:1], messages=(MessageRecord(10, (1.5,), "x = 1.5"),))
    found = findings(Observed(left, SERIES), topics(turn))
    assert found.of(str) == ["one", "two"][::turn]
    assert (found.of(int), found.of(float), found.of(bytes)) == ([1], [2.5], [])
    assert list(found.events) == events(Observed(left, SERIES), topics(turn))
    assert (list(found.messages), found.error) == (["x = 1.5"], None)
