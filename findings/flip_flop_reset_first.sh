#!/usr/bin/env bash
# primitives 0.1.0 has an SR flip-flop that is reset when it is set and reset at once, and an on-delay timer whose elapsed time does not end.
#
# The package has two function blocks of a controller, SR and TON, for scans in Python. The guess: SR is set while it is set, also if it is reset in the same scan (IEC 61131-3,
# bistable blocks: SR is dominant in setting, RS in resetting); a TON of 0 s is on in the scan in which its input comes; its elapsed time ends at the preset, in the time that the
# scan gives (same standard, timers). What comes: SR gives 0 for both, as RS does, and there is no RS; a TON of 0 s comes a scan late; and its elapsed
# time is that of the clock of the computer, even if each scan gives its own time, and grows beyond the preset.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check primitives==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
import primitives
from primitives import SR, TON
from primitives import ton as module

flip = SR()
print("SR, set and reset:", *(f"{s}{r} gives {int(flip.update(bool(s), bool(r)))}," for s, r in ((1, 0), (0, 0), (0, 1), (1, 1), (0, 0))), "blocks", primitives.__all__)
for preset in (0.0, 0.5):
    timer = TON(preset)
    print(f"TON of {preset} s:", *(f"{int(timer.update(on, now=now))} at {now}" for on, now in ((False, 0.0), (True, 0.25), (True, 0.5), (True, 0.75), (True, 1.0))))
timer = TON(2.0)
for now in (1000.0, 1001.0, 1005.0):
    timer.update(True, now=now)
for clock in (1001.0, 1500.0):
    module.monotonic = lambda clock=clock: clock
    print(f"TON of 2.0 s, on for 5 s by its scans, clock {clock - 1000:.0f} s after its start: elapsed {timer.elapsed}")
PYTHON
cat >expected <<'TEXT'
SR, set and reset: 10 gives 1, 00 gives 1, 01 gives 0, 11 gives 0, 00 gives 0, blocks ['TON', 'SR']
TON of 0.0 s: 0 at 0.0 0 at 0.25 1 at 0.5 1 at 0.75 1 at 1.0
TON of 0.5 s: 0 at 0.0 0 at 0.25 0 at 0.5 1 at 0.75 1 at 1.0
TON of 2.0 s, on for 5 s by its scans, clock 1 s after its start: elapsed 1.0
TON of 2.0 s, on for 5 s by its scans, clock 500 s after its start: elapsed 500.0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
