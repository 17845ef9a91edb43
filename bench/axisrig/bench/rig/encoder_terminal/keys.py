"""Keys of `[drive.D]` of an axis with a speed drive and an encoder terminal."""

from typing import Annotated, Literal

from pydantic import Field

from axisrig.bench.rig.speed_drive.keys import SpeedDriveTable

EDGES_PER_LINE = 4


class DriveTable(SpeedDriveTable):
    """`[drive.NAME]`: a speed drive at an analogue output, its encoder at a KL5101.

    lines: of the encoder per turn, each counted four times.
    """

    family: Literal["encoder_terminal"]
    lines: Annotated[int, Field(ge=1, le=1 << 20)] = 1024

    @property
    def increments_per_turn(self) -> int:
        """Increments of its counter for a turn."""
        return int(self.lines) * EDGES_PER_LINE

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return (
            f"speed drive and encoder terminal, {self.lines} lines a turn counted four times:"
            f" {float(1000 / self.per_mm):.4g} um an increment, a counter of 16 bits"
        )
