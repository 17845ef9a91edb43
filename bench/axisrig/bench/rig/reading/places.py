"""Where the keys of a rig are in its files."""

import re
from pathlib import Path


def locate(files: list[Path], keys: tuple[str, ...]) -> tuple[Path, int | None]:
    """Find file and line of a key path: its own line, else the header of its table."""
    for depth in range(len(keys), 0, -1):
        table, key = ".".join(keys[: depth - 1]), keys[depth - 1]
        for file in files:
            line = _find_key(file.read_text(encoding="utf-8-sig"), table, key)
            if line is not None:
                return file, line
    return files[0], None


def _find_key(text: str, table: str, key: str) -> int | None:
    current = ""
    wanted = f"{table}.{key}" if table else key
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[([^\[\]]+)\]", line)
        if header:
            current = re.sub(r"[\s\"']", "", header[1])
            if current == wanted or current.startswith(f"{wanted}."):
                return number
        elif current == table and re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*[.=]", line):
            return number
    return None
