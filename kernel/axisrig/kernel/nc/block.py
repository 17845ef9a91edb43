"""The block of a program: where everything that it makes comes from."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Block:
    """Where a command comes from.

    line, column: where the block begins, from 1. number: the N number, None without one.
    text: the block as written, on one line. file: None where the text has none.
    """

    line: int
    number: int | None
    text: str
    column: int = field(default=1, compare=False)
    file: str | None = field(default=None, compare=False)

    @property
    def place(self) -> str:
        """Where an alarm of this block comes up: with the file, since a program may call others."""
        return str(self) if self.file is None else f"{self.file} {self}"

    def __str__(self) -> str:
        number = "" if self.number is None else f", block N{self.number}"
        return f"line {self.line}{number}"
