"""Keys of `[drive.D]` of a conventional drive."""

from typing import Literal

from axisrig.bench.rig.speed_drive.keys import AnalogueTable


class DriveTable(AnalogueTable):
    """`[drive.NAME]`: a speed drive at the analogue output of a card in the control."""

    family: Literal["conventional"]

    @property
    def in_words(self) -> str:
        """What it is, for who reads a rig."""
        return (
            f"conventional drive at a card of the control, {self.lines} lines a turn counted four"
            f" times: {float(1000 / self.per_mm):.4g} um an increment"
        )
