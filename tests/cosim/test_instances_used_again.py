"""An instance that is set aside and reset; what a description says of steps and values."""

import ctypes
from collections import deque
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.library import (
    Layout,
    Missing,
    PlantError,
    grid_of,
    longest_internal_step_s,
    own_step_s,
    standstill,
)
from axisrig.kernel.cosim.fmi.reset import reset, set_aside
from axisrig.kernel.errors import UserError

HANDLE = 4711
OK, WARNING, DISCARD, ERROR, FATAL = range(5)


def used(**more: Any) -> Any:
    """An instance after a run: at 2 s, with two saved states and a message."""
    freed: list[int] = []
    states = [SimpleNamespace(handle=ctypes.c_void_p(number)) for number in (1, 2)]
    content = {
        "pointer": HANDLE, "PREFIX": "fmi3", "messages": deque(["odd"]), "time_ns": 2_000_000_000,
        "_stands_ns": 1_999_000_000, "_excess_s": 1e-10, "_is_final": False, "_is_fatal": False,
        "_can_terminate": True, "_cut": ctypes.c_uint16(1), "_states": states, "freed": freed,
        "can": SimpleNamespace(once_per_process=False),
        "_free": lambda pointer, _address: freed.append(pointer),
    }  # fmt: skip
    return SimpleNamespace(**content | more)


def test_an_instance_that_is_set_aside_has_no_states_and_gives_its_handle() -> None:
    slave = used()
    assert set_aside(slave) == HANDLE
    assert (slave.pointer, slave._states, slave.freed) == (0, [], [HANDLE, HANDLE])
    assert set_aside(slave) == 0  # a second time there is nothing


@pytest.mark.parametrize(
    "more",
    [
        {"pointer": 0},
        {"_can_terminate": False},
        {"can": SimpleNamespace(once_per_process=True)},
    ],
    ids=["freed", "failed, or not initialised", "once per process"],
)
def test_what_may_not_be_used_again_keeps_its_handle(more: dict[str, Any]) -> None:
    slave = used(**more)
    before = slave.pointer
    assert set_aside(slave) == 0
    assert (slave.pointer, slave.freed, len(slave._states)) == (before, [], 2)


@pytest.mark.parametrize(
    ("status", "is_new"),
    [(OK, True), (WARNING, True), (DISCARD, False), (ERROR, False), (FATAL, False), (None, False)],
)
def test_an_instance_that_is_reset_knows_nothing_of_the_run_before(
    status: int | None, is_new: bool
) -> None:
    """FMI 2.0.4, 2.1.6; FMI 3.0.2, 2.3.1. None: its library has no such function."""
    asked: list[Any] = []

    def call(handle: int) -> int:
        asked.append(handle)
        assert status is not None
        return status

    def function(name: str, _signature: Any) -> Any:
        asked.append(name)
        return Missing(name) if status is None else call

    slave = used(function=function, _is_fatal=True)
    assert reset(slave, HANDLE) is is_new
    assert asked == ["fmi3Reset"] + [HANDLE] * (status is not None)
    assert (slave.pointer, slave.time_ns, slave._stands_ns, slave._excess_s) == (HANDLE, 0, 0, 0.0)
    assert (slave._is_final, slave._can_terminate, slave._is_fatal) == (True, False, False)
    assert (list(slave.messages), slave.messages.maxlen, slave._cut.value) == ([], 1000, 0)


# What a description says


def described(
    internal: object, experiment: object, *, can_vary: bool = False, has: bool = True
) -> Any:
    return SimpleNamespace(
        coSimulation=SimpleNamespace(
            fixedInternalStepSize=internal, canHandleVariableCommunicationStepSize=can_vary
        ),
        defaultExperiment=SimpleNamespace(stepSize=experiment) if has else None,
    )


@pytest.mark.parametrize(
    ("description", "step_s", "grid_ns"),
    [
        (described("1e-3", "2e-3"), 1e-3, 1_000_000),
        (described(None, "2e-3"), 2e-3, 2_000_000),
        (described("1e-3", "2e-3", can_vary=True), 1e-3, None),
        (described(None, None), None, None),
        (described(None, None, has=False), None, None),
        (described("1e-3", None, has=False), 1e-3, 1_000_000),
        (described("1e-10", None), 1e-10, 1),
        (described(0.0, 2e-3), 2e-3, 2_000_000),
    ],
)
def test_the_own_step_of_an_fmu_is_its_internal_one_before_that_of_its_experiment(
    description: Any, step_s: float | None, grid_ns: int | None
) -> None:
    assert own_step_s(description) == step_s
    assert grid_of(description) == grid_ns


@pytest.mark.parametrize(
    ("last_s", "own_s", "words"),
    [
        (1.0, None, None),
        (1.0 - 0.9e-12, None, None),
        (1.0 - 1e-9, None, "the FMU does not advance (lastSuccessfulTime 0.999999999 s)"),
        (0.9, 0.1, None),
        (0.899, 0.1, "the FMU does not advance (lastSuccessfulTime 0.899 s)"),
        (float("nan"), 0.1, "where the FMU has come (lastSuccessfulTime) is no number"),
    ],
)
def test_a_step_may_end_before_its_end_by_the_own_step_at_most(
    last_s: float, own_s: float | None, words: str | None
) -> None:
    assert standstill(last_s, 1.0, own_s) == words


@pytest.mark.parametrize(
    ("text", "step_s"),
    [
        ('<LongestInternalStep seconds="0.0005"/>', 5e-4),
        ("<a:LongestInternalStep unit='s' seconds='1e-4' x='1'/>", 1e-4),
        ('<NoLongestInternalStep seconds="0.0005"/>', None),
        ("", None),
    ],
)
def test_the_longest_internal_step_is_in_the_annotation(
    tmp_path: Path, text: str, step_s: float | None
) -> None:
    (tmp_path / "modelDescription.xml").write_text(f"<fmiModelDescription>{text}<b/>")
    assert longest_internal_step_s(tmp_path) == step_s


def variable(name: str, type_: str, reference: int, *shape: int) -> Any:
    return SimpleNamespace(name=name, type=type_, valueReference=reference, shape=shape or None)


def test_an_array_takes_as_many_places_as_it_has_elements() -> None:
    types = {"Float64": ("Float64", ctypes.c_double), "Int32": ("Int32", ctypes.c_int32)}
    several = [variable("a", "Float64", 7), variable("m", "Float64", 3, 2, 3),
               variable("v", "Float64", 9, 4)]  # fmt: skip
    found = Layout.of(several, types, "a.fmu")
    assert (found.word, found.kind, found.places) == ("Float64", ctypes.c_double, 1 + 6 + 4)
    assert (found.references, list(found.array)) == ([7, 3, 9], [7, 3, 9])
    with pytest.raises(UserError) as caught:
        Layout.of([variable("a", "Int32", 1), variable("b", "Float64", 2)], types, "a.fmu")
    assert caught.value.message.startswith("FMU a.fmu: a, b differ in type")
    assert caught.value.value == "Float64 Int32"
    with pytest.raises(UserError, match="one that cannot be exchanged"):
        Layout.of([variable("a", "String", 1)], types, "a.fmu")


def test_an_error_of_a_plant_says_who_when_and_what() -> None:
    error = PlantError("table", 1_234_567, "doStep: error")
    assert str(error) == "plant table at t = 1.234567 ms: doStep: error"
    assert (error.instance, error.time_ns, error.reason) == ("table", 1_234_567, "doStep: error")
