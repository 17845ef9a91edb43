"""Whether states changed along the edges of their tables: channel, drives, distance control."""

import csv
from collections.abc import Iterable, Sequence
from functools import cache
from importlib import resources
from itertools import pairwise

from axisrig.bench.record.distance import DistanceChange
from axisrig.bench.tools.scenarios.left import Left
from axisrig.kernel.time.clock import TimeNs

Edges = frozenset[tuple[str, str]]
_ANY, _LEFT = "*", "INACTIVE"


def _rows(package: str, name: str) -> list[dict[str, str]]:
    text = resources.files(package).joinpath(name).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


@cache
def channel_edges() -> Edges:
    """Read the edges of the channel."""
    return frozenset((r["from"], r["to"]) for r in _rows(__package__, "channel_states.csv"))


@cache
def drive_edges() -> Edges:
    """Read the edges of CiA 402; the state before power on is any."""
    rows = _rows("axisrig.kernel.profiles.cia402", "ds402_transitions.csv")
    return frozenset((row["from"] or _ANY, row["to"]) for row in rows)


@cache
def distance_edges() -> Edges:
    """Read the edges of distance control.

    An error comes from any state, an offset runs out, and a program that ends or an alarm leaves an
    offset where it is (FCT-M3 5.1).
    """
    rows = _rows("axisrig.kernel.distance", "states.csv")
    found = {(row["state"], row["next"]) for row in rows if row["next"]}
    return frozenset(found | {(_ANY, "ERROR"), ("TURNING_OFF", _LEFT)})


def wrong_steps(left: Left) -> str:
    """Say which state followed which without an edge; empty where each has one."""
    found = [("channel", _off(left.states, channel_edges()))]
    for axis, record in left.facts.axes.items():
        states = [state.state for state in record.states]
        found.append((f"drive of {axis}", _off(states, drive_edges())))
    controls = {name: record.changes for name, record in left.facts.distance.items()}
    if left.facts.distance_3d is not None:
        controls["channel"] = left.facts.distance_3d.changes
    ends_ns = [left.facts.end_ns, *(alarm.time_ns for alarm in left.facts.alarms)]
    over_ns = min(ends_ns) - 2 * left.facts.timing.period_ns
    for name, changes in controls.items():
        found.append(
            (f"distance control of {name}", _off(_names(changes, over_ns), distance_edges()))
        )
    return "; ".join(f"{what}: {wrong}" for what, wrong in found if wrong)


def _names(changes: Iterable[DistanceChange], over_ns: TimeNs) -> list[str]:
    """Return states in their order, without one that was left as the program ended."""
    return [c.state for c in changes if c.state != _LEFT or c.time_ns < over_ns]


def _off(names: Sequence[str], edges: Edges) -> str:
    for before, after in pairwise(names):
        if before != after and not {(before, after), (_ANY, after)} & edges:
            return f"{before} to {after}"
    return ""
