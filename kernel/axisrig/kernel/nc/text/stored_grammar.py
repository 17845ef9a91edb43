"""The grammar of a block, with its tables from the user's cache folder.

To make the tables from the text costs ten times as much as to read them. A file is found by the
hash of everything its content depends on, and begins with the hash of its content: a damaged one
is written again. Where the folder cannot be read or written, the tables are made at every start.
"""

import hashlib
import os
import sys
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Any

import lark
import platformdirs

_DIGEST_BYTES = 32


def stored_grammar(
    text: str, options: Mapping[str, Any], transformer: Any, folder: Path | None = None
) -> lark.Lark:
    """Return the parser of the grammar `text`, equal to `lark.Lark(text, **options)`.

    options: plain values only. transformer: what builds the results. folder: of the tables, by
    default `grammar` in the user's cache folder of axisrig.
    """
    file = (folder or _default_folder()) / f"{_key(text, options)}.tables"
    tables = _read(file)
    if tables is not None:
        # `Lark.load` has no argument for the transformer
        return lark.Lark.__new__(lark.Lark)._load(BytesIO(tables), transformer=transformer)
    grammar = lark.Lark(text, **options, transformer=transformer)
    stream = BytesIO()
    grammar.save(stream, exclude_options=("transformer",))
    _write(file, stream.getvalue())
    return grammar


def _default_folder() -> Path:
    return Path(platformdirs.user_cache_dir("axisrig")) / "grammar"


def _key(text: str, options: Mapping[str, Any]) -> str:
    parts = (text, repr(sorted(options.items())), lark.__version__, sys.version)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]


def _read(file: Path) -> bytes | None:
    """Return the tables of a file; None when it is missing, damaged or somebody else's."""
    try:
        if hasattr(os, "getuid") and file.stat().st_uid != os.getuid():
            return None
        content = file.read_bytes()
    except OSError:
        return None
    digest, tables = content[:_DIGEST_BYTES], content[_DIGEST_BYTES:]
    return tables if hashlib.sha256(tables).digest() == digest else None


def _write(file: Path, tables: bytes) -> None:
    """Put the file in place at once, so that no other process reads half of it."""
    with suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=".tables-", dir=file.parent)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(hashlib.sha256(tables).digest() + tables)
            Path(name).replace(file)
        except OSError:
            Path(name).unlink(missing_ok=True)
            raise
