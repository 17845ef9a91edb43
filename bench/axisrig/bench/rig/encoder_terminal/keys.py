"""Keys of `[drive.D]` of an axis with a speed drive and an encoder terminal."""

from typing import Literal

from axisrig.bench.rig.speed_drive.keys import AnalogueTable


class DriveTable(AnalogueTable):
    """`[drive.NAME]`: a speed drive at an analogue output, its encoder at a KL5101."""

    family: Literal["encoder_terminal"]

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return (
            f"speed drive and encoder terminal, {self.lines} lines a turn counted four times:"
            f" {float(1000 / self.per_mm):.4g} um an increment, a counter of 16 bits"
        )
