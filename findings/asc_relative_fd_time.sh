#!/usr/bin/env bash
# asc2log of can-utils 2020.11.0 reads a relative log with one clock for classic frames and another for CAN FD ones.
#
# An ASC log with `timestamps relative` has the time since the line before; a drive sends a frame each 100 ms, the third and the sixth as CAN FD. The guess: 0.1, 0.2, 0.3 and so on
# to 0.6 s behind the first line, whatever the frame (Vector, ASC, timestamps relative). What comes: 0.1, 0.2, 0.1, 0.3, 0.4, 0.2: the differences are added up by
# kind of frame, so that each kind lacks the time before the other, and the order is lost. The same lines with absolute times are right, and so is a relative log of classic frames alone.
#
# The tool is the one of Debian 12; its package is unpacked and not installed. Where there is no such package, the script fails and changes nothing.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
apt-get download -q can-utils=2020.11.0-1 >log 2>&1 || { echo "no package of can-utils 2020.11.0 here"; exit 2; }
dpkg -x can-utils_*.deb .
cat >try.py <<'PYTHON'
import subprocess

CLASSIC = "{:11.6f} 1  181             Rx   d 2 11 22"
FD = "{:11.6f} CANFD   1 Rx        181                                   1 0 2  2 11 22   130000  130     3000 0 0 0 0 0"


def times(kind, fd):
    lines = ["date Mon Nov 30 10:00:00.000 am 2026", f"base hex  timestamps {kind}", "no internal events logged"]
    for number in range(1, 7):
        lines.append((FD if number in fd else CLASSIC).format(0.1 if kind == "relative" else 0.1 * number))
    with open("log.asc", "w") as file:
        file.write("\n".join(lines) + "\n")
    frames = subprocess.run(["usr/bin/asc2log", "-I", "log.asc"], capture_output=True, text=True, check=True).stdout.split("\n")[:-1]
    stamps = [float(frame[1 : frame.index(")")]) for frame in frames]
    return [stamp - stamps[0] + 0.1 for stamp in stamps]


for kind in ("absolute", "relative"):
    for name, fd in (("classic", ()), ("third and sixth FD", (3, 6))):
        print(f"{kind}, {name}:", *(f"{time:.1f}" for time in times(kind, fd)))
PYTHON
cat >expected <<'TEXT'
absolute, classic: 0.1 0.2 0.3 0.4 0.5 0.6
absolute, third and sixth FD: 0.1 0.2 0.3 0.4 0.5 0.6
relative, classic: 0.1 0.2 0.3 0.4 0.5 0.6
relative, third and sixth FD: 0.1 0.2 0.1 0.3 0.4 0.2
TEXT
python3 try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
