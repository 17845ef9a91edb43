"""The functions of an FMU's library as fmpy calls them, each bound when it is called first.

fmpy binds all of a standard's functions whenever it loads an FMU, and reads their signatures from
its own methods for that: a quarter of a short run, for some ten functions that are called.
"""

import ctypes
import inspect
from collections.abc import Sequence
from functools import cache
from types import UnionType
from typing import Any, NamedTuple, get_args

from axisrig.kernel.cosim.fmi.library import Library


class Signature(NamedTuple):
    """A C function: names and ctypes types of its arguments, type of its result (None: void)."""

    argument_names: Sequence[str]
    argument_types: Sequence[Any]
    result_type: Any


class Functions(dict[str, Any]):
    """Functions by name for fmpy's `_functions`; bound at the first access.

    kind: fmpy's class, whose methods have the signatures. library: of the FMU.
    """

    def __init__(self, kind: type, library: Library) -> None:
        super().__init__()
        self._kind, self._library = kind, library

    def __missing__(self, name: str) -> Any:
        signature = signature_of(self._kind, name)
        function = getattr(self._library, name)
        function.argnames = signature.argument_names
        function.argtypes = signature.argument_types
        function.restype = signature.result_type
        self[name] = function
        return function


@cache
def signature_of(kind: type, name: str) -> Signature:
    """Return the signature of a function from the annotations of fmpy's method of that name."""
    method = inspect.signature(getattr(kind, name))
    parameters = list(method.parameters.values())[1:]  # without self
    result = {bytes: ctypes.c_char_p, int: ctypes.c_int}.get(
        method.return_annotation, method.return_annotation
    )
    return Signature(
        [parameter.name for parameter in parameters],
        [_first(parameter.annotation) for parameter in parameters],
        result,
    )


def _first(annotation: Any) -> Any:
    """Return the C type of a union with what Python may hand over."""
    return get_args(annotation)[0] if isinstance(annotation, UnionType) else annotation


def with_signature(function: Any, signature: tuple[Any, ...]) -> Any:
    """Return a function of a library that returns a status, to be called without a conversion.

    signature: ctypes types of the arguments. The interpreter lock is kept during a call.
    """
    address = ctypes.cast(function, ctypes.c_void_p).value
    assert address is not None
    return _prototype(signature)(address)


@cache
def _prototype(signature: tuple[Any, ...]) -> Any:
    """Return the type of such a function; ctypes would make a new one each time."""
    return ctypes.PYFUNCTYPE(ctypes.c_int, *signature)
