#!/usr/bin/env bash
# basic-pid 0.2.7 takes a sample time and never uses it, so that its integral grows with the number of samples and its derivative shrinks with it.
#
# A speed loop has a motor of 0.5 s (first order, sampled exactly) and a controller with a gain of 1, an integral gain of 4 per s and steps of 100, 10 and 1 ms, each told to the controller. The
# guess: a steady error of 1 integrates to 5 in 5 s, a ramp of 1 per s has a derivative of 1, and the loop overshoots by 7 % and rests at 1, whatever the step (closed form: s2 + 4 s + 8,
# a damping of 0.71, and a zero at 4 per s). What comes: that is right if the step is 1, of whatever unit. In steps of 10 ms the integral is 499.5 and the derivative 0.01;
# the loop has an integral gain of 40, 400 and 4000 per s, swings up to twice the set speed and does not rest. Only a caller who puts the sample time into the
# gains himself has the loop that he asked for.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check basic-pid==0.2.7
cd "$work"
cat >try.py <<'PYTHON'
import math

from basicpid import BasicPid


def controller(step, *gains):
    made = BasicPid()
    made.setIntegrateModeOn()
    made.setTimeinc(step)
    made.setGains(*gains)
    return made


def speeds(step, gains, told):
    made, speed, course = controller(told, *gains), 0.0, []
    keeps = math.exp(-step / 0.5)
    for _ in range(round(5 / step)):
        speed = keeps * speed + (1 - keeps) * made.get(1.0, speed)
        course.append(speed)
    return f"{max(course):.3g}, at 5 s {course[-1]:.3g}"


for step in (1.0, 0.1, 0.01):
    count = round(5 / step)
    integral, derivative = controller(step, 0, 1, 0), controller(step, 0, 0, 1)
    for number in range(1, count + 1):
        sum_of_ones, slope = integral.get(1.0, 0.0), derivative.get(number * step, 0.0)
    print(f"step of {step} s: integral of 1 in 5 s {sum_of_ones:.1f}, derivative of 1 per s {slope:.2f}")
for step in (0.1, 0.01, 0.001):
    print(f"speed loop, step of {step} s: largest {speeds(step, (1, 4, 0), step)}; gain by hand: largest {speeds(step, (1, 4 * step, 0), step)}")
PYTHON
cat >expected <<'TEXT'
step of 1.0 s: integral of 1 in 5 s 4.5, derivative of 1 per s 1.00
step of 0.1 s: integral of 1 in 5 s 49.5, derivative of 1 per s 0.10
step of 0.01 s: integral of 1 in 5 s 499.5, derivative of 1 per s 0.01
speed loop, step of 0.1 s: largest 2.03, at 5 s -0.00057; gain by hand: largest 1.1, at 5 s 1
speed loop, step of 0.01 s: largest 2, at 5 s 2; gain by hand: largest 1.07, at 5 s 1
speed loop, step of 0.001 s: largest 2, at 5 s 0.507; gain by hand: largest 1.07, at 5 s 1
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
