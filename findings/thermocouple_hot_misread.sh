#!/usr/bin/env bash
# thermocouples 2.1.2 gives a hot thermocouple of type S or B voltages of another one, and reads a hot type J as -2098 °C.
#
# The package names NIST Monograph 175 (ITS-90) as its source for all types and both directions. The guess: its
# voltages are those of the NIST tables to a microvolt, and the tables' voltages come back to a degree. What
# comes: type S at 1500 °C has -28 mV, type B at 1000 °C has 61 mV instead of 4.8, both without a word. The way
# back is right there, but not for J (57.953 mV is 1000 °C); S at 1000 °C comes back five degrees low, and R at
# 1500 °C, well within its range, is refused. Types K, T and E hold the tables in the same run.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check thermocouples==2.1.2
cd "$work"
cat >try.py <<'PYTHON'
from thermocouples import get_thermocouple

# type, °C, mV of the NIST table
TABLE = [
    ("K", 1000, 41.276),
    ("T", 300, 14.862),
    ("J", 1000, 57.953),
    ("E", 500, 37.005),
    ("R", 1000, 10.506),
    ("R", 1500, 17.451),
    ("S", 1000, 9.587),
    ("S", 1500, 15.582),
    ("B", 1000, 4.834),
    ("B", 1500, 10.099),
]
for name, temperature, table in TABLE:
    couple = get_thermocouple(name)
    given = couple.temp_to_volt(temperature) * 1e3
    try:
        back = f"{couple.volt_to_temp(table / 1e3):.0f} °C"
    except ValueError:
        back = "refused"
    print(f"{name} {temperature} °C: table {table:.3f} mV, package {given:.3f} mV; table's voltage is {back}")
PYTHON
cat >expected <<'TEXT'
K 1000 °C: table 41.276 mV, package 41.276 mV; table's voltage is 1000 °C
T 300 °C: table 14.862 mV, package 14.862 mV; table's voltage is 300 °C
J 1000 °C: table 57.953 mV, package 57.953 mV; table's voltage is -2098 °C
E 500 °C: table 37.005 mV, package 37.005 mV; table's voltage is 500 °C
R 1000 °C: table 10.506 mV, package 10.506 mV; table's voltage is 1000 °C
R 1500 °C: table 17.451 mV, package 17.451 mV; table's voltage is refused
S 1000 °C: table 9.587 mV, package 9.587 mV; table's voltage is 995 °C
S 1500 °C: table 15.582 mV, package -27.977 mV; table's voltage is 1500 °C
B 1000 °C: table 4.834 mV, package 61.349 mV; table's voltage is 1000 °C
B 1500 °C: table 10.099 mV, package 158.471 mV; table's voltage is 1500 °C
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
