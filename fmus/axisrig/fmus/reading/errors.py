"""The one reason for which an FMU is not built."""

from pathlib import Path


class BuildError(Exception):
    """A model cannot become an FMU here, with a message by which its author can correct it.

    file, line: where in the library (line counts from 1), None when it is no matter of a file.
    message: what is wrong, one sentence without full stop.
    """

    def __init__(self, file: str | Path | None, line: int | None, message: str) -> None:
        self.file = None if file is None else str(file)
        self.line = line
        self.message = message
        place = ":".join(str(part) for part in (self.file, self.line) if part is not None)
        super().__init__(f"{place}: {message}" if place else message)

    def __reduce__(self) -> tuple[type["BuildError"], tuple[str | None, int | None, str]]:
        """Let the error of a build in another process come back as it is."""
        return BuildError, (self.file, self.line, self.message)
