#!/usr/bin/env bash
# grafito-canstepper 0.2.3 has a drive to test masters with whose set-point acknowledge never falls again.
#
# In profile position mode a master raises bit 4 of the controlword, waits for bit 12 of the statusword, takes bit 4 back and waits until bit 12
# has fallen before it gives the next set-point (CiA 402-2, profile position mode, set-point handshake). The guess: 0, 1, 0 for each of two set-points. What comes:
# 0, 1, 1 and then 1, 1, 1, so that a master with the handshake waits for ever behind its first move, and one without believes its second set-point
# taken before it was sent. Homing sets the bit for good as well. When a fault is reset, the emergency 0000 (CiA 301, error reset) that ends it does not come.
#
# Drive and bus are classes of the package; nothing leaves the process.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check grafito-canstepper==0.2.3
cd "$work"
cat >try.py <<'PYTHON'
from canstepper.canopen402 import CanOpenMaster, CanOpenSlave, VirtualCanBus


def master_and_drive():
    bus = VirtualCanBus()
    drive = CanOpenSlave(1, bus)
    master = CanOpenMaster(bus, 1)
    master.start()
    master.enable_operation()
    return bus, drive, master


def step(controlword):
    master.sdo_write(0x6040, 0, controlword)
    drive.tick()
    return f"{controlword:02X}: {master.sdo_read(0x6041) >> 12 & 1}"


bus, drive, master = master_and_drive()
master.sdo_write(0x6060, 0, 1)
for target in (1000, 2000):
    master.sdo_write(0x607A, 0, target)
    seen = [step(controlword) for controlword in (0x0F, 0x1F, 0x0F)]
    print("set-point", target, "controlword and bit 12", *seen, "at", master.sdo_read(0x6064))

bus, drive, master = master_and_drive()
master.home()
master.sdo_write(0x6060, 0, 1)
print("homed, then profile position", step(0x0F))
bus.drain()
drive.raise_fault(0x8611, 0x21)
master.sdo_write(0x6040, 0, 0x80)
print("emergencies of a fault and its reset:", *(frame.data.hex() for frame in bus.drain() if frame.can_id == 0x81))
PYTHON
cat >expected <<'TEXT'
set-point 1000 controlword and bit 12 0F: 0 1F: 1 0F: 1 at 1000
set-point 2000 controlword and bit 12 0F: 1 1F: 1 0F: 1 at 2000
homed, then profile position 0F: 1
emergencies of a fault and its reset: 1186210000000000
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
