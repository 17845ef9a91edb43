"""FMUs of the library that come with a wheel, so that nothing is built where it is installed.

`shipped/keys.json` has for each model the key of the sources that its FMU was built from and the
hash of the file. A shipped FMU is used as long as both fit: whoever edits a model or the exporter
gets one that is built anew. Compiler and rumoca are not in this key: they are not needed.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent / "shipped"
KEYS = "keys.json"


@dataclass(frozen=True)
class Shipped:
    """An FMU of the wheel. key: of its sources (`source_key`). sha256: of the file."""

    path: Path
    key: str
    sha256: str


@cache
def shipped(folder: Path = FOLDER) -> Mapping[str, Shipped]:
    """Return the FMUs that came with this installation by model; empty for a checkout."""
    file = folder / KEYS
    if not file.is_file():
        return {}
    rows = json.loads(file.read_text(encoding="utf-8"))
    return {
        model: Shipped(folder / row["file"], row["key"], row["sha256"])
        for model, row in rows.items()
    }


def is_whole(one: Shipped) -> bool:
    """Return whether the file of a shipped FMU is there, byte for byte."""
    return one.path.is_file() and sha256_of(one.path) == one.sha256


def sha256_of(path: Path) -> str:
    """Return the hash of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
