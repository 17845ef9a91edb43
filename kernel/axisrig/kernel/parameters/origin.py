"""Where a setting was written."""

from dataclasses import dataclass
from pathlib import Path

from axisrig.kernel.errors import UserError


@dataclass(frozen=True)
class Origin:
    """The place of a setting: a file and, where there are any, line and column from 1."""

    file: str
    line: int | None = None
    column: int | None = None

    @property
    def short(self) -> str:
        """Name of the file and line."""
        name = Path(self.file).name if self.line is not None else self.file
        return name if self.line is None else f"{name}:{self.line}"

    def error(
        self,
        message: str,
        *,
        value: object = None,
        allowed: str | None = None,
        hint: str | None = None,
    ) -> UserError:
        """Build the error that names this place."""
        return UserError(
            message,
            file=self.file,
            line=self.line,
            column=self.column,
            value=value,
            allowed=allowed,
            hint=hint,
        )
