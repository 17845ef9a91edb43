"""A state of a running machine as data, for what shows it."""

import json
from typing import Any

ABOUT = {
    "run": "plan-a", "rig": "rigs/r.toml", "plan": "plan", "row": "plan.csv:2",
    "title": "one touch", "program": "programs/p.nc",
}  # fmt: skip
AXIS = {
    "axis": "Z", "unit": "mm", "is_outside": False, "set": 99.5, "actual": 99.7503, "lag": -0.2503,
    "drive": "operation enabled", "measuring": "moving", "input": False, "touch_probe": "armed",
    "latch": {"position": 100.0001, "block": "line 4, block N20", "time_ns": 1_250_000_000},
}  # fmt: skip
DISTANCE = {
    "axis": "Z", "unit": "mm", "state": "active const dist", "source": "NC",
    "sensor": "SECOND_ENCODER", "is_held": False, "is_dry_run": True, "reading": -1.5,
    "distance": 1.5, "set_name": "SET_DIST", "set": 1.25, "filtered": 1.5, "error": -0.25,
    "offset": 0.125,
}  # fmt: skip
SEGMENT = {
    "segment": "can1", "bitrate": 1_000_000, "is_outside": False, "lost": None, "frames": 12_345,
    "error_frames": 3, "load_pct": 41.25,
    "counters": [{"node": "cnc", "tec": 136, "rec": 0, "state": "error passive"}],
}  # fmt: skip
LINE = {
    "period_us": 1000.0, "wire_us": 10.08, "sent": 2000, "back": 1998, "counter": 6, "wrong": 2,
    "wrong_in_a_row": 1, "slaves": [["X", "OP"], ["Z", "SAFEOP, 0x001B, x"]],
}  # fmt: skip
"""Of a segment on EtherCAT, its `line`."""
REAL_TIME = {
    "syncs": 900, "looked_at": 500, "late": 7, "late_us": 100.0, "worst_us": 812.4,
    "slipped_ms": 1.5, "send_errors": 0,
}  # fmt: skip


def state(**changes: Any) -> dict[str, Any]:
    """A state with one axis, and some of it changed."""
    return {
        **ABOUT,
        "time_ns": 2_000_000_000,
        "channel": "running",
        "is_held": False,
        "block": "programs/p.nc line 4, block N20",
        "block_text": "N20 G100 Z80 F600",
        "waits_for": "the end of its move to Z 80 mm with 600 mm/min",
        "axes": [AXIS],
        "probes": [{"probe": "probe", "level": True, "edges": 1, "edge_ns": 1_769_447_995}],
        "distance": [],
        "bus": [SEGMENT],
        "real_time": None,
        "alarms": [],
        "messages": [],
        **changes,
    }


def as_sent(**changes: Any) -> bytes:
    """The same as a machine sends it."""
    return json.dumps(state(**changes)).encode()
