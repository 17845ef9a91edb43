"""Functions of an FMU's library, bound at their first call as fmpy binds all at once."""

from types import SimpleNamespace
from typing import Any

import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from axisrig.kernel.cosim.fmi.binding import Functions, signature_of
from axisrig.kernel.cosim.fmi.library import Library
from axisrig.kernel.errors import UserError


class Symbols:
    """A library with every function."""

    _handle = 0

    def __init__(self) -> None:
        self.asked: dict[str, SimpleNamespace] = {}

    def __getattr__(self, name: str) -> SimpleNamespace:
        return self.asked.setdefault(name, SimpleNamespace())


@pytest.mark.parametrize(("kind", "count"), [(FMU2Slave, 34), (FMU3Slave, 75)])
def test_every_signature_is_the_one_that_fmpy_binds(kind: Any, count: int) -> None:
    fmu = kind.__new__(kind)
    fmu.dll, fmu._functions = Symbols(), {}
    fmu._loadFunctions()
    assert len(fmu._functions) == count
    for name, bound in fmu._functions.items():
        own = signature_of(kind, name)
        expected = (bound.argnames, bound.argtypes, bound.restype)
        assert (own.argument_names, own.argument_types, own.result_type) == expected


def test_a_function_is_looked_for_when_it_is_called_first() -> None:
    symbols = Symbols()
    functions = Functions(FMU3Slave, Library(symbols))
    assert symbols.asked == {}
    assert functions["fmi3Reset"] is functions["fmi3Reset"]
    assert list(symbols.asked) == ["fmi3Reset"]


def test_a_function_that_the_library_lacks_is_named_when_it_is_called() -> None:
    functions = Functions(FMU3Slave, Library(SimpleNamespace(_handle=0)))
    with pytest.raises(UserError, match="no function fmi3Reset"):
        functions["fmi3Reset"](0)
