#!/usr/bin/env bash
# adctoolbox 0.9.1 finds a code that is too wide one code too low, if the converter is tested with a sine and not with a ramp.
#
# The converter of an analog probe has 64 codes, of which code 20 is half a step too wide and code 21 half a step too narrow, or code 40 and 41. Its codes from a ramp and from a sine
# that overdrives it are evaluated (code density). The guess: a DNL of 0.5 at 20 and -0.5 at 21 from both, for the DNL of code k is that of its own width, from transition k to
# k + 1 (IEEE Std 1241, differential nonlinearity and code bin width). What comes: so from the ramp; from the sine 0.5 at 19 and -0.5 at 20. Who masks, corrects or
# looks up the step by its code takes the wrong one; the sizes are right, and with them the largest values that a report states.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check adctoolbox==0.9.1
cd "$work"
cat >try.py <<'PYTHON'
import adctoolbox
import numpy as np

COUNT = 2**20
SIGNALS = {
    "ramp": (adctoolbox.analyze_inl_from_ramp, np.linspace(-0.02, 1.02, COUNT)),
    "sine": (adctoolbox.analyze_inl_from_sine, 0.5 + 0.55 * np.sin(2 * np.pi * 129449 * np.arange(COUNT) / COUNT)),
}
for wide in (20, 40):
    widths = np.ones(64)
    widths[wide], widths[wide + 1] = 1.5, 0.5
    steps = np.concatenate([[0.0], np.cumsum(widths)]) / 64
    for name, (analyze, signal) in SIGNALS.items():
        codes = np.clip(np.searchsorted(steps, signal, side="right") - 1, 0, 63)
        found = analyze(codes, num_bits=6, create_plot=False)
        shown = [f"{dnl:.1f} at code {code}" for code, dnl in zip(found["code"], found["dnl"]) if abs(dnl) > 0.3]
        print(f"code {wide} too wide, by a {name}: DNL", ", ".join(shown))
PYTHON
cat >expected <<'TEXT'
code 20 too wide, by a ramp: DNL 0.5 at code 20, -0.5 at code 21
code 20 too wide, by a sine: DNL 0.5 at code 19, -0.5 at code 20
code 40 too wide, by a ramp: DNL 0.5 at code 40, -0.5 at code 41
code 40 too wide, by a sine: DNL 0.5 at code 39, -0.5 at code 40
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
