"""Two serial-line CAN adapters on one bus, as two pseudo-terminals: a stand-in for hardware.

Prints the two device names, then acts as the adapters until its standard input ends. What one
host sends while its channel is open reaches the other when that channel is open too. The commands
are those of Lawicel's ASCII protocol: S, s, O, L, C, t, T, r, R, V, N; anything else gets a bell.
"""

import os
import select
import sys
import tty

OK, BELL = b"\r", b"\a"


class Adapter:
    """One adapter: the master side of a pseudo-terminal."""

    def __init__(self) -> None:
        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.name = os.ttyname(self._slave)  # the slave stays open, so that the device does
        self.received = b""
        self.is_open = self.may_send = False
        self.other: Adapter

    def read(self) -> None:
        *lines, self.received = (self.received + os.read(self.master, 65536)).split(b"\r")
        for line in lines:
            os.write(self.master, self.act(line))

    def act(self, line: bytes) -> bytes:
        command = line[:1]
        if command in (b"O", b"L"):
            self.is_open, self.may_send = True, command == b"O"
        elif command == b"C":
            self.is_open = False
        elif command in (b"t", b"T", b"r", b"R"):
            if not (self.is_open and self.may_send and is_frame(line)):
                return BELL
            if self.other.is_open:
                os.write(self.other.master, line + b"\r")
            return (b"z" if command in b"tr" else b"Z") + OK
        elif command == b"V":
            return b"V1013\r"
        elif command == b"N":
            return b"NA123\r"
        elif command not in (b"S", b"s", b""):
            return BELL
        return OK


def is_frame(line: bytes) -> bool:
    digits = 3 if line[:1] in b"tr" else 8
    try:
        int(line[1 : 1 + digits], 16)
        length = int(line[1 + digits : 2 + digits])
        data = bytes.fromhex(line[2 + digits :].decode("ascii"))
    except ValueError:
        return False
    return len(data) == (0 if line[:1] in b"rR" else length) and length <= 8


def main() -> None:
    left, right = Adapter(), Adapter()
    left.other, right.other = right, left
    print(left.name, right.name, flush=True)
    while True:
        ready, _, _ = select.select([sys.stdin, left.master, right.master], [], [])
        for adapter in (left, right):
            if adapter.master in ready:
                adapter.read()
        if sys.stdin in ready and not sys.stdin.buffer.read1(1):
            return


if __name__ == "__main__":
    main()
