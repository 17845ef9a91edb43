"""Which parts of a slave controller an access to its registers concerns.

A cyclic frame asks for the same registers in each cycle, so that this is worked out once for each
place and length.
"""

from typing import Final

from axisrig.bench.drive.ethercat.sync_managers import COUNT as SYNC_MANAGERS
from axisrig.kernel.profiles.ethercat import tables

# Of a read: what shows a value that is worked out, and what reading clears
EEPROM: Final = 1 << 0
WATCHDOG: Final = 1 << 1
MANAGERS: Final = 1 << 2
TIME: Final = 1 << 3
DIFFERENCE: Final = 1 << 4
SYNC: Final = 1 << 5
LATCHES: Final = 1 << 6
AL_STATUS: Final = 1 << 7
LATCH_TIMES: Final = 1 << 8
CLEARED: Final = AL_STATUS | LATCH_TIMES

# Of a write, beside EEPROM and MANAGERS: what acts on it
AL_CONTROL: Final = 1 << 9
WATCHDOG_SETTINGS: Final = 1 << 10
WATCHDOG_COUNTS: Final = 1 << 11
FRAME_ERRORS: Final = 1 << 12
FMMUS: Final = 1 << 13
RECEIVE_TIMES: Final = 1 << 14
FOLLOW_32: Final = 1 << 15
FOLLOW_64: Final = 1 << 16
OFFSET: Final = 1 << 17
FILTERS: Final = 1 << 18
SYNC_SETTINGS: Final = 1 << 19
ACTIVATION: Final = 1 << 20
CLOCK: Final = 1 << 21
MALFORMED_FRAMES: Final = 1 << 23
PDI_ERRORS: Final = 1 << 24
LOST_LINKS: Final = 1 << 25
ERRORS: Final = FRAME_ERRORS | MALFORMED_FRAMES | PDI_ERRORS | LOST_LINKS
WRITABLE: Final = 1 << 22
"""Of a write: a master may write each byte of it."""


READS: Final[dict[int, int]] = {}
WRITES: Final[dict[int, int]] = {}
"""What accesses have concerned so far, of all slaves, by place and length in one number."""


def read_parts(begin: int, end: int) -> int:
    """Return what a read of the registers from `begin` to before `end` concerns."""
    at = addresses()
    first, latches = at["SYNC_MANAGER"], at["LATCH0_POSITIVE"]
    has_sync = begin < at["USER_RAM"] and end > at["CYCLIC_CONTROL"]
    return (
        EEPROM * (begin < at["EEPROM_DATA"] and end > at["EEPROM_CONTROL"])
        | WATCHDOG * (begin < at["EEPROM_CONFIGURATION"] and end > at["WATCHDOG_DIVIDER"])
        | MANAGERS * (begin < first + 8 * SYNC_MANAGERS and end > first)
        | TIME * (begin < at["RECEIVE_TIME"] and end > at["SYSTEM_TIME"])
        | DIFFERENCE * (begin < at["SPEED_COUNTER_START"] and end > at["SYSTEM_TIME_DIFFERENCE"])
        | SYNC * has_sync
        | LATCHES * (has_sync and end > at["LATCH0_STATUS"])
        | AL_STATUS * (begin <= at["AL_STATUS"] < end)
        | LATCH_TIMES * (latches < end and begin < latches + 32)
    )


def written_parts(begin: int, end: int) -> int:
    """Return what acts on a write of the registers from `begin` to before `end`."""
    rows = tables.registers()
    writable = WRITABLE * all(
        any(
            row.address <= place < row.address + row.size and row.master == "rw"
            for row in rows.values()
        )
        for place in range(begin, end)
    )
    if begin >= rows["RECEIVE_TIMES"].address:
        return writable | _written_clock(begin, end)

    def has(*names: str) -> bool:
        return any(
            begin < rows[name].address + rows[name].size and end > rows[name].address
            for name in names
        )

    return (
        writable
        | AL_CONTROL * has("AL_CONTROL")
        | WATCHDOG_SETTINGS * has("WATCHDOG_DIVIDER", "WATCHDOG_PROCESS_DATA")
        | WATCHDOG_COUNTS * has("WATCHDOG_COUNT", "WATCHDOG_PDI_COUNT")
        | FRAME_ERRORS * has("RX_ERRORS", "FORWARDED_ERRORS")
        | MALFORMED_FRAMES * has("MALFORMED_FRAMES")
        | PDI_ERRORS * has("PDI_ERRORS")
        | LOST_LINKS * has("LOST_LINKS")
        | EEPROM * has("EEPROM_CONTROL")
        | FMMUS * has("FMMU")
        | MANAGERS * has("SYNC_MANAGER")
    )


def _written_clock(begin: int, end: int) -> int:
    at = addresses()
    time = at["SYSTEM_TIME"]
    has_time = begin <= time and end >= time + 4
    is_long = end >= time + 8
    return (
        CLOCK
        | RECEIVE_TIMES * (begin <= at["RECEIVE_TIMES"] < end)
        | FOLLOW_32 * (has_time and not is_long)
        | FOLLOW_64 * (has_time and is_long)
        | OFFSET * (begin < at["SYSTEM_TIME_DIFFERENCE"] and end > at["SYSTEM_TIME_OFFSET"])
        | FILTERS * (begin < at["SPEED_COUNTER_DIFFERENCE"] and end > at["SPEED_COUNTER_START"])
        | SYNC_SETTINGS * (end > at["CYCLIC_CONTROL"])
        | ACTIVATION * (end > at["CYCLIC_CONTROL"] and begin <= at["ACTIVATION"] < end)
    )


def addresses() -> dict[str, int]:
    """Return the address of each register by its name."""
    return {name: row.address for name, row in tables.registers().items()}
