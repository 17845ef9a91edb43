"""Calls into a library as an instance makes them: status words, messages that are asked for."""

import ctypes
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.slave import Exchange, FmuSlave
from axisrig.kernel.errors import UserError

OK, WARNING, DISCARD, ERROR, FATAL = range(5)


def exchange_with(status: dict[str, int]) -> tuple[Exchange, list[tuple[str, int]]]:
    """One value of a library whose functions return these; what the instance is given to refuse."""
    refused: list[tuple[str, int]] = []
    references = (ctypes.c_uint32 * 1)(7)
    slave: Any = SimpleNamespace(
        pointer=1, name="odd", time_ns=0, PREFIX="fmi3", COUNTS_VALUES=True,
        layout=lambda _names: ("Float64", ctypes.c_double, 1, [7], references),
        function=lambda name, _signature: lambda *_arguments: status[name],
        failed=lambda call, found: refused.append((call, found)),
    )  # fmt: skip
    return Exchange(slave, ["value"]), refused


@pytest.mark.parametrize("status", [OK, WARNING])
def test_a_warning_is_no_failure(status: int) -> None:
    exchange, refused = exchange_with({"fmi3GetFloat64": status, "fmi3SetFloat64": status})
    exchange.read()
    exchange.write()
    assert refused == []


@pytest.mark.parametrize("status", [DISCARD, ERROR, FATAL])
def test_a_failure_is_that_of_its_call(status: int) -> None:
    exchange, refused = exchange_with({"fmi3GetFloat64": status, "fmi3SetFloat64": OK})
    exchange.write()
    exchange.read()
    assert refused == [("get", status)]
    exchange, refused = exchange_with({"fmi3GetFloat64": OK, "fmi3SetFloat64": status})
    exchange.read()
    exchange.write()
    assert refused == [("set", status)]


@pytest.mark.parametrize(
    ("categories", "asked"),
    [
        (["logEvents", "logStatusWarning", "logAll", "logStatusError"],
         [(True, ["logStatusWarning", "logStatusError"])]),
        (["logEvents", "logAll"], []),
        ([], []),
    ],
)  # fmt: skip
def test_messages_about_trouble_alone_are_asked_for(
    categories: list[str], asked: list[tuple[bool, list[str]]]
) -> None:
    """The categories of a status, FMI 2.0.4 and 3.0.2, 2.2.4: each message costs a call."""
    found: list[tuple[bool, list[str]]] = []
    instance: Any = SimpleNamespace(
        description=SimpleNamespace(logCategories=[SimpleNamespace(name=n) for n in categories]),
        _fmu=SimpleNamespace(setDebugLogging=lambda is_on, names: found.append((is_on, names))),
    )
    FmuSlave._limit_logging(instance)
    assert found == asked


def test_a_name_that_is_near_none_gets_them_all_by_the_alphabet(
    odd: Callable[..., FmuSlave],
) -> None:
    slave = odd()
    with pytest.raises(UserError) as caught:
        slave.variable("qqqqqqqqqq")
    known = [variable.name for variable in slave.description.modelVariables]
    assert caught.value.allowed == ", ".join(sorted(known))
    assert slave.has("slide.u", "level")
    assert not slave.has("slide.u", "qqqqqqqqqq")
