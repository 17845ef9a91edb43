"""Keys of `[drive.D]` that each drive on a cyclic segment has; a family derives its own."""

from typing import Annotated, Any, Literal

from pydantic import Field

from axisrig.bench.rig.habit_keys import OF_ANY, number
from axisrig.bench.rig.reading.families import FAMILIES, read_drive
from axisrig.bench.rig.reading.tables import DriveKeys


class ImageDriveKeys(DriveKeys):
    """What a drive has whose image is swapped in each cycle.

    speed_loop_us: time of its speed loop. missing_cycles: how often in a row its image may stay
    out. as_canopen: a run may set it (`--as-canopen`), and has the usual drive with the same axis
    then.
    """

    speed_loop_us: Annotated[float, Field(ge=0, le=1_000_000)] = 0.0
    missing_cycles: Annotated[int, Field(ge=0, le=1000)] = 3
    jump_factor: Annotated[float, Field(ge=0, le=1000)] = 2.0
    lag_limit_mm: Annotated[float, Field(ge=0, le=1e6)] = 0.0
    fault_reset: bool = False
    as_canopen: Literal[False] = False

    @classmethod
    def habits(cls) -> tuple[str, ...]:
        """Return the habits of the axis that the family has."""
        raise NotImplementedError

    @classmethod
    def value_of(cls, key: str, text: str) -> Any:
        """Read the cell of a plan for one of its keys; a text that fits nothing stays one."""
        return number(text)

    def changed(self, key: str, value: Any) -> Any:
        """Return the drive with one key changed. Raises ValidationError."""
        given = self.model_dump(exclude_unset=True)
        if key == "as_canopen" and value is True:
            kept = {name: given[name] for name in (*self.habits(), *OF_ANY) if name in given}
            return read_drive({"family": FAMILIES[0].family, key: True, **kept})
        return type(self).model_validate({**given, key: value})
