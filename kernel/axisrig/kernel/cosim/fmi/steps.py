"""Several steps of an instance in one call, where its library offers that.

FMUs of `axisrig.fmus` have a function beside those of FMI (`target/slave.inc`, "steps in a row").
It sets, steps and gets as the functions of FMI do one by one, with the same results. Where steps
are short, the way into the library and back costs more than the step. Any other FMU is called one
by one.
"""

import ctypes
import struct
from collections.abc import Sequence
from typing import Any, Final

from axisrig.kernel.cosim.fmi.library import DISCARD, WARNING, Missing, array_type
from axisrig.kernel.cosim.fmi.slave import POINTER, Exchange, FmuSlave
from axisrig.kernel.time.clock import TimeNs

FUNCTION: Final = "axisrigSteps1"
ROWS: Final = 64
"""Steps in one call; more are taken in several."""
# StepsInARow of `target/slave.inc`: begin_ns, count, done; ends_ns; n_inputs, n_outputs; inputs,
# outputs, given, got. Packed as a whole, since a field of a `ctypes.Structure` costs as much as a
# step of a small FMU.
_STRUCTURE: Final = struct.Struct("=qqqQqqQQQQ")


class StepsInARow:
    """Steps of one instance with inputs before and outputs after each of them.

    slave: an instance that `offers_steps`. inputs, outputs: value references of Float64 scalars.
    """

    def __init__(
        self, slave: FmuSlave, inputs: Sequence[int] = (), outputs: Sequence[int] = ()
    ) -> None:
        self._slave: Any = slave
        self._call: Any = slave.function(FUNCTION, (POINTER, POINTER))
        self._in_count, self._out_count = len(inputs), len(outputs)
        self._ends_ns: Any = (ctypes.c_int64 * ROWS)()
        self._given: Any = array_type(ctypes.c_double, ROWS * len(inputs))()
        self._got: Any = array_type(ctypes.c_double, ROWS * len(outputs))()
        self._inputs: Any = array_type(ctypes.c_uint32, len(inputs))(*inputs)
        self._outputs: Any = array_type(ctypes.c_uint32, len(outputs))(*outputs)
        self._row: Any = (ctypes.c_char * _STRUCTURE.size)()
        self._address = ctypes.addressof(self._row)
        buffers = (self._inputs, self._outputs, self._given, self._got)
        places = [ctypes.addressof(buffer) for buffer in buffers]
        ends_at = ctypes.addressof(self._ends_ns)
        _STRUCTURE.pack_into(self._row, 0, 0, 0, 0, ends_at, len(inputs), len(outputs), *places)
        self._write_head: Any = struct.Struct("=qq").pack_into
        self._read_head: Any = struct.Struct("=qqq").unpack_from
        # By the number of steps: what writes their ends, and their inputs
        self._writers: dict[int, tuple[Any, Any]] = {}
        self._read_row: Any = struct.Struct(f"={len(outputs)}d").unpack_from
        self._status = 0

    def take(self, ends_ns: Sequence[TimeNs], given: Sequence[float] = ()) -> list[list[float]]:
        """Step to each of these instants; return the outputs at each that was reached.

        given: the inputs of each step, one step after the other. Where fewer rows come back than
        there are instants, `refuse` says why.
        """
        if len(ends_ns) <= ROWS:
            return self._take(ends_ns, given)
        rows: list[list[float]] = []
        for first in range(0, len(ends_ns), ROWS):
            begin = first * self._in_count
            part = given[begin : begin + ROWS * self._in_count]
            rows += self._take(ends_ns[first : first + ROWS], part)
            if self._status > WARNING:
                break
        return rows

    def _take(self, ends_ns: Sequence[TimeNs], given: Sequence[float]) -> list[list[float]]:
        """Make one call."""
        slave, row, count = self._slave, self._row, len(ends_ns)
        writers = self._writers.get(count)
        if writers is None:
            writers = self._writers[count] = (
                struct.Struct(f"={count}q").pack_into,
                struct.Struct(f"={count * self._in_count}d").pack_into,
            )
        write_ends, write_given = writers
        self._write_head(row, 0, slave.time_ns, count)
        write_ends(self._ends_ns, 0, *ends_ns)
        if self._in_count:
            write_given(self._given, 0, *given)
        self._status = self._call(slave.pointer, self._address)
        slave.time_ns, _, done = self._read_head(row, 0)
        read, got, width = self._read_row, self._got, self._out_count * 8
        return [list(read(got, place * width)) for place in range(done)]

    def refuse(self, end_ns: TimeNs) -> None:
        """Raise PlantError for the step to `end_ns`, the first that was not reached."""
        if self._status == DISCARD:
            self._slave.step_to(end_ns)  # it reports once more that the model has ended
        self._slave.failed("doStep", self._status)


def offers_steps(slave: FmuSlave) -> bool:
    """Return whether an instance can take `StepsInARow`."""
    is_there = not isinstance(slave.function(FUNCTION, (POINTER, POINTER)), Missing)
    return is_there and slave.grid_ns is None


def plain_references(exchanges: Sequence[object]) -> list[int] | None:
    """Return the value references of exchanges of Float64 scalars without conversion, else None."""
    found: list[int] = []
    for exchange in exchanges:
        if not isinstance(exchange, Exchange):
            return None
        is_float64 = exchange.values._type_ is ctypes.c_double
        if not is_float64 or len(exchange.values) != len(exchange.references):
            return None
        found += exchange.references
    return found
