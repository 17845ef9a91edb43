"""Which cell of a plan, or which `--set`, made a rig impossible that is good without it."""

from collections.abc import Callable, Sequence
from pathlib import Path

from axisrig.bench.rig.reading.file import RigFile
from axisrig.bench.rig.settings import Assigned, Settings, read_settings
from axisrig.kernel.errors import UserError


def blamed(error: UserError, settings: Settings, check: Callable[[Settings], None]) -> UserError:
    """Return the error of `check` with the place of the assignment that caused it.

    That is the first one from which on the rig is refused for the same reason. The error stays as
    it is where the rig is refused without any, and where it was changed by more than assignments.
    """
    rig, files, assigned = settings.written, settings.files, settings.assigned

    def is_same(count: int) -> bool:
        again = _refusal(rig, files, assigned[:count], check)
        return again is not None and _reason(again) == _reason(error)

    count = len(assigned)
    if not count or not _blames_rig(error, settings) or not is_same(count):
        return error
    while count and is_same(count - 1):
        count -= 1
    if not count:
        return error
    assignment, located = assigned[count - 1]
    hint = f"{Path(error.file or files[-1]).name} is accepted without it"
    without_place = UserError(
        f"with {assignment.value}: {error.message}",
        value=error.value,
        allowed=error.allowed,
        hint="; ".join(text for text in (error.hint, hint) if text) or None,
    )
    found = located(without_place, assignment)
    found.further = error.further
    return found


def _blames_rig(error: UserError, settings: Settings) -> bool:
    """Whether the error names a file of the rig, or one of its lists, and no cell already."""
    rig = settings.written
    channel = rig.channel
    lists = [channel.list, channel.zero_offsets, channel.tools]
    lists += [axis.list for axis in rig.axis.values()]
    return error.file in [str(file) for file in (*settings.files, *lists)]


def _refusal(
    rig: RigFile,
    files: list[Path],
    assigned: Sequence[Assigned],
    check: Callable[[Settings], None],
) -> UserError | None:
    try:
        check(read_settings(rig, files, assigned))
    except UserError as error:
        return error
    return None


def _reason(error: UserError) -> tuple[object, ...]:
    """Return what stays of a refusal when other values of the rig change: not the arithmetic."""
    return error.file, error.line, error.message.partition("\n")[0]
