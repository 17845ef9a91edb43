"""The data of a drive that the kernel needs to link an axis with it over CANopen."""

from dataclasses import dataclass

from axisrig.kernel.drives.cia402.settings import Cia402Settings
from axisrig.kernel.time.clock import TimeNs


@dataclass(frozen=True, kw_only=True)
class LinkSettings(Cia402Settings):
    """The data of a drive that the kernel needs on CAN.

    pdo_map: path of a mapping table, None for the kernel's own. has_counter, has_inputs,
    has_second, has_probe: of the kernel's own mapping. answers_ns: how long after the request of a
    SYNC a telegram with 0 to 8 bytes can answer it at the earliest; empty: nobody knows.
    """

    pdo_map: str | None = None
    has_counter: bool = False
    has_inputs: bool = True
    has_second: bool = False
    has_probe: bool = True
    answers_ns: tuple[TimeNs, ...] = ()
