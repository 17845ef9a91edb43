"""Drive functions: values of a drive that an NC program writes and reads with #DRIVE.

The axis list declares them (`antr.function[i].*`). Sources: TF5200 axis parameters 118084619
(P-AXIS-00396 to 00401, 00408, 00409, 00429), FCT-C4 section 7.3.2.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.parameters import INTEGER_RANGES, ParameterSet

FUNCTIONS_MAX: Final = 10
UNLIMITED: Final = 1e199  # the manual's default of both limits
NOT_USED: Final = "NOT_USED"
_WHOLE = 1e-9


class AccessError(Exception):
    """A value could not be read or written. target: what was addressed, as messages name it."""

    target: str = ""


class Idents(NamedTuple):
    """How a list names what a function writes (P-AXIS-00398).

    pattern: its groups `index` and `sub`, to the base of each. what, allowed: words of a refusal.
    """

    pattern: str
    bases: tuple[int, int]
    what: str
    allowed: str


OBJECTS: Final = Idents(
    r"(?:0[xX])?(?P<index>[0-9A-Fa-f]{4})_(?P<sub>[0-9A-Fa-f]{2})",
    (16, 16),
    "object of a CANopen drive",
    "index and sub-index as in 6072_00",
)


@dataclass(frozen=True)
class DriveFunction:
    """One drive function of an axis.

    key: its name in the program (P-AXIS-00396). communication: ACYCLIC over SDO, CYCLIC in an
    RPDO, IGNORE nothing (00397). index, sub: what is written (00398); read_index, read_sub: what
    is read. data_type: 00399. mask: bits that are written, None = all (00429). factor: 00401.
    low, high: limits of the programmed value (00408, 00409). startup: value that a cyclic element
    has from the start on (00400), None = what the drive has.
    """

    key: str
    communication: str
    index: int
    sub: int
    read_index: int
    read_sub: int
    data_type: str
    mask: int | None
    factor: float
    low: float
    high: float
    startup: int | None

    @property
    def bits(self) -> int:
        """Length of the object."""
        return int(self.data_type[3:])

    @property
    def is_signed(self) -> bool:
        """Whether the object has a sign."""
        return self.data_type.startswith("SGN")

    @property
    def range(self) -> tuple[int, int]:
        """Smallest and largest value of the data type."""
        return type_range(self.data_type)

    def raw(self, value: float, axis: str) -> int:
        """Return what the drive gets for a programmed value.

        A value outside the limits is moved to the limit without a message (P-AXIS-00408, 00409).
        Raises Alarm 900111 for a value that is not whole, 900112 outside the data type.
        """
        if abs(value - round(value)) > _WHOLE:
            raise Alarm(900111, axis=axis, key=self.key, value=f"{value:g}")
        scaled = round(min(max(round(value), self.low), self.high) * self.factor)
        low, high = self.range
        if not low <= scaled <= high:
            raise Alarm(
                900112,
                axis=axis,
                key=self.key,
                value=f"{scaled}",
                data_type=self.data_type,
            )
        return scaled

    def encode(self, raw: int) -> bytes:
        """Return the bytes of a raw value."""
        return raw.to_bytes(self.bits // 8, "little", signed=self.is_signed)

    def value(self, data: bytes) -> float:
        """Return what a program reads, from the bytes of the drive."""
        raw = int.from_bytes(data, "little", signed=self.is_signed)
        return (raw if self.mask is None else raw & self.mask) / self.factor

    def merged(self, raw: int, present: bytes) -> int:
        """Return the value to write when only the bits of the mask may change."""
        if self.mask is None:
            return raw
        low, _ = self.range
        kept = int.from_bytes(present, "little") & ~self.mask
        whole = (kept | raw & self.mask) & (1 << self.bits) - 1
        return whole - (1 << self.bits) if low < 0 and whole >> self.bits - 1 else whole


def type_range(data_type: str) -> tuple[int, int]:
    """Return smallest and largest value of a data type of P-AXIS-00399."""
    return INTEGER_RANGES[data_type]


def read_functions(
    axis: str, parameters: ParameterSet, idents: Idents = OBJECTS
) -> tuple[dict[str, DriveFunction], list[Alarm]]:
    """Return the functions of an axis by key (upper case) and the warnings of their limits.

    idents: how the family of its drive names what they write.

    Warnings: 70383, 70384 (a limit outside the data type was corrected), 70385 (limits swapped).
    Raises UserError for a function without ident and for a key that is there twice.
    """
    functions: dict[str, DriveFunction] = {}
    warnings: list[Alarm] = []
    for number in range(FUNCTIONS_MAX):
        key = parameters.word(f"antr.function[{number}].id")
        if not key:
            continue
        if key.upper() in functions:
            raise UserError(
                f"axis {axis}: two drive functions have one name",
                value=f"antr.function[..].id {key}",
            )
        functions[key.upper()] = _function(axis, parameters, idents, number, key, warnings)
    return functions, warnings


def _function(
    axis: str,
    parameters: ParameterSet,
    idents: Idents,
    number: int,
    key: str,
    warnings: list[Alarm],
) -> DriveFunction:
    path = f"antr.function[{number}]"
    written = parameters.word(f"{path}.wr_ident[0]")
    index, sub = _ident(idents, axis, f"{path}.wr_ident[0]", written)
    read = parameters.word(f"{path}.rd_ident") or written
    read_index, read_sub = _ident(idents, axis, f"{path}.rd_ident", read)
    data_type = parameters.word(f"{path}.data_type")
    scaling = parameters.word(f"{path}.scaling_type")
    if scaling == "TORQUE_DRIVE_SIDE":
        raise UserError(
            f"axis {axis}: {path}.scaling_type is known to the manuals, does not act yet",
            value=scaling,
            allowed="UNSCALED, LINEAR",
        )
    scaled = scaling == "LINEAR"
    factor = float(parameters.get(f"{path}.scaling_factor")) if scaled else 1.0
    if not factor:
        raise UserError(f"axis {axis}: {path}.scaling_factor must not be 0", value=factor)
    low, high = (float(parameters.get(f"{path}.{name}_limit")) for name in ("min", "max"))
    startup = parameters.word(f"{path}.startup_value")
    limits = _limits((low, high), type_range(data_type), factor, axis, key, warnings)
    return DriveFunction(
        key,
        parameters.word(f"{path}.commu"),
        index,
        sub,
        read_index,
        read_sub,
        data_type,
        _mask(axis, f"{path}.mask", parameters.word(f"{path}.mask")),
        factor,
        *limits,
        _number(axis, f"{path}.startup_value", startup) if startup else None,
    )


def _ident(idents: Idents, axis: str, path: str, text: str) -> tuple[int, int]:
    match = re.fullmatch(idents.pattern, text)
    if match is None:
        raise UserError(
            f"axis {axis}: {path} is no {idents.what}", value=text, allowed=idents.allowed
        )
    index_base, sub_base = idents.bases
    return int(match["index"], index_base), int(match["sub"] or "0", sub_base)


def _number(axis: str, path: str, text: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise UserError(f"axis {axis}: {path} is no whole number", value=text) from None


def _mask(axis: str, path: str, text: str) -> int | None:
    return None if text == NOT_USED else _number(axis, path, text)


def _limits(
    limits: tuple[float, float],
    of_type: tuple[int, int],
    factor: float,
    axis: str,
    key: str,
    warnings: list[Alarm],
) -> tuple[float, float]:
    """Correct the limits of a function as the control does (P-AXIS-00408, 00409)."""
    low, high = limits
    if low > high:
        warnings.append(Alarm(70385, axis=axis, key=key, low=f"{low:g}", high=f"{high:g}"))
        low, high = high, low
    bounds = sorted(bound / factor + 0.0 for bound in of_type)  # no -0
    if low > -UNLIMITED and low < bounds[0]:
        warnings.append(
            Alarm(70384, axis=axis, key=key, low=f"{low:g}", corrected=f"{bounds[0]:g}")
        )
        low = bounds[0]
    if high < UNLIMITED and high > bounds[1]:
        warnings.append(
            Alarm(70383, axis=axis, key=key, high=f"{high:g}", corrected=f"{bounds[1]:g}")
        )
        high = bounds[1]
    return low, high


Functions = Mapping[str, DriveFunction]
