#!/usr/bin/env bash
# auto-control-tools 0.0.1 turns the times of a tuning rule into gains by their reciprocal, or not at all, so that the loop it tunes is unstable.
#
# An axis with its filter is a lag of 1 s behind a dead time of 0.1 s. Ziegler and Nichols give a PID controller Kp = 12, Ti = 0.2 s and Td = 0.05 s by its reaction curve,
# Cohen and Coon 13.6, 0.24 s and 0.036 s; the controller of the package is Kp + Ki/s + Kd s, for which Ki = Kp / Ti and Kd = Kp Td (Åström and Hägglund, PID controllers,
# parallel form). The guess: 12, 60 and 0.6, then 13.6, 57 and 0.48. What comes: Kd = 20 and Ki = 5 by the first, which are 1 / Td and 1 / Ti, and Kd = 0.036 and Ki = 0.24,
# the times themselves, by the second. With the right gains the position settles; with those of the first it is out of all bounds after a
# second, and those of the second leave it 6 % short of its target after three.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check auto-control-tools==0.0.1
cd "$work"
cat >try.py <<'PYTHON'
import auto_control_tools as act

DEAD, LAG, STEP = 0.1, 1.0, 0.001


def after(kp, ki, kd, seconds):
    """Where the axis is after a step of 1; the derivative is that of what is measured over 10 ms."""
    place = total = 0.0
    places, commands = [0.0] * 11, [0.0] * round(DEAD / STEP)
    for _ in range(round(seconds / STEP)):
        total += (1.0 - place) * STEP
        commands.append(kp * (1.0 - place) + ki * total - kd * (places[-1] - places[-11]) / (10 * STEP))
        place += (commands.pop(0) - place) / LAG * STEP
        places.append(place)
    return place


model = act.FirstOrderModel(K=1.0, tau=LAG, theta=DEAD)
for rule, ti, td, tool in (
    ("Ziegler-Nichols", 2 * DEAD, 0.5 * DEAD, act.ZieglerNicholsControllerAproximation),
    ("Cohen-Coon", DEAD * 32.6 / 13.8, DEAD * 4 / 11.2, act.CohenCoonControllerAproximation),
):
    made = tool.get_controller(model, act.PID)
    print(f"{rule}: Kp {made.kp:.3g}, Ki {made.ki:.3g}, Kd {made.kd:.3g}; by the rule Ki {made.kp / ti:.3g}, Kd {made.kp * td:.3g}")
    for name, gains in (("of the package", (made.kp, made.ki, made.kd)), ("of the rule", (made.kp, made.kp / ti, made.kp * td))):
        places = [after(*gains, seconds) for seconds in (1.0, 3.0)]
        print(f"  {name}: after 1 and 3 s at", *(f"{place:.2f}" if abs(place) < 9 else "no place" for place in places))
PYTHON
cat >expected <<'TEXT'
Ziegler-Nichols: Kp 12, Ki 5, Kd 20; by the rule Ki 60, Kd 0.6
  of the package: after 1 and 3 s at no place no place
  of the rule: after 1 and 3 s at 0.98 1.00
Cohen-Coon: Kp 13.6, Ki 0.236, Kd 0.0357; by the rule Ki 57.5, Kd 0.485
  of the package: after 1 and 3 s at 1.05 0.94
  of the rule: after 1 and 3 s at 0.99 1.00
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
