"""`edges_of`: which rows of the table of edges belong to an axis, an interval, a signal."""

from dataclasses import replace
from typing import Any

import pytest

from axisrig.bench.record.edges import EdgeTruth, edges_of

FIRST = EdgeTruth("probe", "Z", True, 100, 1.0, 2.0, 150, 3.0, 4.0)
ROWS = (
    FIRST,  # its latch is after the interval below
    replace(FIRST, level=False, edge_ns=110, latch_ns=115),
    replace(FIRST, axis="X", edge_ns=111, latch_ns=116),
    replace(FIRST, probe="lamp", edge_ns=112, latch_ns=112, read_by="terminal"),
    replace(FIRST, edge_ns=120, latch_ns=125),
    replace(FIRST, edge_ns=121, latch_ns=121),
    replace(FIRST, edge_ns=99, latch_ns=105),
)


@pytest.mark.parametrize(
    ("asked", "edges_ns"),
    [
        ({}, [100, 110, 112, 120]),  # both ends are inside, and the latch decides nothing
        ({"level": True}, [100, 112, 120]),
        ({"level": False}, [110]),
        ({"probe": "lamp"}, [112]),
        ({"probe": "probe"}, [100, 110, 120]),
        ({"read_by": "terminal"}, [112]),
        ({"read_by": "drive"}, [100, 110, 120]),
        ({"axis": "X"}, [111]),
        ({"axis": "Y"}, []),
        ({"end_ns": 100}, [100]),
        ({"begin_ns": 120}, [120]),
    ],
)
def test_edges_of_an_axis_are_those_asked_for(asked: dict[str, Any], edges_ns: list[int]) -> None:
    wanted = {"axis": "Z", "begin_ns": 100, "end_ns": 120} | asked
    assert [row.edge_ns for row in edges_of(ROWS, **wanted)] == edges_ns


def test_an_older_recording_has_no_edges() -> None:
    assert edges_of(None, axis="Z", begin_ns=0, end_ns=1) == []


@pytest.mark.parametrize(
    ("asked", "edges_ns"),
    [({"axis": "Z"}, [1, 4]), ({"axis": "Z1"}, [2]), ({"axis": "Z1", "probe": "tip"}, [2]),
     ({"axis": "Z", "probe": "tip"}, [1]), ({"axis": "Z", "probe": "tip_2"}, [4]),
     ({"axis": "Z", "probe": "t"}, []), ({"axis": ""}, []), ({"axis": "AZ"}, [3])],
)  # fmt: skip
def test_names_count_as_a_whole(asked: dict[str, Any], edges_ns: list[int]) -> None:
    """A rig may have the axes Z and Z1, and the probes tip and tip_2."""
    rows = [
        replace(FIRST, axis=axis, probe=probe, edge_ns=edge_ns)
        for edge_ns, (axis, probe) in enumerate(
            [("Z", "tip"), ("Z1", "tip"), ("AZ", "tip"), ("Z", "tip_2")], 1
        )
    ]
    assert [row.edge_ns for row in edges_of(rows, begin_ns=0, end_ns=9, **asked)] == edges_ns
