#!/usr/bin/env bash
# control 0.10.2 gives a sampled integrator an infinite gain margin, and a loop with three dead cycles a margin beyond
# its limit.
#
# K / (z - 1) with unit feedback has its pole at 1 - K: stable below K = 2. The guess: margin 2, at the frequency of
# Nyquist. What comes: infinite, since the crossing at z = -1 is not looked at. With three dead cycles, K / (z^3 (z - 1)),
# the limit is 2 sin(pi / 14) = 0.445; of several crossings the function gives the one nearest to 1 on a scale of
# ratios, 1.802, at which the loop has long been unstable. With one and two dead cycles it is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check control==0.10.2
cd "$work"
cat >try.py <<'PYTHON'
import warnings

import control
import numpy as np

warnings.simplefilter("ignore")
for dead in range(4):
    loop = control.tf([1.0], [1.0, -1.0] + [0.0] * dead, 0.001)
    limit = 2.0 * np.sin(np.pi / (2 * (2 * dead + 1)))
    beyond = [1.0, -1.0] + [0.0] * dead
    beyond[-1] += 1.001 * limit
    radius = max(abs(np.roots(beyond)))
    print(f"{dead} dead cycles: limit {limit:.3f}, unstable beyond it: {radius > 1.0}, margin {control.margin(loop)[0]:.3f}")
PYTHON
cat >expected <<'TEXT'
0 dead cycles: limit 2.000, unstable beyond it: True, margin inf
1 dead cycles: limit 1.000, unstable beyond it: True, margin 1.000
2 dead cycles: limit 0.618, unstable beyond it: True, margin 0.618
3 dead cycles: limit 0.445, unstable beyond it: True, margin 1.802
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
