"""How far a file has been read, so that who waits for it can see a reader that stands still."""

import gzip
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, cast

GZIP = ".gz"


@dataclass
class Progress:
    """frames: read until now. file: what they are read from, None before."""

    frames: int = 0
    file: BinaryIO | None = None

    @property
    def place(self) -> tuple[int, int]:
        """Frames and bytes that were read; the same again: nothing has come since."""
        is_open = self.file is not None and not self.file.closed
        return self.frames, self.file.tell() if is_open and self.file is not None else 0


def opened(path: Path, progress: Progress) -> BinaryIO:
    """Open a file, or what is inside of a .gz. Raises OSError."""
    is_packed = path.suffix.lower() == GZIP
    progress.file = cast(BinaryIO, gzip.GzipFile(path)) if is_packed else path.open("rb")
    return progress.file


def suffix_of(path: Path) -> str:
    """Return the suffix in lower case, of `x.log.gz` that inside."""
    inner = path.with_suffix("") if path.suffix.lower() == GZIP else path
    return inner.suffix.lower()
