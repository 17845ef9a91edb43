"""Stands for the execution of a channel: commands go straight to what is registered for them."""

from typing import Any


class Program:
    """head: the command that is carried out. is_busy: what the program waits for, as registered."""

    def __init__(self, owner: Any) -> None:
        self.head: Any = None
        self._acts: dict[type, Any] = {}
        self._ready: dict[type, Any] = {}
        self.is_busy: Any = None
        owner.assign(self)

    def register(self, kind: type, act: Any, *, ready: Any = None) -> None:
        self._acts[kind], self._ready[kind] = act, ready

    def while_busy(self, is_busy: Any) -> None:
        self.is_busy = is_busy

    def say(self, *commands: Any) -> None:
        """Carry out commands, each of which has to be ready."""
        for self.head in commands:
            kind = type(self.head)
            assert self._ready[kind] is None or self._ready[kind]()
            self._acts[kind](self.head)
