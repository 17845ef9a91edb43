"""The non-volatile memory of virtual drives: what 1010 has stored, kept in a file over restarts."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from axisrig.bench.drive.cia402.dictionary.storage import ParameterStorage
from axisrig.kernel.errors import UserError


class ParameterFile:
    """One JSON file for all drives: `{"Z": {"1017:00": 500}}`; it need not exist yet.

    Raises UserError when the file is none of ours.
    """

    def __init__(self, path: Path, memories: Mapping[str, ParameterStorage]) -> None:
        self._path, self._memories = path, memories
        self._others: dict[str, Any] = {}
        if path.exists():
            self._load()
        self._kept = {name: memory.stored for name, memory in memories.items()}

    def _load(self) -> None:
        try:
            content = json.loads(self._path.read_text(encoding="utf-8"))
            self._others = {name: dict(values) for name, values in content.items()}
            for name, memory in self._memories.items():
                values = self._others.pop(name, {}).items()
                memory.load({_key(text): int(value) for text, value in values})
        except (ValueError, TypeError, AttributeError) as error:
            raise UserError(
                "no file of stored parameters", file=self._path, hint="name a new file"
            ) from error

    def look(self) -> bool:
        """Write the file when a drive has stored something; return whether it has."""
        stored = {name: memory.stored for name, memory in self._memories.items()}
        if stored == self._kept:
            return False
        self._kept = stored
        content = self._others | {
            name: {f"{index:04X}:{sub:02X}": value for (index, sub), value in sorted(kept.items())}
            for name, kept in stored.items()
        }
        text = json.dumps(content, indent=1, sort_keys=True)
        beside = self._path.with_name(f"{self._path.name}.tmp")
        beside.write_text(text + "\n", encoding="utf-8", newline="\n")
        beside.replace(self._path)  # whole or not at all, as a drive's memory is
        return True


def _key(text: str) -> tuple[int, int]:
    index, _, sub = text.partition(":")
    return int(index, 16), int(sub, 16)
