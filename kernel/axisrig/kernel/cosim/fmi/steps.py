"""Several steps of an instance in one call, where its library offers that.

FMUs of `axisrig.fmus` have a function beside those of FMI (`target/slave.inc`, "steps in a row").
It sets, steps and gets as the functions of FMI do one by one, with the same results. Where steps
are short, the way into the library and back costs more than the step. Any other FMU is called one
by one.
"""

import ctypes
from collections.abc import Sequence
from typing import Any

from axisrig.kernel.cosim.fmi.library import DISCARD, WARNING, Missing, array_type
from axisrig.kernel.cosim.fmi.slave import POINTER, Exchange, FmuSlave
from axisrig.kernel.time.clock import TimeNs

FUNCTION = "axisrigSteps1"
ROWS = 64
"""Steps in one call; more are taken in several."""


class _Row(ctypes.Structure):
    """StepsInARow of `target/slave.inc`."""

    _fields_ = (
        ("begin_ns", ctypes.c_int64),
        ("count", ctypes.c_int64),
        ("done", ctypes.c_int64),
        ("ends_ns", POINTER),
        ("n_inputs", ctypes.c_int64),
        ("n_outputs", ctypes.c_int64),
        ("inputs", POINTER),
        ("outputs", POINTER),
        ("given", POINTER),
        ("got", POINTER),
    )


class StepsInARow:
    """Steps of one instance with inputs before and outputs after each of them.

    slave: an instance that `offers_steps`. inputs, outputs: value references of Float64 scalars.
    """

    def __init__(
        self, slave: FmuSlave, inputs: Sequence[int] = (), outputs: Sequence[int] = ()
    ) -> None:
        self._slave = slave
        self._call = slave.function(FUNCTION, (POINTER, POINTER))
        self._in_count, self._out_count = len(inputs), len(outputs)
        self._ends_ns: Any = (ctypes.c_int64 * ROWS)()
        self._given: Any = array_type(ctypes.c_double, ROWS * len(inputs))()
        self._got: Any = array_type(ctypes.c_double, ROWS * len(outputs))()
        self._inputs = array_type(ctypes.c_uint32, len(inputs))(*inputs)
        self._outputs = array_type(ctypes.c_uint32, len(outputs))(*outputs)
        self._row = row = _Row()
        self._address = ctypes.addressof(row)
        row.n_inputs, row.n_outputs = len(inputs), len(outputs)
        row.ends_ns = ctypes.addressof(self._ends_ns)
        row.inputs, row.outputs = ctypes.addressof(self._inputs), ctypes.addressof(self._outputs)
        row.given, row.got = ctypes.addressof(self._given), ctypes.addressof(self._got)
        self._status = 0

    def take(self, ends_ns: Sequence[TimeNs], given: Sequence[float] = ()) -> list[list[float]]:
        """Step to each of these instants; return the outputs at each that was reached.

        given: the inputs of each step, one step after the other. Where fewer rows come back than
        there are instants, `refuse` says why.
        """
        rows: list[list[float]] = []
        for first in range(0, len(ends_ns), ROWS):
            part = ends_ns[first : first + ROWS]
            if self._in_count:
                begin = first * self._in_count
                values = given[begin : begin + len(part) * self._in_count]
                self._given[: len(values)] = values
            rows += self._take(part)
            if self._status > WARNING:
                break
        return rows

    def _take(self, ends_ns: Sequence[TimeNs]) -> list[list[float]]:
        """Make one call."""
        row, width = self._row, self._out_count
        row.begin_ns, row.count = self._slave.time_ns, len(ends_ns)
        self._ends_ns[: len(ends_ns)] = ends_ns
        self._status = self._call(self._slave.pointer, self._address)
        self._slave.time_ns = row.begin_ns
        got = self._got[: row.done * width]
        return [got[k * width : (k + 1) * width] for k in range(row.done)]

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
