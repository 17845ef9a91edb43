#!/usr/bin/env bash
# cheap-modbus-rtu 0.1.1 takes the late answer of one station for that of another, and cannot read a negative value.
#
# Two drives are on a line; each has its temperature in register 40001 and its following error in 40002. Station 2 is slow once: its answer comes when the master has given up and
# asks station 1. The guess: an answer of an unexpected station is left aside and waiting goes on (Modbus over serial line 1.02, 2.4.1: reply from unexpected slave, keep the
# time-out running), so that station 1 reads 41; `int16` reads -3 for FFFD. What comes: station 1 reads 72, the temperature of station 2, without a word, since neither the
# address nor the function of an answer is compared. The documented type of signed values raises a TypeError for each answer, also a positive one.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check cheap-modbus-rtu==0.1.1 pyserial==3.5
cd "$work"
cat >try.py <<'PYTHON'
import os
import threading
import tty

from cheap_modbus_rtu.modbus_rtu_master import ModbusRtuMaster

STATIONS = {1: (41, 0x10000 - 3), 2: (72, 5)}


def with_sum(frame):
    crc = 0xFFFF
    for byte in frame:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return bytes(frame) + crc.to_bytes(2, "little")


def bus(line):
    """The line with both stations: the first answer of station 2 is kept until the next question is there."""
    kept, slow = b"", True
    while True:
        asked = b""
        while len(asked) < 8:
            asked += os.read(line, 8 - len(asked))
        station, first, count = asked[0], asked[3], asked[5]
        values = STATIONS[station][first : first + count]
        answer = with_sum([station, 3, 2 * count, *b"".join(value.to_bytes(2, "big") for value in values)])
        if station == 2 and slow:
            kept, slow = answer, False
        else:
            os.write(line, kept + answer)
            kept = b""


line, other = os.openpty()
tty.setraw(other)
threading.Thread(target=bus, args=(line,), daemon=True).start()
master = ModbusRtuMaster(os.ttyname(other), timeout=2)
for station, register, kind in ((1, 40001, "uint16"), (2, 40001, "uint16"), (1, 40001, "uint16"), (2, 40001, "uint16"), (1, 40002, "uint16"), (1, 40002, "int16"), (1, 40001, "int16")):
    try:
        shown = master.read_holding_registers(station, register, 1, kind)
    except Exception as error:
        shown = type(error).__name__
    print(f"station {station}, {register} as {kind}: {shown}")
PYTHON
cat >expected <<'TEXT'
station 1, 40001 as uint16: (41,)
station 2, 40001 as uint16: ModbusException
station 1, 40001 as uint16: (72,)
station 2, 40001 as uint16: (72,)
station 1, 40002 as uint16: (65533,)
station 1, 40002 as int16: TypeError
station 1, 40001 as int16: TypeError
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
