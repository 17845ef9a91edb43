"""Which plants of a rig are code from outside.

Ours are the models of the library, which the bench builds itself, and files with the very bytes of
one of them (`axisrig fmu build`; the cache keeps their hashes). Any other `.fmu` is foreign: it may
end or block its process, so that it runs in one of its own.
"""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

from axisrig.bench.rig.reading.file import PlantTable, read_rig
from axisrig.fmus import is_ours
from axisrig.kernel.errors import UserError


def foreign_plants(plants: Mapping[str, PlantTable]) -> list[str]:
    """Return the names of the plants whose FMU was not built here."""
    files = {table.fmu for table in plants.values() if table.fmu.endswith(".fmu")}
    foreign = {file for file in files if not is_ours(Path(file))}
    return [name for name, table in plants.items() if table.fmu in foreign]


def foreign_rigs(rigs: Iterable[Path]) -> set[Path]:
    """Return those of these rig files that have a foreign plant.

    A file that is no rig is left out: loading it reports what is wrong with it.
    """
    found = set()
    for path in set(rigs):
        with suppress(UserError, OSError):
            if foreign_plants(read_rig(path)[0].plant):
                found.add(path)
    return found
