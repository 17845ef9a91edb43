#!/usr/bin/env bash
# pySimplePID 0.1.0 winds up without end if the gains are negative, as they are for an actuator that acts in reverse.
#
# A position is led to 100 mm by an actuator of at most 100 % that moves 0.05 mm/s per percent. Once it moves forward at positive output, once backward, for which
# both gains have the other sign: the loop is the same. The guess: both go alike, and the integral part stops while the output is at its limit (by its comment it is held there unless the error leads
# back out). What comes: the forward one overshoots by 24 mm and comes back; the reverse one runs past 100 mm at full output and on, for the condition looks at the sign of the
# error and not of what it adds: at the limit the integral grows while it should be held, and is held when it should fall. It turns only when the
# proportional part alone outweighs it, at 485 mm, and then runs the other way likewise.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pySimplePID==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
from pySimplePID import PID


def show(name, acts, limit):
    now = [0.0]
    loop = PID(kp=acts * 1.0, ki=acts * 0.5, target=100.0, output_min=-limit, output_max=limit, time_function=lambda: now[0])
    position, highest, rows = 0.0, 0.0, []
    for at in range(1, 1001):
        now[0] = 0.1 * at
        position += 0.1 * acts * 0.05 * loop.update(position)
        highest = max(highest, position)
        if at in (100, 200, 400, 800, 1000):
            rows.append(f"{now[0]:.0f} s {position:.1f} mm integral {loop.integral:.0f}")
    print(f"{name}, limit {limit:.0f} %: highest {highest:.1f} mm;", ", ".join(rows))


show("forward", 1, 1e6)
show("reverse", -1, 1e6)
show("forward", 1, 100.0)
show("reverse", -1, 100.0)
PYTHON
cat >expected <<'TEXT'
forward, limit 1000000 %: highest 163.8 mm; 10 s 112.5 mm integral 499, 20 s 160.7 mm integral 6, 40 s 63.1 mm integral -7, 80 s 86.4 mm integral -5, 100 s 108.2 mm integral 4
reverse, limit 1000000 %: highest 163.8 mm; 10 s 112.5 mm integral 499, 20 s 160.7 mm integral 6, 40 s 63.1 mm integral -7, 80 s 86.4 mm integral -5, 100 s 108.2 mm integral 4
forward, limit 100 %: highest 123.9 mm; 10 s 50.0 mm integral 99, 20 s 99.8 mm integral 189, 40 s 100.4 mm integral -114, 80 s 100.4 mm integral -42, 100 s 99.7 mm integral 25
reverse, limit 100 %: highest 485.0 mm; 10 s 50.0 mm integral 752, 20 s 100.0 mm integral 1005, 40 s 200.0 mm integral 1005, 80 s 400.0 mm integral 1005, 100 s 472.6 mm integral -250
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
