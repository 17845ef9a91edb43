#!/usr/bin/env bash
# qfmu 0.2.9 makes an FMU of a PD controller whose gain at rest is kd instead of kp.
#
# Its help gives the controller as kp + ki/s + kd*s/(T*s + 1), so that without ki a constant error of 1 ends at kp, whatever kd is. The guess: 10 with
# kp = 10, kd = 0.1 and T = 0.01 s. What comes: 20 in the first moment, which is right, and then 0.1, as its numerator ends with kd. P alone, PI
# and all three parts are right; a ki of 1e-6 beside the other two mends it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check fmpy==0.3.32
python3 -m venv "$work/maker"
"$work/maker/bin/pip" install --quiet --disable-pip-version-check qfmu==0.2.9
cd "$work"
cat >try.py <<'PYTHON'
import subprocess

import fmpy

for parts in ("-kp 10", "-kp 10 -ki 0.000001 -kd 0.1 -T 0.01", "-kp 10 -kd 0.1 -T 0.01"):
    subprocess.run(["maker/bin/qfmu", "pid", *parts.split(), "-u0", "1", "-o", "pid.fmu"], check=True, stdout=subprocess.DEVNULL)
    name = next(one.name for one in fmpy.read_model_description("pid.fmu").modelVariables if one.causality == "output")
    rows = fmpy.simulate_fmu("pid.fmu", stop_time=1.0, output_interval=0.001, fmi_type="CoSimulation", output=[name])
    print(f"pid {parts}: {rows[name][0]:.1f} at the start, {rows[name][-1]:.1f} at 1 s")
PYTHON
cat >expected <<'TEXT'
pid -kp 10: 10.0 at the start, 10.0 at 1 s
pid -kp 10 -ki 0.000001 -kd 0.1 -T 0.01: 20.0 at the start, 10.0 at 1 s
pid -kp 10 -kd 0.1 -T 0.01: 20.0 at the start, 0.1 at 1 s
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
