"""Parameters of the drive and the answers to requests for them (`parameters.csv`).

Source: SINAMICS 6SL3097-4AB10 p. 613; a request for more than one parameter is not answered with
its values (docs/profidrive.md).
"""

from axisrig.bench.drive.profidrive.profile import ProfidriveProfile
from axisrig.kernel.profiles.profidrive import parameters as words


class DriveParameters:
    """values: by their numbers, as they are now."""

    def __init__(self, profile: ProfidriveProfile) -> None:
        self._profile = profile
        self.values: dict[int, int] = {}
        self.reset()

    def reset(self) -> None:
        """Have the values of the rig, as after power on."""
        made = self._profile
        self.values = {
            660: made.p0660,
            880: made.p0880_rpm,
            881: made.p0881,
            922: made.telegram.number,
            925: made.p0925,
            1042: made.p1042,
            1043: made.p1042 + made.absolute_shift,
            1230: made.p1230,
        }

    def torque_limit(self, reduction: int) -> int:
        """Return the torque limit in 0.1 % of the rated torque. reduction: MOMRED.

        P1230 max(0, 1 - P0881/100 % MOMRED/16384), down to a whole 0.1 %. Source: SIMODRIVE 611
        universal p. 224.
        """
        limit, full = self.values[1230], 100 * words.FULL_REDUCTION
        return limit * max(0, full - self.values[881] * reduction) // full

    def answer(self, request: bytes) -> bytes:
        """Return the response to a request; empty where it is none."""
        if len(request) < words.HEAD.size + words.ADDRESS.size:
            return b""
        try:
            return words.positive(request, self._carried_out(request))
        except _RefusedError as refused:
            return words.negative(request, str(refused))

    def _carried_out(self, request: bytes) -> bytes:
        """Carry out a request; return what was read, empty after a write."""
        _reference, kind, _axis, count = words.HEAD.unpack_from(request)
        attribute, elements, number, sub = words.ADDRESS.unpack_from(request, words.HEAD.size)
        _check(kind in (words.READ, words.WRITE) and count == 1, "ADDRESS")
        known = words.parameters().get(number)
        if known is None:
            raise _RefusedError("NUMBER")
        _check(attribute == words.VALUE and elements <= 1, "ADDRESS")
        _check(not sub, "NO_ARRAY")
        if kind == words.WRITE:
            self._write(known, request[words.HEAD.size + words.ADDRESS.size :])
            return b""
        return self.values[number].to_bytes(known.bits // 8, "big", signed=known.is_signed)

    def _write(self, known: words.Parameter, given: bytes) -> None:
        """Take a value with its format."""
        _check(not known.is_read_only, "READ_ONLY")
        _check(len(given) >= words.VALUES.size, "COUNT")
        kind, count = words.VALUES.unpack_from(given)
        _check(kind in words.FORMATS, "FORMAT")
        length = words.FORMATS[kind]
        data = given[words.VALUES.size : words.VALUES.size + length]
        _check(count == 1 and len(data) == length, "COUNT")
        _check(length * 8 == known.bits, "TYPE")
        value = int.from_bytes(data, "big", signed=known.is_signed)
        _check(known.low <= value <= known.high, "LIMIT")
        self.values[known.number] = value


class _RefusedError(Exception):
    """A request is refused; the name of its error value."""


def _check(is_right: bool, name: str) -> None:
    if not is_right:
        raise _RefusedError(name)
