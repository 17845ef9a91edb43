"""An instance that is set aside and reset is as one that has just been made."""

from collections import deque
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.library import ERROR, OK, WARNING, FmuState, Missing
from axisrig.kernel.cosim.fmi.reset import reset, set_aside

HANDLE = 4711


class Slave(SimpleNamespace):
    """An instance that has run, with two saved states; calls: what its library was asked for."""

    def __init__(self, *, status: int = OK, lacks_reset: bool = False, **given: Any) -> None:
        self.calls: list[tuple[Any, ...]] = []
        known = {
            "PREFIX": "fmi3", "pointer": HANDLE, "can": SimpleNamespace(once_per_process=False),
            "messages": deque(["late"]), "time_ns": 5, "_stands_ns": 4, "_excess_s": 1e-9,
            "_is_final": False, "_can_terminate": True, "_is_fatal": False,
            "_cut": SimpleNamespace(value=1), "_states": [FmuState(), FmuState()],
        }  # fmt: skip
        super().__init__(**(known | given))
        self._status, self._lacks_reset = status, lacks_reset

    def _free(self, pointer: int, _state: int) -> None:
        self.calls.append(("free", pointer))

    def function(self, name: str, _signature: object) -> Any:
        def call(handle: int) -> int:
            self.calls.append((name, handle))
            return self._status

        return Missing(name) if self._lacks_reset else call


def test_an_instance_that_is_set_aside_is_out_of_use_without_its_states() -> None:
    slave: Any = Slave()
    assert set_aside(slave) == HANDLE
    assert slave.pointer == 0
    assert slave.calls == [("free", HANDLE)] * 2
    assert slave._states == []
    assert set_aside(slave) == 0  # it is aside already


@pytest.mark.parametrize(
    "given",
    [
        {"pointer": 0},
        {"_can_terminate": False},  # it was not initialised, or has failed
        {"can": SimpleNamespace(once_per_process=True)},
    ],
    ids=str,
)
def test_an_instance_that_may_not_be_used_again_stays_to_be_closed(given: dict[str, Any]) -> None:
    slave: Any = Slave(**given)
    before = slave.pointer
    assert set_aside(slave) == 0
    assert (slave.pointer, slave.calls, len(slave._states)) == (before, [], 2)


@pytest.mark.parametrize("prefix", ["fmi2", "fmi3"])
def test_a_reset_instance_has_nothing_of_its_last_run(prefix: str) -> None:
    """Its time, its messages, a step cut short, and that a state was saved."""
    slave: Any = Slave(PREFIX=prefix, _is_fatal=True)
    handle = set_aside(slave)
    slave.calls.clear()
    assert reset(slave, handle) is True
    assert slave.calls == [(f"{prefix}Reset", HANDLE)]
    assert slave.pointer == HANDLE
    assert (slave.time_ns, slave._stands_ns, slave._excess_s) == (0, 0, 0.0)
    assert (slave._is_final, slave._can_terminate, slave._is_fatal) == (True, False, False)
    assert slave._cut.value == 0
    assert not slave.messages
    assert slave.messages.maxlen == 1000


@pytest.mark.parametrize(
    ("more", "works"),
    [({"status": OK}, True), ({"status": WARNING}, True), ({"status": ERROR}, False),
     ({"lacks_reset": True}, False)],
)  # fmt: skip
def test_an_instance_whose_reset_fails_is_to_be_closed(more: dict[str, Any], works: bool) -> None:
    """It has its handle again, so that it can be."""
    slave: Any = Slave(**more)
    assert reset(slave, set_aside(slave)) is works
    assert slave.pointer == HANDLE
