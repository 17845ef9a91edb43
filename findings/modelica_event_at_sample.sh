#!/usr/bin/env bash
# rumoca 0.10.2 sees `time > 0.3` a whole sample late if a clock of the model ticks at 0.3 s.
#
# A model notes the time at which `time > 0.3` becomes true, and counts `sample(0, 0.1)` beside it. The guess: 0.3 s with and without
# the clock, since the relation is true as soon as time goes on from there (Modelica 3.6, 8.5, events). What comes: 0.3 without
# the clock, 0.4 with it: at 0.3 it is still false, and nobody looks again before the next tick. `time >= 0.3`, and `time >
# 0.25`, which no tick meets, are right in both.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check rumoca==0.10.2 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
from pathlib import Path

import rumoca

MODEL = """model Clock
  Real x(start = 0, fixed = true);
  discrete Integer ticks(start = 0, fixed = true);
  discrete Real above(start = -1, fixed = true);
  discrete Real reached(start = -1, fixed = true);
  discrete Real between(start = -1, fixed = true);
equation
  der(x) = 1;
  %s
  when time > 0.3 then
    above = time;
  end when;
  when time >= 0.3 then
    reached = time;
  end when;
  when time > 0.25 then
    between = time;
  end when;
end Clock;
"""
for clock in ("ticks = 0;", "when sample(0, 0.1) then ticks = pre(ticks) + 1; end when;"):
    Path("clock.mo").write_text(MODEL % clock)
    result = rumoca.Session([]).load("clock.mo", model="Clock").simulate((0.0, 1.0), dt=0.01)
    ticks, *noted = (float(result[name][-1]) for name in ("ticks", "above", "reached", "between"))
    print(f"{ticks:2.0f} ticks:", *(f"{time:.3f}" for time in noted))
PYTHON
cat >expected <<'TEXT'
 0 ticks: 0.300 0.300 0.250
11 ticks: 0.400 0.300 0.250
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
