"""Top-level packages of an older axisrig that can still be imported, and what to do about them.

axisrig installed `kernel`, `bench`, `fmus` and `reports` at the top level until its packages got
the one name `axisrig`. A package of another project with such a name is none of ours.
"""

import sys
from collections.abc import Iterable
from importlib import metadata
from pathlib import Path

SIGNS = {
    "kernel": "channel/reactions.py",
    "bench": "rig/machine.py",
    "fmus": "AxisRig/package.mo",
    "reports": "fixed_stop/__init__.py",
}
"""Name of an old package -> a file that only ours had."""


def leftovers(search_path: Iterable[str] | None = None) -> list[str]:
    """Return one message for each folder of the search path (default: sys.path) with leftovers."""
    entries = sys.path if search_path is None else search_path
    folders = dict.fromkeys(Path(entry).absolute() for entry in entries)
    return [text for folder in folders if (text := _message(folder))]


def _message(folder: Path) -> str | None:
    """Return what an older axisrig has left in a folder, with the remedy; None: nothing."""
    recorded = _recorded(folder)
    names = [n for n, sign in SIGNS.items() if n in recorded or _is_file(folder / n / sign)]
    if not names:
        return None
    if recorded:
        remedy = "run `python -m pip uninstall axisrig`, then install axisrig again"
    else:
        remedy = "remove them, or take this folder off the search path (PYTHONPATH, .pth files)"
    now = ", ".join(f"axisrig.{name}" for name in names)
    return f"{folder}: {', '.join(names)} of an older axisrig (now {now}): {remedy}"


def _recorded(folder: Path) -> set[str]:
    """Return the old packages that an axisrig installed into a folder lists and that are there."""
    names: set[str] = set()
    for distribution in metadata.distributions(name="axisrig", path=[str(folder)]):
        listed = {str(file) for file in distribution.files or ()}
        names |= {n for n in SIGNS if f"{n}/__init__.py" in listed}
    return {name for name in names if _is_file(folder / name / "__init__.py")}


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except OSError:  # the search path may name folders that this user may not read
        return False
