"""What the elements of the HLI have in common: names, types, ranges, and what a program reads.

A program uses `axisrig.bench.machine.plc.hli` alone.
"""

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any, TypeVar

from axisrig.kernel.errors import UserError

SGN32, SGN64 = range(-(2**31), 2**31), range(-(2**63), 2**63)

_Key = TypeVar("_Key")
_Value = TypeVar("_Value")


class UnknownNameError(KeyError):
    """A program asks for something that is not there; what: in words. known: the names there are.

    It is a KeyError, so that a program may catch it as one.
    """

    def __init__(self, what: str, name: object, known: Iterable[object]) -> None:
        super().__init__(name)
        self.what, self.name, self.known = what, name, list(known)


class Named(dict[_Key, _Value]):
    """Things by name; what: one of them in words. Raises UnknownNameError for another name."""

    __slots__ = ("_what",)

    def __init__(self, what: str, items: Mapping[_Key, _Value]) -> None:
        super().__init__(items)
        self._what = what

    def __missing__(self, key: _Key) -> _Value:
        """Say which names there are."""
        raise UnknownNameError(self._what, key, self)


class Kept:
    """Something whose elements a program may neither add nor delete.

    Raises AttributeError with name and object for one that is not there, so that a program may ask
    by hasattr.
    """

    __slots__ = ()

    def __setattr__(self, element: str, value: Any) -> None:
        """Set an element that is there."""
        put(self, element, value)

    def __delattr__(self, element: str) -> None:
        """Refuse it. Raises UserError."""
        raise UserError(f"{element} of the HLI cannot be deleted", hint="set it to False or 0")


def put(holder: Kept, element: str, value: Any) -> None:
    """Set an element that is there; raises AttributeError for another one."""
    if element not in type(holder).__slots__:
        raise AttributeError(f"no element {element}", name=element, obj=holder)
    object.__setattr__(holder, element, value)


def out_of_range(name: str, value: int, allowed: range) -> UserError:
    """Make the error of a number that is out of its range."""
    return UserError(
        f"{name} is out of its range",
        value=value,
        allowed=f"{allowed.start} .. {allowed.stop - 1}",
    )


def replaced(what: str, found: object, elements: str) -> UserError:
    """Make the error of something else in the place of a part of the HLI."""
    return UserError(f"{what} has been replaced", value=found, hint=f"set {elements}")


def require_number(name: str, value: Any) -> None:
    """Raise UserError for a variable that is set to no number."""
    if type(value) not in (int, float) or not isfinite(value):
        raise UserError(f"V.E.{name} has a wrong type", value=value, allowed="a number")


def require(name: str, value: Any, kind: type) -> None:
    """Raise UserError for an element that is set to another type."""
    if type(value) is not kind:
        words = {bool: "True or False", int: "a whole number"}
        raise UserError(f"{name} has a wrong type", value=value, allowed=words[kind])
