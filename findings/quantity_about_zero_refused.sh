#!/usr/bin/env bash
# metrological-quantity 1.0.1 refuses to double a negative deviation, and divides by a value of 0.
#
# Deviations of an axis of 5, 0 and -5 um, each with an uncertainty of 0.5 um, are doubled, halved, lessened by 1 um, multiplied by a factor of 1.2 with an uncertainty of 0.01, and
# printed. The guess: the double has twice the uncertainty, half of it has half, whatever the sign (JCGM 100, 5.1.2: the squares of sensitivity and uncertainty are added), and the product
# has sqrt((1.2 * 0.5)^2 + (d * 0.01)^2), which is 0.602 and for 0 it is 0.6. What comes: that is so for a positive value. A negative one has a negative relative uncertainty,
# which gives a result that the package itself refuses, and a 0 is divided by; it cannot even be printed. Measured deviations are of both signs and about 0.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check metrological-quantity==1.0.1
cd "$work"
cat >try.py <<'PYTHON'
from metrological_quantity import Quantity

factor = Quantity(1.2, 0.01, "")
for value in (5.0, 0.0, -5.0):
    deviation = Quantity(value, 0.5, "um")
    shown = []
    for name, work in (
        ("doubled", lambda d: 2 * d),
        ("halved", lambda d: d / 2),
        ("less 1", lambda d: d - Quantity(1.0, 0.0, "um")),
        ("by 1.2(1)", lambda d: d * factor),
        ("printed", lambda d: str(d) and d),
    ):
        try:
            result = work(deviation)
            shown.append(f"{name} {result.value:g} with {result.uncertainty:.3g}")
        except Exception as error:
            shown.append(f"{name}: {type(error).__name__} ({error})")
    print(f"{value:g} um: " + "; ".join(shown))
PYTHON
cat >expected <<'TEXT'
5 um: doubled 10 with 1; halved 2.5 with 0.25; less 1 4 with 0.5; by 1.2(1) 6 with 0.602; printed 5 with 0.5
0 um: doubled: ZeroDivisionError (float division by zero); halved: ZeroDivisionError (float division by zero); less 1 -1 with 0.5; by 1.2(1): ZeroDivisionError (float division by zero); printed: ZeroDivisionError (float division by zero)
-5 um: doubled: ValueError (Uncertainty must be positive.); halved: ValueError (Uncertainty must be positive.); less 1 -6 with 0.5; by 1.2(1) -6 with 0.602; printed -5 with 0.5
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
