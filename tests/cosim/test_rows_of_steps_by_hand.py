"""Several steps in one call, of a library that is written down here in place of an FMU."""

import ctypes
import struct
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.fmi.steps import FUNCTION, ROWS, StepsInARow, plain_references
from axisrig.kernel.time.clock import MS

OK, WARNING, DISCARD, ERROR, FATAL = range(5)
ROW = struct.Struct("=qqqQqqQQQQ")  # StepsInARow of `target/slave.inc`

pytestmark = pytest.mark.interpreted


class Instance:
    """Its outputs are the sum of the inputs of a step, and the end of the step in ms.

    stops: status of the step to an instant that it does not reach; warns: of one that it does.
    """

    def __init__(self, stops: dict[int, int] | None = None, *, warns_ns: int = -1) -> None:
        self.time_ns, self.pointer, self.name = 0, 1, "axis"
        self._stops, self._warns_ns = stops or {}, warns_ns
        self.counts: list[int] = []
        self.asked: list[tuple[str, Any]] = []

    def function(self, name: str, _signature: Any) -> Callable[[int, int], int]:
        assert name == FUNCTION
        return self._call

    def _call(self, _pointer: int, address: int) -> int:
        begin_ns, count, _, ends_at, n_in, n_out, inputs, outputs, given, got = ROW.unpack(
            ctypes.string_at(address, ROW.size)
        )
        assert begin_ns == self.time_ns
        assert list((ctypes.c_uint32 * n_in).from_address(inputs)) == [10 + k for k in range(n_in)]
        assert list((ctypes.c_uint32 * n_out).from_address(outputs)) == [20, 21][:n_out]
        self.counts.append(count)
        ends = (ctypes.c_int64 * count).from_address(ends_at)
        values = (ctypes.c_double * (count * n_in)).from_address(given) if n_in else []
        found = (ctypes.c_double * (count * n_out)).from_address(got)
        status, done, at_ns = OK, 0, begin_ns
        for number, end_ns in enumerate(ends):
            if end_ns in self._stops:
                status = self._stops[end_ns]
                break
            own = (sum(values[number * n_in : (number + 1) * n_in]), end_ns / MS)
            found[number * n_out : (number + 1) * n_out] = own[:n_out]
            status = max(status, WARNING if end_ns == self._warns_ns else OK)
            done, at_ns = done + 1, end_ns
        ctypes.memmove(address, struct.pack("=qqq", at_ns, count, done), 24)
        return status

    def step_to(self, end_ns: int) -> None:
        self.asked.append(("step_to", end_ns))

    def failed(self, what: str, status: int) -> None:
        self.asked.append((what, status))
        raise PlantError("axis", self.time_ns, what)


def steps(slave: Any, n_in: int = 1, n_out: int = 2) -> StepsInARow:
    return StepsInARow(slave, [10 + k for k in range(n_in)], [20, 21][:n_out])


@pytest.mark.parametrize("n_in", [0, 1, 3])
@pytest.mark.parametrize(
    ("count", "calls"),
    [(1, [1]), (2, [2]), (ROWS, [ROWS]), (ROWS + 1, [ROWS, 1]), (2 * ROWS, [ROWS, ROWS]),
     (2 * ROWS + 7, [ROWS, ROWS, 7])],
)  # fmt: skip
def test_each_step_has_its_own_inputs_and_outputs_in_as_many_calls_as_it_takes(
    n_in: int, count: int, calls: list[int]
) -> None:
    """64 steps in a call. Inputs and outputs differ in number."""
    slave = Instance()
    many = steps(slave, n_in)
    ends_ns = [k * MS + 7 for k in range(1, count + 1)]
    given = [float(place) for place in range(count * n_in)]
    rows = many.take(ends_ns, given)
    assert slave.counts == calls
    assert rows == [[sum(given[k * n_in : (k + 1) * n_in]), ends_ns[k] / MS] for k in range(count)]
    assert slave.time_ns == ends_ns[-1]
    again = many.take([slave.time_ns + MS], [5.0] * n_in)  # with the buffers that it has
    assert again == [[5.0 * n_in, (ends_ns[-1] + MS) / MS]]


@pytest.mark.parametrize("status", [DISCARD, ERROR, FATAL])
@pytest.mark.parametrize("stop", [1, 2, ROWS, ROWS + 1, ROWS + 30])
def test_after_a_step_that_is_refused_no_other_call_is_made(stop: int, status: int) -> None:
    """The times that were reached are returned; the clock stands at the step before the end."""
    ends_ns = [k * MS for k in range(1, 3 * ROWS)]
    slave = Instance({stop * MS: status})
    rows = steps(slave, 0, 1).take(ends_ns)
    assert len(rows) == stop - 1
    assert slave.time_ns == (stop - 1) * MS
    assert sum(slave.counts) == (ROWS if stop <= ROWS else 2 * ROWS)


def test_steps_with_a_warning_go_on() -> None:
    slave = Instance(warns_ns=3 * MS)
    assert len(steps(slave, 0, 1).take([k * MS for k in range(1, 2 * ROWS)])) == 2 * ROWS - 1
    assert slave.counts == [ROWS, ROWS - 1]


@pytest.mark.parametrize(
    ("status", "asked"),
    [
        (DISCARD, [("step_to", 2 * MS), ("doStep", DISCARD)]),  # it says once more that it ended
        (ERROR, [("doStep", ERROR)]), (FATAL, [("doStep", FATAL)]),
    ],
)  # fmt: skip
def test_a_refused_step_is_asked_for_once_more_only_where_the_model_may_have_ended(
    status: int, asked: list[tuple[str, int]]
) -> None:
    """FMI 2.0.4, 4.2.4: after an error no step may be done any more."""
    slave = Instance({2 * MS: status})
    many = steps(slave)
    assert len(many.take([MS, 2 * MS], [1.0, 2.0])) == 1
    with pytest.raises(PlantError):
        many.refuse(2 * MS)
    assert slave.asked == asked


def exchange(kind: Any, references: list[int], count: int) -> Any:
    from axisrig.kernel.cosim.fmi.slave import Exchange  # noqa: PLC0415 - made without an FMU

    made = Exchange.__new__(Exchange)
    made.values, made.references = (kind * count)(), references
    return made


@pytest.mark.parametrize(
    ("parts", "found"),
    [
        ([(ctypes.c_double, [4, 5], 2), (ctypes.c_double, [1], 1)], [4, 5, 1]),
        ([(ctypes.c_double, [1], 1), (ctypes.c_double, [4, 5], 2)], [1, 4, 5]),
        ([(ctypes.c_float, [4], 1)], None), ([(ctypes.c_int32, [4], 1)], None),
        ([(ctypes.c_double, [4], 3)], None),  # an array
        ([(ctypes.c_double, [4], 1), (ctypes.c_float, [5], 1)], None), ([], []),
    ],
)  # fmt: skip
def test_references_are_those_of_all_exchanges_of_scalar_doubles(
    parts: list[tuple[Any, list[int], int]], found: list[int] | None
) -> None:
    assert plain_references([exchange(*part) for part in parts]) == found
    mixed: list[Any] = [*(exchange(*part) for part in parts), SimpleNamespace()]
    assert plain_references(mixed) is None
