"""FMUs that a process keeps loaded: the next machine resets one in place of loading it anew.

Only those that this version builds are kept, for it is known that their reset leaves nothing of
the run before; an FMU of another tool is loaded anew for every machine.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from axisrig.bench.rig.reading.file import PlantTable
from axisrig.kernel.cosim.fmi import journal
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu
from axisrig.kernel.cosim.fmi.reset import reset, set_aside
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.plant.plant import Plant

KEPT_MAX = 32
"""FMUs that a process keeps, some 50 KB each."""
ROLES_MAX = 8


@dataclass
class _Kept:
    """An instance, and which roles it fills in the eyes of which tables.

    state: of its file when it was loaded. is_watched: its calls are noted (`journal`). handle: of
    the instance while it is not in use.
    """

    slave: FmuSlave
    state: object
    is_watched: bool
    handle: int = 0
    roles: list[tuple[PlantTable, Roles]] = field(default_factory=list)


_kept: OrderedDict[tuple[Path, str], _Kept] = OrderedDict()


def take_fmu(path: Path, name: str) -> FmuSlave:
    """Return an instance `name` of an FMU that this version has built, as new.

    Raises UserError for an FMU that cannot be used.
    """
    key, state, is_watched = (path, name), _state(path), journal.is_open()
    kept = _kept.get(key)
    if kept is not None and not (kept.handle or kept.slave.pointer):
        del _kept[key]  # somebody has closed it
        kept = None
    if kept is not None and kept.handle:
        handle, kept.handle = kept.handle, 0
        is_same = kept.state == state and kept.is_watched == is_watched
        if reset(kept.slave, handle) and is_same:
            _kept.move_to_end(key)
            return kept.slave
        kept.slave.close()
        del _kept[key]
    slave = load_fmu(path, name)
    slave.is_own = True
    if key not in _kept:  # else another machine has it
        _kept[key] = _Kept(slave, state, is_watched)
    return slave


def roles_of(slave: FmuSlave, table: PlantTable, find: Callable[[], Roles]) -> Roles:
    """Return the roles that an instance fills by a table of the rig; find: finds them out.

    Raises what `find` raises.
    """
    kept = _kept.get((slave.path, slave.name))
    if kept is None or kept.slave is not slave:
        return find()
    for known, roles in kept.roles:
        if known is table or known == table:
            return roles
    roles = find()
    kept.roles = [*kept.roles[-ROLES_MAX + 1 :], (table, roles)]
    return roles


def close_plant(plant: Plant) -> None:
    """End the FMUs of a machine; those that may be used again stay loaded."""
    for axis in plant.axes.values():
        axis.forget()
    close_fmus(axis.slave for axis in plant.axes.values())
    close_fmus(probe.slave for probe in plant.probes.values())
    close_fmus(sensor.slave for sensor in plant.distances.values())


def close_fmus(slaves: Iterable[FmuSlave]) -> None:
    """End these FMUs; those that may be used again stay loaded."""
    for slave in dict.fromkeys(slaves):
        kept = _kept.get((slave.path, slave.name))
        if kept is None or kept.slave is not slave:
            slave.close()
        elif slave.pointer:
            kept.handle = set_aside(slave)
            if not kept.handle:
                slave.close()
                del _kept[slave.path, slave.name]
    unused = [key for key, kept in _kept.items() if kept.handle]
    for key in unused[: max(len(_kept) - KEPT_MAX, 0)]:
        _drop(key)


def forget() -> None:
    """Free every instance that is kept and not in use."""
    for key in [key for key, kept in _kept.items() if kept.handle]:
        _drop(key)


def _drop(key: tuple[Path, str]) -> None:
    kept = _kept.pop(key)
    kept.slave.pointer = kept.handle
    kept.slave.close()


def _state(path: Path) -> object:
    try:
        found = path.stat()
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino
