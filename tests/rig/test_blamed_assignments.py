"""Which assignment is to blame for a refusal, by the file that was refused and by its order."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.refused_setting import blamed
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

RigWriter = Callable[..., Path]
Read = Callable[..., Settings]
LIMIT = "drive:servo.lag_limit_mm"
OFFSETS = '[channel]\nlist = "lists/channel.lst"\n'
LISTS = f'{OFFSETS}zero_offsets = "lists/offsets.lst"\ntools = "lists/tools.lst"\n'


def test_a_cell_is_to_blame_whichever_file_of_the_rig_is_refused(
    rig_file: RigWriter, settings_of: Read
) -> None:
    """The rig and what it stands on, and each of its lists; no other file, and none."""
    base = rig_file((OFFSETS, LISTS))
    lists = base.parent / "lists"
    for name in ("offsets", "tools"):
        (lists / f"{name}.lst").write_text("", encoding="utf-8")
    rig = base.with_name("above.toml")
    rig.write_text('base = "rig.toml"\n', encoding="utf-8")
    settings = settings_of(rig, f"{LIMIT}=1", f"{LIMIT}=2", f"{LIMIT}=3")

    def refused(file: Path | None, further: tuple[UserError, ...] = ()) -> UserError:
        error = UserError("too long", file=file, line=4, value=7, allowed="less", hint="make room")
        error.further = further

        def check(again: Settings) -> None:
            if drive_of(again, "Z").lag_limit_mm >= 2.0:
                raise error

        return blamed(error, settings, check)

    names = ("channel", "offsets", "tools", "axis-z")
    files = [rig, base, *(lists / f"{name}.lst" for name in names)]
    also = (UserError("and wide"),)
    for file in files:
        found = refused(file, also)
        assert (found.message, found.file) == (f"--set {LIMIT}=2: with 2: too long", None), file
        assert (found.value, found.allowed, found.further) == (7, "less", also)
        assert found.hint == f"make room; {file.name} is accepted without it"
    for other in (lists / "axis-x.lst", base.with_name("rig"), None):
        found = refused(other)
        assert (found.message, found.file) == ("too long", None if other is None else str(other))


@pytest.mark.parametrize(
    ("refused_from", "values", "guilty"),
    [
        (2, (1, 2, 3), 2),  # from which on it is refused
        (2, (3, 1, 2), 2),  # what was mended between is not to blame
        (2, (3, 2, 2), 3),
        (3, (3,), 3),
        (0, (1, 2), None),  # refused without any
        (9, (1, 2), None),  # not refused by assignments alone
    ],
)
def test_the_assignment_from_which_on_a_rig_is_refused_is_to_blame(
    rig_file: RigWriter,
    settings_of: Read,
    refused_from: int,
    values: tuple[int, ...],
    guilty: int | None,
) -> None:
    """The second line of a message is arithmetic, which other values of the rig change."""
    path = rig_file()
    settings = settings_of(path, *(f"{LIMIT}={value}" for value in values))

    def check(again: Settings) -> None:
        limit_mm = drive_of(again, "Z").lag_limit_mm
        if limit_mm >= refused_from:
            raise UserError(f"too long\n{limit_mm} mm", file=path, line=4)
        if limit_mm == 1.0:  # for another reason
            raise UserError("too short", file=path, line=4)

    error = UserError("too long\nso many mm", file=path, line=4)
    found = blamed(error, settings, check)
    if guilty is None:
        assert found is error
    else:
        assert found.message.startswith(f"--set {LIMIT}={guilty}: with {guilty}: too long")
        assert found.hint == "rig.toml is accepted without it"
    for other in (UserError("too long", file=path, line=5), UserError("long", file=path, line=4)):
        assert blamed(other, settings, check) is other
    bare = settings_of(path)
    assert blamed(error, bare, check) is error
