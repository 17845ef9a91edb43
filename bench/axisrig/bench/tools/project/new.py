"""`axisrig new DIR`: rig, plan, program, model, pytest and CI files in an empty folder."""

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from axisrig.kernel.errors import UserError

PLAN = "testplans/touch.csv"
CARRIERS = {"can": None, "ethercat": "on_ethercat"}
"""What may carry the drive, and the folder of the files that are others there."""
_DOT = "dot-"
"""Begins the name of a file or folder that begins with a dot in the project."""


def new_project(folder: Path, carrier: str = "can") -> list[Path]:
    """Write the files of a new project and return them. carrier: of the words of its drive.

    Raises UserError where the folder holds something already and for another carrier, OSError where
    it cannot be written.
    """
    if carrier not in CARRIERS:
        raise UserError("there is no project for it", value=carrier, allowed=list(CARRIERS))
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise UserError("the folder is not empty", file=folder, hint="name a new one")
    here = resources.files(__package__)
    made = _copied(here.joinpath("template"), folder)
    others = CARRIERS[carrier]
    if others is not None:
        _copied(here.joinpath(others), folder)
    return made


def _copied(source: Traversable, folder: Path) -> list[Path]:
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for item in sorted(source.iterdir(), key=lambda entry: entry.name):
        name = item.name
        path = folder / (f".{name.removeprefix(_DOT)}" if name.startswith(_DOT) else name)
        if item.is_dir():
            made += _copied(item, path)
        elif not name.endswith(".pyc"):
            path.write_bytes(item.read_bytes())
            made.append(path)
    return made
