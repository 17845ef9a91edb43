"""The idents of a drive (`idents.csv`): their elements, their values at power on, and lists."""

import csv
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from importlib import resources
from typing import Final

from axisrig.bench.drive.sercos.profiles import SercosProfile
from axisrig.bench.drive.sercos.service_channel import STATES, Ident
from axisrig.kernel.profiles.sercos.service import (
    Attribute,
    Kind,
    ident_number,
    pack_list,
    pack_text,
    read_list,
)

COMMAND: Final = "command"
_IGNORED: Final = "ignored"
_LIVE: Final = "@"
"""Mark of a value that the drive works out; others with a name are those of the process image."""
Row = Mapping[str, str]


@cache
def rows() -> Sequence[Row]:
    """Read the table."""
    text = resources.files(__package__).joinpath("idents.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def rows_of(profile: SercosProfile) -> list[Row]:
    """Return the rows of what a drive has."""
    return [row for row in rows() if row["drives"] == "both" or profile.probes > 1]


class Idents:
    """All idents of a drive. table: by their words.

    live: values that the drive works out, by their names. value_of(name): one of the process image.
    check(ident, number): name of the code that refuses a value, None. changed(ident): is called
    after a write.
    """

    def __init__(
        self,
        profile: SercosProfile,
        live: Mapping[str, Callable[[], int]],
        value_of: Callable[[str], int],
        check: Callable[[int, int], str | None],
        changed: Callable[[int], None],
    ) -> None:
        self._profile = profile
        self._live, self._value_of, self._check, self._changed = live, value_of, check, changed
        self.table: dict[int, Ident] = {}
        for row in rows_of(profile):
            self.table[ident_number(row["ident"])] = self._make(row)
        self.reset()

    def _make(self, row: Row) -> Ident:
        number, form = ident_number(row["ident"]), row["form"]
        kind = Kind[row["kind"].upper()]
        is_open = form in ("list", "text")
        attribute = Attribute(
            kind,
            int(row["bytes"]),
            is_list=form == "list",
            is_command=form == COMMAND,
            protected=("2" in row["protected"], "3" in row["protected"], "4" in row["protected"]),
        )
        name, is_acting = row["value"], row["access"] != _IGNORED
        live: Callable[[], int] | None = None
        if name.startswith(_LIVE):
            live = self._live[name.removeprefix(_LIVE)]
        elif name:
            live = partial(self._value_of, name)
        return Ident(
            attribute,
            b"",
            row["name"],
            row["unit"],
            None if is_open or not row["minimum"] else int(row["minimum"]),
            None if is_open or not row["maximum"] else int(row["maximum"]),
            is_read_only=row["access"] == "ro",
            capacity=int(row["maximum"]) * attribute.width if is_open else 0,
            live=live,
            check=partial(self._check, number) if is_acting else _takes_all,
            changed=partial(self._changed, number) if is_acting else _does_nothing,
        )

    def reset(self) -> None:
        """Give every ident its value at power on."""
        for row in rows_of(self._profile):
            ident = self.table[ident_number(row["ident"])]
            ident.state = STATES["IDLE"]
            if row["form"] == "list":
                self.put_list(ident_number(row["ident"]), self._default_list(row["default"]))
            elif row["form"] == "text":
                ident.value = pack_text(row["default"], ident.capacity)
            else:
                profile = self._profile
                text = row["default"].format(
                    scaling=profile.scaling,
                    resolution=profile.resolution,
                    linear_factor=profile.linear_factor,
                    linear_exponent=profile.linear_exponent,
                )
                ident.value = ident.pack(int(text, 0))

    def _default_list(self, text: str) -> list[int]:
        names = [(row["ident"], row["form"]) for row in rows_of(self._profile)]
        if text == "@all":
            return [ident_number(name) for name, _ in names]
        if text == "@commands":
            return [ident_number(name) for name, form in names if form == COMMAND]
        return [int(word) if word.isdecimal() else ident_number(word) for word in text.split()]

    def number(self, ident: int) -> int:
        """Return the value of an ident that has no length of its own."""
        found = self.table[ident]
        return found.number(found.value) if found.live is None else found.live()

    def put(self, ident: int, number: int) -> None:
        """Give an ident a value."""
        self.table[ident].value = self.table[ident].pack(number)

    def items(self, ident: int) -> list[int]:
        """Return the items of a list."""
        found = self.table[ident]
        return read_list(found.value, found.attribute.width)

    def put_list(self, ident: int, items: Sequence[int]) -> None:
        """Give a list its items."""
        found = self.table[ident]
        width = found.attribute.width
        found.value = pack_list(items, width, found.capacity // width)


def _takes_all(_number: int) -> None:
    return None


def _does_nothing() -> None:
    """A cyclic value: a write over the service channel changes nothing."""
