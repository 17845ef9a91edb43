"""What a program wants of its drives: functions, idents, commands (part of `canon`)."""

from dataclasses import dataclass

from axisrig.kernel.nc.block import Block


@dataclass(frozen=True)
class DriveWrite:
    """A value for a drive function (#DRIVE) or an ident (#IDENT), given out when it is due.

    waits: nothing goes on before the drive has taken it. length_bytes: of an ident (TYP), None for
    a drive function. value: of an ident in its smallest digits. is_command: the ident has to be a
    procedure command (#COMMAND).
    """

    block: Block
    axis: str
    key: str
    value: float
    waits: bool
    length_bytes: int | None = None
    is_command: bool = False

    @property
    def word(self) -> str:
        """The command as programs write it."""
        if self.is_command:
            return "#COMMAND WR"
        return "#DRIVE WR" if self.length_bytes is None else "#IDENT WR"


@dataclass(frozen=True)
class DriveRead:
    """The value of a drive function or an ident is asked for; nothing goes on before it is here.

    length_bytes: as in `DriveWrite`.
    """

    block: Block
    axis: str
    key: str
    length_bytes: int | None = None


@dataclass(frozen=True)
class DriveWait:
    """Nothing goes on before the drive has taken every earlier `DriveWrite`.

    commands: nor before its procedure commands have ended (#COMMAND). key: this one; empty = all.
    """

    block: Block
    axis: str
    commands: bool = False
    key: str = ""
