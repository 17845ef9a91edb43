"""The tables that a rig has for drives on wires."""

from fractions import Fraction
from typing import Any, Literal

from axisrig.bench.rig.reading.tables import DriveFacts, DriveKeys, SegmentKeys


class SegmentTable(SegmentKeys):
    """`[segment.S]`: a bundle of wires."""

    carrier: Literal["wire"]
    colour: Literal["red", "blue"] = "red"


class DriveTable(DriveKeys):
    """`[drive.D]`: a drive at the end of a wire."""

    family: Literal["wire"] | None = None
    increments_per_mm: int = 10_000

    @property
    def family_name(self) -> str:
        return "wire"

    @property
    def in_words(self) -> str:
        return f"{self.increments_per_mm} increments per mm"

    @classmethod
    def value_of(cls, key: str, text: str) -> Any:
        return int(text) if text.isdecimal() else text

    def changed(self, key: str, value: Any) -> "DriveTable":
        return DriveTable.model_validate(self.model_dump() | {key: value})

    def facts(self) -> DriveFacts:
        return DriveFacts(
            units_per_mm=Fraction(self.increments_per_mm),
            reach_mm=float("inf"),
            lead_mm=10.0,
            rated_torque_mnm=0,
            look_back_ns=0,
            look_ahead_ns=0,
            second_delay_cycles=0,
        )
