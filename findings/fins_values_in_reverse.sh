#!/usr/bin/env bash
# omronfins 1.0.3 reads several values of 32 bits from an Omron controller in the reverse order.
#
# A controller holds positions of 1000, -2000 and 3000 from word 100 on, two words each with the low word first, and speeds of 1.5 and 2.5. The guess: a value that is written is there
# again, and three that are read at once come in the order in which they lie, as values of 16 bits do (FINS commands reference, memory area read; the package promises a
# tuple of values). What comes: one value is right, two or three are in reverse, REAL as well as DINT, as all words that came are turned around and not those of each value. Two
# positions in one command are sent with a count of two, that is of words, and four words behind it; the controller refuses that (end code 1003, elements do not match).
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check omronfins==1.0.3
cd "$work"
cat >try.py <<'PYTHON'
import socket
import struct
import threading

from omronfins.finsudp import FinsUDP, datadef


class Controller:
    """The data memory of a controller: words, read and written by FINS over UDP."""

    def __init__(self):
        self.words = {}
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            request, asker = self.socket.recvfrom(4096)
            address, count = struct.unpack(">HxH", request[13:18])
            end, data = 0x0000, b""
            if request[10:12] == b"\x01\x01":
                data = b"".join(struct.pack(">H", self.words.get(address + word, 0)) for word in range(count))
            elif len(request) - 18 != 2 * count:
                end = 0x1003
            else:
                self.words.update(enumerate(struct.unpack(f">{count}H", request[18:]), address))
            self.socket.sendto(b"\xc0" + request[1:12] + struct.pack(">H", end) + data, asker)


controller = Controller()
fins = FinsUDP(0, 170)
fins.open("127.0.0.1", controller.socket.getsockname()[1])
fins.set_destination(0, 13)
area = datadef.DM_WORD
for word, value, kind in ((100, 1000, datadef.LONG), (102, -2000, datadef.LONG), (104, 3000, datadef.LONG), (110, 1.5, datadef.FLOAT), (112, 2.5, datadef.FLOAT)):
    fins.write_mem_area(area, word, 0, 2, (value, kind))
print("words of 1000 and -2000:", *(f"{controller.words[word]:04x}" for word in range(100, 104)))
for name, kind, words, start in (("LONG", datadef.LONG, (2, 4, 6), 100), ("FLOAT", datadef.FLOAT, (2, 4), 110), ("SHORT", datadef.SHORT, (1, 2), 100)):
    for count in words:
        print(f"{name}, {count} words:", fins.read_mem_area(area, start, 0, count, kind)[1])
end = fins.write_mem_area(area, 120, 0, 2, [(5, datadef.LONG), (6, datadef.LONG)])
print(f"two positions in one command: end code {end:04x}, word 120 is", controller.words.get(120))
end = fins.write_mem_area(area, 130, 0, 2, [(5, datadef.SHORT), (6, datadef.SHORT)])
print(f"two words in one command: end code {end:04x}, word 130 is", controller.words.get(130))
PYTHON
cat >expected <<'TEXT'
words of 1000 and -2000: 03e8 0000 f830 ffff
LONG, 2 words: 1000
LONG, 4 words: (-2000, 1000)
LONG, 6 words: (3000, -2000, 1000)
FLOAT, 2 words: 1.5
FLOAT, 4 words: (2.5, 1.5)
SHORT, 1 words: 1000
SHORT, 2 words: (1000, 0)
two positions in one command: end code 1003, word 120 is None
two words in one command: end code 0000, word 130 is 5
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
