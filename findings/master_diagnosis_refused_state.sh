#!/usr/bin/env bash
# pyetg1510 0.1.3 does not tell that a device refused a state, and tells it when the master has acknowledged that; an abort of its answer becomes a state.
#
# An EtherCAT master offers the diagnosis of its devices (ETG.1510) by its mailbox gateway: device 0 was asked for OP, is in SAFEOP with an error (AL status 0x14, AL control 0x08, code
# 0x1B), the error of device 1 is acknowledged (status 0x04, control 0x14), device 2 is in BOOT. The guess: the first is rejected, the second not, the third is in BOOT. What comes:
# the first is not rejected and the second is, as the bit of the error is looked up in AL control, where it is the acknowledgement (ETG.1000.6, AL control and AL status); the state
# BOOT, 3, is refused. If the master aborts the answer for device 0 (0x08000022), a half of the code is its AL status, and no error is raised. The master
# here must be a lenient one: on Linux the requests have the type 0 instead of 5 and the service 0 instead of 2 (ETG.8200, ETG.1000.6, CoE header), as these are set as bits of
# eight in a word of sixteen, which ctypes does not keep there.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyetg1510==0.1.3 bitarray==2.9.3
cd "$work"
cat >try.py <<'PYTHON'
import asyncio
import socket
import struct
import threading

from pyetg1510 import EtherCATMasterConnection, ETG1510Profile, MasterODSpecification

DEVICES = {0xA000: (0x14, 0x08, 0x1B), 0xA001: (0x04, 0x14, 0x00), 0xA002: (0x03, 0x03, 0x00)}
SIZES = (8, 16, 16, 16)


class Master:
    """The mailbox gateway of a master (ETG.8200) with the states of its devices."""

    def __init__(self):
        self.abort = None
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            request, asker = self.socket.recvfrom(1500)
            self.last = f"type {request[1] >> 4}, service {request[9] >> 4}"
            body = self.answer(request[10:])
            body = struct.pack("<H", (8 if request[10] < 8 else 2 if body[0] == 0x80 else 3) << 12) + body
            self.socket.sendto(struct.pack("<HHHBB", 5 << 12 | 6 + len(body), len(body), 0, 0, 0x13) + body, asker)

    def answer(self, request):
        if request[0] == 0x50:
            index = struct.unpack_from("<H", request, 1)[0]
            if self.abort:
                return struct.pack("<BHBI", 0x80, index, 0, self.abort)
            data = struct.pack("<HHHH", 3, *DEVICES[index])
            return struct.pack("<BHBI", 0x51, index, 0, len(data)) + data
        opcode, index = request[0], struct.unpack_from("<H", request, 4)[0]
        if opcode == 1:
            return struct.pack("<BBHH3H", 2, 0, 0, 1, *DEVICES)
        if opcode == 3:
            return struct.pack("<BBHHHBB", 4, 0, 0, index, 0, 3, 9) + b"Diagnosis"
        if request[6] > 3:
            return struct.pack("<BBHI", 7, 0, 0, 0x06090011)
        return struct.pack("<BBHHBBHHH", 6, 0, 0, index, request[6], 0, 5 if request[6] == 0 else 6, SIZES[request[6]], 7) + b"Entry"


async def main():
    master = Master()
    objects = MasterODSpecification(EtherCATMasterConnection(*master.socket.getsockname()))
    await objects.get_object_dictionary()
    profile = ETG1510Profile(objects)
    for master.abort in (None, 0x08000022):
        for index in list(DEVICES)[: 1 if master.abort else 3]:
            data = await profile.get_sdo(index)
            try:
                state = data.al_status.name
            except ValueError as error:
                state = f"refused ({error})"
            words = f"AL status {data.ALStatus.value:#06x}, AL control {data.ALControl.value:#06x}"
            print(f"device {index & 0xFF}{', aborted' if master.abort else ''}: {words}: state {state}, rejected {data.is_rejected}")


    print("upload requested with", master.last)


asyncio.run(main())
PYTHON
cat >expected <<'TEXT'
device 0: AL status 0x0014, AL control 0x0008: state SAFEOP, rejected False
device 1: AL status 0x0004, AL control 0x0014: state SAFEOP, rejected True
device 2: AL status 0x0003, AL control 0x0003: state refused (3 is not a valid ALStatus), rejected False
device 0, aborted: AL status 0x0800, AL control 0x0000: state refused (0 is not a valid ALStatus), rejected False
upload requested with type 0, service 0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
