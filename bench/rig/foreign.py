"""Which plants of a rig are code from outside.

Ours are the models of the library, which the bench builds itself, and files with the very bytes of
one of them (`axisrig fmu build`; the cache keeps their hashes). Any other `.fmu` is foreign: it may
end or block its process, so that it runs in one of its own.
"""

from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from bench.rig.file import read_rig
from fmus import is_ours
from kernel.errors import UserError


def foreign_rigs(rigs: Iterable[Path]) -> set[Path]:
    """Return those of these rig files that name an FMU that was not built here.

    A file that is no rig is left out: whoever loads it says what is wrong with it.
    """
    found = set()
    for path in set(rigs):
        with suppress(UserError, OSError):
            plants = read_rig(path)[0].plant.values()
            files = {Path(table.fmu) for table in plants if table.fmu.endswith(".fmu")}
            if not all(is_ours(file) for file in files):
                found.add(path)
    return found
