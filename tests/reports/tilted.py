"""An inclined tool made of formulas: a head with C and A, and distance control that steps once.

With u = Rz(C) Rx(A) e_z the axes X, Y, Z are at TCP + (100 + L2) u, the clamping point at TCP +
L2 u. An axis is two cycles later where it was sent; a cycle is 1 ms. The workpiece is level and
rises once by 1.5 mm, and so does the offset along the normal.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
from tests.recordings import MS, facts, kept

from axisrig.bench.judge.kinematics.findings import tool_findings
from axisrig.bench.judge.kinematics.tool_findings import ToolFindings
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.run_findings import RunFindings, of_facts
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.distance import (
    ChannelDistanceRecord,
    Controller,
    Diagnosis,
    DistanceChange,
    PlcSensor,
)
from axisrig.bench.record.facts import Facts
from axisrig.bench.record.kinematics import GuideChange, KinematicRecord

Signal = npt.NDArray[np.float64]

ROWS, KINEMATIC, TILTED, ON, STEP, OFF = 700, 50, 250, 300, 400, 690
LEVER_MM, TOOL_MM, OFFSET_MM = 100.0, 80.0, 1.5
A_DEG, C_DEG = -35.0, 20.0
AXES = ("X", "Y", "Z", "C", "A")
WRITTEN: dict[str, int | float | str] = {
    "kin_step[0].trafo[0].id": 9,
    "kin_step[1].trafo[0].id": 98,
    "kin_step[1].trafo[0].param[0]": 1_000_000,
    "kin_step[1].trafo[0].param[1]": 500_000,
    "kin_step[1].trafo[0].param[2]": 700_000,
    "kin_step[1].trafo[0].param[3]": 850_000,
}
CONTROLLER = Controller(0.2, 0.0, 0.0, "MOVING_AVERAGE", 4, 0.7, 4, 25.0, 0.1, False)


def direction(c_deg: Signal, a_deg: Signal) -> Signal:
    """u, shape (n, 3)."""
    c, a = np.radians(c_deg), np.radians(a_deg)
    return np.stack([np.sin(c) * np.sin(a), -np.cos(c) * np.sin(a), np.cos(a)], axis=1)


def length_mm(a_deg: Signal) -> Signal:
    """L2 of [50; 70]: 80, above 50 degrees 80 cos 50/cos a, above 70 frozen (FCT-M3 12.4.2)."""
    held = np.radians(np.clip(np.abs(a_deg), 50.0, 70.0))
    return TOOL_MM * np.cos(np.radians(50.0)) / np.cos(held)


def late(values: Signal) -> Signal:
    """Where axes are at a SYNC: where they were sent two cycles before."""
    return np.concatenate([values[:1], values[:1], values[:-2]])


def trace(
    a_deg: float = A_DEG,
    c_deg: float = C_DEG,
    *,
    mode: str = "ECS",
    has_sensor: bool = True,
    offset_mm: float = OFFSET_MM,
) -> pa.Table:
    """Signals as the recorder writes them. mode: ECS moves along the tool, MCS along Z.

    offset_mm: while the control is on; a sensor sees a workpiece that has risen by OFFSET_MM.
    """
    at = np.arange(ROWS, dtype=np.float64)
    share = np.clip((at - KINEMATIC) / (TILTED - KINEMATIC), 0.0, 1.0)
    a, c = share * a_deg, share * c_deg
    tcp = np.zeros((ROWS, 3))
    tcp[:, 1] = np.clip(at - ON, 0.0, OFF - ON) * 0.05
    u, size = direction(c, a), length_mm(a)
    base = tcp + (LEVER_MM + size)[:, None] * u
    offset = np.where((at >= STEP) & (at < OFF), offset_mm, 0.0)
    along = u / u[:, 2:] if mode == "ECS" else np.broadcast_to([0.0, 0.0, 1.0], u.shape)
    superposed = offset[:, None] * along
    sent = base + superposed
    columns: dict[str, npt.NDArray[Any]] = {"time_ns": (at * MS).astype(np.int64)}
    for axis, values in zip(AXES, (*sent.T, c, a), strict=True):
        unit = "deg" if axis in "CA" else "mm"
        for word, of in (("set", values), ("actual", late(values)), ("truth", late(values))):
            columns[f"{axis}.{word}_{unit}"] = of
    for axis, values in zip("XYZ", superposed.T, strict=True):
        columns[f"{axis}.superposed_mm"] = values
    columns["C.superposed_deg"] = columns["A.superposed_deg"] = np.zeros(ROWS)
    columns |= {
        "channel.offset_mm": offset,
        "channel.distance_state": np.where((at >= ON) & (at < OFF), 4, 0),
        "channel.set_pos_mm": np.full(ROWS, np.nan),
        "channel.tilt_deg": np.where(at >= KINEMATIC, np.abs(late(a)), np.nan),
        "channel.tool_length_mm": length_mm(late(a)),
    }
    if has_sensor:
        columns |= _sensor(np.stack([columns[f"{n}.truth_mm"] for n in "XYZ"], axis=1), c, a, at)
    return pa.table(columns)


def _sensor(pivot: Signal, c: Signal, a: Signal, at: Signal) -> dict[str, Signal]:
    c, a = late(c), late(a)
    u, size = direction(c, a), length_mm(a)
    clamp = pivot - LEVER_MM * u
    tcp = clamp - size[:, None] * u
    height = np.where(at >= STEP, OFFSET_MM, 0.0)
    found = {
        "gap.distance_true_mm": clamp[:, 2] - height,
        "gap.valid": np.ones(len(at)),
        "gap.along_mm": (clamp[:, 2] - height) / u[:, 2],
        "gap.virtual_length_mm": size,
        "gap.tilt_deg": np.abs(a),
    }
    for name, points in (("clamping", clamp), ("tcp", tcp)):
        found |= {f"gap.{name}_{k}_mm": points[:, i] for i, k in enumerate("xyz")}
    return found


def left(mode: str = "ECS") -> Facts:
    """What the run leaves beside its signals."""
    changes = [(0, "INACTIVE"), (ON, "ACTIVE_CONST_DIST"), (OFF, "INACTIVE")]
    axes = {
        axis: AxisRecord("can1", node, 10_000.0, is_rotary=axis in "CA")
        for node, axis in enumerate(AXES, 1)
    }
    dumps = [("INACTIVE(0)", "0"), ("ACTIVE_CONST_DIST(4)", "0"), ("INACTIVE(0)", "15000")]
    return replace(
        facts(sim_ns=ROWS * MS, end_ns=ROWS * MS, axes=axes, channel=WRITTEN),
        kinematics=(KinematicRecord(KINEMATIC * MS, (ROWS - 1) * MS, AXES, (9, 98), TOOL_MM),),
        plc_sensors={"V.E.SENSOR": PlcSensor("gap", 1, 0)},
        distance_3d=ChannelDistanceRecord(
            "V.E.SENSOR",
            False,
            tuple(
                DistanceChange(row * MS, state, "NC", "V.E.SENSOR", False, CONTROLLER)
                for row, state in changes
            ),
            tuple(
                Diagnosis(row * MS, {"zstd": state, "kp": "0.2", "cmd_offset": offset})
                for row, (state, offset) in zip((0, ON, OFF), dumps, strict=True)
            ),
            (GuideChange(KINEMATIC * MS, "MCS"), GuideChange(ON * MS, mode)),
        ),
    )


def tool(signals: pa.Table, of: Facts) -> ToolFindings:
    """What the judge finds of the tool."""
    (found,) = tool_findings(Observed(of, kept(signals)))
    return found


def found(observed: Observed) -> RunFindings:
    """Findings of a run: its facts and its tool alone."""
    return replace(of_facts(observed.facts), of_topics=tool_findings(observed))
