#!/usr/bin/env bash
# pyssp_standard 0.9.1 puts 0 degrees Celsius at 274.15 K, and a millikelvin at a thousandth of a kelvin above zero.
#
# A unit of an SSP says by factor and offset what it is in SI units (SSP 1.0, BaseUnit): degC is K with offset 273.15, mK is K
# with factor 0.001. The guess: the function that makes this from the name of a unit gives both. What comes: 274.15, which is
# what one degree is, and for mK an offset of 0.001 and no factor, so that 20 mK are 20.001 K. Lengths and speeds are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyssp-standard==0.9.1
cd "$work"
cat >try.py <<'PYTHON'
from pyssp_standard.unit_conversion import generate_base_unit

for name in ("degC", "mK", "mm", "mm/min"):
    made = generate_base_unit(name)
    print(name, *(f"{key}={value:.7g}" for key, value in sorted(made.items())))
PYTHON
cat >expected <<'TEXT'
degC K=1 offset=274.15
mK K=1 offset=0.001
mm factor=0.001 m=1
mm/min factor=1.666667e-05 m=1 s=-1
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
