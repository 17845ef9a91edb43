#!/usr/bin/env bash
# polars-waveform 0.1.0 weighs each sample of a course alike in mean and rms, however far apart they are; its own integral does not.
#
# A force of 100 N acts for the first 10 ms of a second and is 1 N for the rest. A solver with variable steps writes a point each millisecond at first
# and each 43 ms later. The functions have the semantics of OCEAN (its page), where average is the integral divided by the range, and rms goes by
# the integral of the square. The guess: mean 2.04 N and rms 10.2 N, as by the straight lines between the points, or near to it.
# What comes: 32.1 and 56.1 N; on an even grid of 1 ms 2.09 and 10.5 N. `integ` is right on both, so that its quotient with the range is the mean
# and `average` is not. The thermal load of a drive by such an rms is thirty times too high (it goes by the square), without a word.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check polars-waveform==0.1.0 polars==2.1.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
from math import sqrt

import polars_waveform as pw


def force(milliseconds):
    return 100.0 if milliseconds <= 10 else 1.0


def by_lines(times, values):
    """Mean and rms of the straight lines between the points, by their exact integrals."""
    whole = square = 0.0
    for first, second, a, b in zip(times, times[1:], values, values[1:]):
        whole += (second - first) * (a + b) / 2
        square += (second - first) * (a * a + a * b + b * b) / 3
    span = times[-1] - times[0]
    return whole / span, sqrt(square / span)


grids = {"uneven": [*range(11), *range(11, 1001, 43)], "even": list(range(1001))}
for name, grid in grids.items():
    times, values = [t / 1000 for t in grid], [force(t) for t in grid]
    wave = pw.from_arrays(times, values)
    mean, rms = by_lines(times, values)
    print(f"{name}, {len(times)} points: average {pw.average(wave):.3f}, rms {pw.rms(wave):.3f};", end=" ")
    print(f"integral {pw.integ(wave):.4f} Ns; by hand mean {mean:.3f}, rms {rms:.3f}")
PYTHON
cat >expected <<'TEXT'
uneven, 35 points: average 32.114, rms 56.067; integral 2.0395 Ns; by hand mean 2.039, rms 10.215
even, 1001 points: average 2.088, rms 10.530; integral 2.0395 Ns; by hand mean 2.039, rms 10.215
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
