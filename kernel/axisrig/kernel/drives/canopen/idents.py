"""Idents of SERCOS drives that a CANopen drive answers by an object of its own (#IDENT).

No SERCOS drive is simulated. What a program wants of one is handed to the object of the same
meaning: `idents.csv` is the table. unit: `object` = both count alike; `position` = the ident
counts 0.1 um or 0.0001 degrees, the object position units of the axis. off, object_off: the values
that switch a watch off, which are no lengths. Sources: FCT-C4 section 7.3.1, TF5200 programming
manual 207347083 (#IDENT), CiA 402-2 (6065, 6072).
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final

from axisrig.kernel.drives.functions import UNLIMITED, DriveFunction
from axisrig.kernel.errors import Alarm

IDENT_PER_MM: Final = 10000  # S-0-0076, preferred scaling: 10^-7 m and 10^-4 degrees
_ROUNDING = 1e-9


@dataclass(frozen=True)
class DriveIdent(DriveFunction):
    """An ident and the object that replaces it.

    factor: object per ident. off, object_off: what switches the watch off on either side, None
    where nothing does.
    """

    off: int | None = None
    object_off: int | None = None

    @property
    def length_bytes(self) -> int:
        """Length of the ident in the drive (TYP of #IDENT)."""
        return self.bits // 8

    def raw(self, value: float, axis: str) -> int:
        """Return what the drive gets for a value of the ident, in its smallest digits.

        A length above 0 stays above 0: 0 is off in SERCOS and the tightest window in CiA 402.
        Raises Alarm 900112 for what the object cannot hold.
        """
        if self.off is not None and abs(value - self.off) < _ROUNDING:
            assert self.object_off is not None
            return self.object_off
        low, high = self.range
        if self.off is not None:
            high -= 1
        scaled = value * self.factor
        if not low - 0.5 <= scaled < high + 0.5:
            raise Alarm(
                900112, axis=axis, key=self.key, value=f"{scaled:.15g}", data_type=self.data_type
            )
        return round(scaled) if self.off is None else round(scaled) or 1

    def value(self, data: bytes) -> float:
        """Return the value of the ident, not rounded: written back it is the same object again."""
        raw = int.from_bytes(data, "little", signed=self.is_signed)
        if self.off is not None and raw == self.object_off:
            return float(self.off)
        return raw / self.factor

    def can_tell(self, data: bytes) -> bool:
        """Whether what the object holds has a value of the ident: `off` is taken."""
        raw = int.from_bytes(data, "little", signed=self.is_signed)
        return self.off is None or raw != round(self.off * self.factor)


@cache
def drive_idents(increments_per_mm: float) -> Mapping[str, DriveIdent]:
    """Give the idents of a drive by name; increments_per_mm: position units of 6064 and 6065."""
    text = resources.files(__package__).joinpath("idents.csv").read_text(encoding="utf-8")
    return {
        row["ident"]: _ident(row, increments_per_mm) for row in csv.DictReader(text.splitlines())
    }


def _ident(row: Mapping[str, str], increments_per_mm: float) -> DriveIdent:
    index, sub = int(row["index"], 16), int(row["sub"])
    return DriveIdent(
        key=row["ident"],
        communication="ACYCLIC",
        index=index,
        sub=sub,
        read_index=index,
        read_sub=sub,
        data_type=row["data_type"],
        mask=None,
        factor=increments_per_mm / IDENT_PER_MM if row["unit"] == "position" else 1.0,
        low=-UNLIMITED,
        high=UNLIMITED,
        startup=None,
        off=int(row["off"], 0) if row["off"] else None,
        object_off=int(row["object_off"], 0) if row["object_off"] else None,
    )
