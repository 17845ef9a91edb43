#!/usr/bin/env bash
# kickcat 2.5 does not take an abort of an SDO with the CoE service that its own slave gives to it.
#
# An abort is a request of its own, also when a slave sends it: service 2 (ETG.1000.6, Abort SDO Transfer Request). SOES and
# the slave of KickCAT send it so, and the IgH master looks for nothing else. The guess: `read_sdo` of an object that the
# slave lacks raises ErrorCoE. What comes: the answer is passed over and the request ends by its time-out; with service 3,
# that of an answer, the same bytes raise ErrorCoE at once.
#
# The slave is in this script; its line is a pair of virtual interfaces inside a network namespace of its own. Where no
# such namespace can be made, the script ends with 2.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
cat >line.sh <<'SHELL'
ip link add v0 type veth peer name v1 && ip link set v0 up && ip link set v1 up && exec "$@"
SHELL
probe='import socket; socket.socket(socket.AF_PACKET, socket.SOCK_RAW).bind(("v1", 0))'
apart=""
for way in -n -rn; do
  unshare "$way" sh line.sh python3 -c "$probe" 2>log && apart="$way" && break
done
[ -n "$apart" ] || { echo "cannot run: no network namespace with a pair of virtual interfaces:"; cat log; exit 2; }
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --only-binary :all: kickcat==2.5 2>log || { cat log; exit 2; }
cat >slave.py <<'PYTHON'
import multiprocessing
import socket
import struct

OUT, IN, SIZE = 0x1000, 0x1080, 128  # the two mailboxes


def content():
    """EEPROM: identity, mailboxes with CoE alone, a name, two sync managers."""
    first = bytearray(128)
    crc = 0xFF
    for byte in first[:14]:
        for bit in range(7, -1, -1):
            crc = (crc << 1 ^ (0x07 if (crc >> 7 ^ byte >> bit) & 1 else 0)) & 0xFF
    struct.pack_into("<H", first, 14, crc)
    struct.pack_into("<IIII", first, 16, 0x00ABCDEF, 1, 1, 1)
    struct.pack_into("<HHHHH", first, 48, OUT, SIZE, IN, SIZE, 4)
    struct.pack_into("<HH", first, 124, 15, 1)
    managers = struct.pack("<HHBBBBHHBBBB", OUT, SIZE, 0x26, 0, 1, 1, IN, SIZE, 0x22, 0, 1, 2)
    general = bytes([0, 0, 0, 1, 0, 3]).ljust(32, b"\0")
    parts = ((10, b"\x01\x04tiny"), (30, general), (41, managers))
    rest = b"".join(struct.pack("<HH", kind, len(data) // 2) + data for kind, data in parts)
    return (bytes(first) + rest).ljust(2048, b"\xff")


class Slave:
    def __init__(self, answer):
        self.answer, self.eeprom, self.waiting, self.count = answer, content(), [], None
        self.memory = bytearray(0x10000)
        self.memory[0:9] = 0x11, 0, 0, 0, 2, 2, 4, 0x03, 0
        self.memory[0x110:0x112] = 0x11, 0x56
        self.memory[0x130] = 1

    def write(self, at, data):
        memory, end = self.memory, at + len(data)
        memory[at:end] = data
        if at <= 0x120 < end:
            memory[0x130] = memory[0x120] & 0x0F
        if at <= 0x502 < end:
            place = 2 * struct.unpack_from("<H", memory, 0x504)[0]
            memory[0x508:0x50C] = self.eeprom[place : place + 4].ljust(4, b"\xff")
            memory[0x502:0x504] = 0, 0
        if at < OUT + SIZE <= end:
            size, station, _, kind, coe = struct.unpack_from("<HHBBH", memory, OUT)
            if kind & 15 == 3 and kind >> 4 != self.count:  # CoE, and not sent once more
                self.count = kind >> 4
                service, body = self.answer(coe >> 12, bytes(memory[OUT + 8 : OUT + 6 + size]))
                head = struct.pack("<HHBBH", len(body) + 2, 0, 0, kind, service << 12)
                self.waiting.append((head + body).ljust(SIZE, b"\0"))
        return True

    def read(self, at, size):
        """The bytes; none where the mailbox is empty. Its last byte frees it."""
        memory, end = self.memory, at + size
        memory[0x805], memory[0x80D] = 0, 8 if self.waiting else 0
        if at < IN + SIZE <= end and self.memory[0x130] != 1:
            if not self.waiting:
                return None
            memory[IN : IN + SIZE] = self.waiting.pop(0)
        return memory[at:end]

    def take(self, frame):
        at, more = 16, True
        while more:
            command, _, station, address, length = struct.unpack_from("<BBHHH", frame, at)
            size, more, data = length & 0x7FF, length & 0x8000, at + 10
            mine = station == struct.unpack_from("<H", self.memory, 0x10)[0]
            if command in (1, 2, 7, 8):  # by position, and to all
                mine = command > 2 or station == 0
                struct.pack_into("<H", frame, at + 2, (station + 1) & 0xFFFF)
            done = None
            if mine and command in (1, 4, 7):
                done = self.read(address, size)
                frame[data : data + size] = done or frame[data : data + size]
            elif mine and command in (2, 5, 8):
                done = self.write(address, frame[data : data + size])
            at = data + size + 2
            if done:
                struct.pack_into("<H", frame, at - 2, struct.unpack_from("<H", frame, at - 2)[0] + 1)
        frame[6] |= 2
        return frame


def serve(line, slave):
    while True:
        frame, sender = line.recvfrom(1600)
        if sender[2] != socket.PACKET_OUTGOING:
            line.send(slave.take(bytearray(frame)))


def start(interface, answer):
    """A process of its own, which ends with the caller."""
    line = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x88A4))
    line.bind((interface, 0x88A4))
    multiprocessing.get_context("fork").Process(target=serve, args=(line, Slave(answer)), daemon=True).start()
PYTHON
cat >try.py <<'PYTHON'
import struct

import slave

NO_OBJECT = 0x06020000


def answer(service, body):
    """Object 2002 is refused by an abort with service 2, object 2003 with service 3; any other has the value 7."""
    index = struct.unpack_from("<H", body, 1)[0]
    if index in (0x2002, 0x2003):
        return index & 0xF, b"\x80" + body[1:4] + struct.pack("<I", NO_OBJECT)
    return 3, b"\x43" + body[1:4] + struct.pack("<I", 7)


slave.start("v1", answer)
import kickcat

link = kickcat.create_link("v0", "")
link.set_timeout(0.02)
bus = kickcat.Bus(link)
bus.init(1.0)
(one,) = bus.slaves()
for index in (0x1000, 0x2003, 0x2002, 0x1000):
    try:
        came = bus.read_sdo(one, index, 0, kickcat.Access.PARTIAL, 4, 2.0).hex()
    except Exception as error:
        came = f"{type(error).__name__} {str(error).split(': ', 1)[-1]}"
    print(f"{index:04X} {came}")
PYTHON
cat >expected <<'TEXT'
1000 07000000
2003 ErrorCoE Error while reading SDO
2002 RuntimeError Error while reading SDO - Timeout
1000 07000000
TEXT
timeout 60 unshare "$apart" sh line.sh venv/bin/python try.py >said 2>log || { cat said log; exit 2; }
grep -E '^[0-9A-F]{4} ' said >seen || { cat said log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
