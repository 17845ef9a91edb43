"""The process image of a drive: every object value that changes while it runs.

Kept in plain attributes so that a cycle writes no object dictionary; SDO and PDOs read and write
them by the names in the column `value` of the object tables.
"""

from dataclasses import dataclass

from bench.drive.objects import variables


@dataclass(slots=True)
class ProcessImage:
    """Object values as they stand on the bus (integers in the units of the object tables)."""

    error_register: int = 0
    sync_cob_id: int = 0
    sync_period_us: int = 0
    controlword: int = 0
    statusword: int = 0
    mode: int = 0
    position_actual: int = 0
    velocity_actual: int = 0
    target_position: int = 0
    following_window: int = 0
    following_timeout_ms: int = 0
    following_error: int = 0
    probe_function: int = 0
    probe_status: int = 0
    latch_1_positive: int = 0
    latch_1_negative: int = 0
    latch_2_positive: int = 0
    latch_2_negative: int = 0
    source_1: int = 0
    source_2: int = 0
    stamp_1_positive: int = 0
    stamp_1_negative: int = 0
    stamp_2_positive: int = 0
    stamp_2_negative: int = 0
    count_1_positive: int = 0
    count_1_negative: int = 0
    count_2_positive: int = 0
    count_2_negative: int = 0
    digital_inputs: int = 0

    def set_defaults(self, first: int = 0x0000, last: int = 0xFFFF) -> None:
        """Give every value of the objects `first` to `last` the default of the table."""
        for (index, _), row in variables().items():
            if row.value and first <= index <= last:
                setattr(self, row.value, int(row.default, 0))
