#!/usr/bin/env bash
# mks-servo 1.0.0 moves to the wrong side of an origin that is kept in the profile: it takes the offset off the target where it takes it off the reading too.
#
# A wrist is moved to 90 degrees, where its origin is set (`set_origin(soft=True)`: the counts at this place go to the profile, the drive is left as it is), and from there to 0, 30
# and by 10 degrees on, with limits of 45 degrees on both sides. The guess: it stays, then stands 30 and 40 degrees from the origin, 120 and 130 in counts of the drive; what
# is written is what is read, as without an origin. What comes: told 0 it turns by half a turn to -90 degrees of the drive and reads -180; told 30 it reads -150, and by 10
# more a limit refuses -140, which nobody asked for. A target of 0 to 45 passes the limits and ends up four times as far away. With an origin in the drive (the default) it is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check mks-servo==1.0.0 pyserial==3.5 ruamel.yaml==0.19.1 click==8.5.1
cd "$work"
cat >try.py <<'PYTHON'
import os
import threading
import tty

from mks_servo import Motor, Profile

TURN = 0x4000
SIZES = {0x82: 5, 0x83: 6, 0x84: 5, 0xF3: 5, 0xF5: 11}  # of a command with head, address, code and sum; a question has 4


class Drive(threading.Thread):
    """The drive at the other end of a serial line: a move to counts (F5) is done at once, the place (31) is in counts of 16384 a turn."""

    def __init__(self):
        super().__init__(daemon=True)
        self.line, self.other = os.openpty()
        tty.setraw(self.other)
        self.port, self.counts = os.ttyname(self.other), 0

    def take(self, size):
        taken = b""
        while len(taken) < size:
            taken += os.read(self.line, size - len(taken))
        return taken

    def run(self):
        while True:
            _, address, code = self.take(3)
            rest = self.take(SIZES.get(code, 4) - 3)
            if code == 0xF5:
                self.counts = int.from_bytes(rest[3:7], "big", signed=True)
            elif code == 0x92:
                self.counts = 0
            answer = bytes([0xFB, address, code]) + (self.counts.to_bytes(6, "big", signed=True) if code == 0x31 else b"\1")
            os.write(self.line, answer + bytes([sum(answer) & 0xFF]))


for soft in (False, True):
    drive = Drive()
    drive.start()
    profile = Profile.from_template("nema17-bipolar-2A", id="wrist")
    print("origin in the", "profile:" if soft else "drive:")
    with Motor.from_profile(profile, port=drive.port) as motor:
        motor.write(90)
        motor.set_origin(soft=soft)
        motor.position_limits = (-45, 45)
        print(f"  set at 90: reads {motor.read():.2f}, drive at {drive.counts * 360 / TURN:.2f}")
        for name, move, angle in (("to", motor.write, 0), ("to", motor.write, 30), ("by", motor.move_relative, 10)):
            try:
                move(angle)
                print(f"  {name} {angle}: reads {motor.read():.2f}, drive at {drive.counts * 360 / TURN:.2f}")
            except Exception as error:
                print(f"  {name} {angle}: {error}")
PYTHON
cat >expected <<'TEXT'
origin in the drive:
  set at 90: reads 0.00, drive at 0.00
  to 0: reads 0.00, drive at 0.00
  to 30: reads 29.99, drive at 29.99
  by 10: reads 39.99, drive at 39.99
origin in the profile:
  set at 90: reads 0.00, drive at 90.00
  to 0: reads -180.00, drive at -90.00
  to 30: reads -150.01, drive at -60.01
  by 10: position limit exceeded: value=-140.00732421875 limit=-45
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
