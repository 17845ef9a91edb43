#!/usr/bin/env bash
# pysoem 1.1.13 raises what it found in gaps of an object later, at reads of other objects.
#
# The slave has 1C32 without its optional sub-indices 7, 8 and 10, and answers a request for their description with the SDO
# information error 06090011, as SOES does. The guess: `entries` raises, or leaves them out. What comes: `entries` gives them
# as entries without a type, and the errors wait in a list of SOEM; each of the next three `sdo_read` of 1000, whose
# answer is right, raises one of them as an unexpected error without index and code, and the value is lost.
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
venv/bin/pip install --quiet --disable-pip-version-check --only-binary :all: pysoem==1.1.13 2>log || { cat log; exit 2; }
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

HAS = {0x1000: (0,), 0x1C32: (0, 1, 2, 3, 4, 5, 6, 9, 11, 12)}


def answer(service, body):
    """Any value is 7; the list of objects, an object, an entry (ETG.1000.6, SDO information)."""
    if service == 2:
        return 3, b"\x43" + body[1:4] + struct.pack("<I", 7)
    asked, (index,) = body[0], struct.unpack_from("<H", body, 4)
    if asked == 1:
        data = struct.pack("<HHH", index, *HAS)
    elif asked == 3:
        most = HAS[index][-1]
        data = struct.pack("<HHBB", index, 7, most, 9 if most else 7) + b"name"
    elif body[6] in HAS[index]:
        data = struct.pack("<HBBHHH", index, body[6], 0, 7, 32, 7) + b"name"
    else:
        asked, data = 6, struct.pack("<I", 0x06090011)
    return 8, bytes([asked + 1, 0, 0, 0]) + data


slave.start("v1", answer)
import pysoem


def reads(count):
    for _ in range(count):
        try:
            print("1000", one.sdo_read(0x1000, 0).hex())
        except Exception as error:
            print("1000", type(error).__name__, error)


master = pysoem.Master()
master.open("v0")
master.config_init()
(one,) = master.slaves
reads(1)
(record,) = [known for known in one.od if known.index == 0x1C32]
print("1C32 without a type:", [sub for sub, entry in enumerate(record.entries) if not entry.data_type])
reads(5)
master.close()
PYTHON
cat >expected <<'TEXT'
1000 07000000
1C32 without a type: [7, 8, 10]
1000 Exception unexpected error, Etype: 4
1000 Exception unexpected error, Etype: 4
1000 Exception unexpected error, Etype: 4
1000 07000000
1000 07000000
TEXT
timeout 60 unshare "$apart" sh line.sh venv/bin/python try.py >said 2>log || { cat said log; exit 2; }
grep -E '^[0-9A-F]{4} ' said >seen || { cat said log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
