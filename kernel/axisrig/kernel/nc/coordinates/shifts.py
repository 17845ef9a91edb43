"""The shifts between a programmed coordinate and ABS, for one axis."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Shifts:
    """ABS = PCS + carried + zero + reference + measurement + tool, all in mm (degrees).

    carried: for axes that no coordinate system turns, what is shifted in the systems below the
    active one. zero: G54 to G59. reference: G92. measurement: G101. tool: D.
    Source: TF5200 programming manual 206057739 (zero offset and G92 add up), 1086442763 (axes that
    come along, P-CHAN-00397 = 1).
    """

    carried_mm: float = 0.0
    zero_mm: float = 0.0
    reference_mm: float = 0.0
    measurement_mm: float = 0.0
    tool_mm: float = 0.0

    @property
    def zero_shifts_mm(self) -> float:
        """What MOFFS calls zero shifts."""
        return self.carried_mm + self.zero_mm + self.reference_mm

    @property
    def system_mm(self) -> float:
        """All but the tool: where the origin of the next coordinate system is."""
        return self.zero_shifts_mm + self.measurement_mm

    @property
    def total_mm(self) -> float:
        """All shifts together."""
        return self.system_mm + self.tool_mm
