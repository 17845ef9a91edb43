"""How long something of the PLC side lasts: the keys `for`, `until` and `over` of an action."""

from collections.abc import Mapping

from axisrig.bench.rig.reading.faults import read_time
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import S, TimeNs

LONGEST_NS = 600 * S


def duration(keys: Mapping[str, str]) -> TimeNs | None:
    """Read how long a feedhold lasts: `for`, or None where `until` names its end."""
    if "until" in keys:
        if "for" in keys:
            raise UserError("a feedhold has `for` or `until`", value=keys["until"])
        return None
    return _time("for", keys.get("for", "nothing"))


def lasting(key: str, keys: Mapping[str, str]) -> TimeNs:
    """Read a time that may be missing; 0 is at once."""
    return _time(key, keys[key]) if key in keys else 0


def _time(key: str, text: str) -> TimeNs:
    try:
        time_ns = read_time(text)
    except ValueError:
        time_ns = 0
    if not 0 < time_ns <= LONGEST_NS:
        allowed = f"a time up to 600s with its unit (us, ms, s), as {key}=300ms"
        hint = ", or until=M51" if key == "for" else ""
        raise UserError(f"{key}: how long it lasts", value=text, allowed=allowed + hint)
    return time_ns
