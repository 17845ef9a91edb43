#!/usr/bin/env bash
# spychart 1.0.0 counts the first reading after a change of the process among those before it, and weighs a sample of 10 parts like one of 1000.
#
# A bore is ground at 10 and 12 um by turns, and from the day on that the wheel is changed at 20 and 22, so that neighbours differ by 2; the chart is told that day. The guess: each part
# has limits of its own mean and moving ranges, 11 +- 5.32 and 21 +- 5.32 (ISO 7870-2, individuals: 2.66 times the mean moving range), and the mean range is 2. Of parts refused, 100 of
# 1000 and 5 of 10, the centre is 105 of 1010, 0.104 (ISO 7870-2, p chart: all refused by all inspected). What comes: the first reading of the new wheel counts for the old one too, so
# that its mean is 12.29, its limits are half as wide again and its mean range is 3, by the very step that the chart was told of; a worn day that is outside without the change is
# inside with it. A baseline given by its last day is right. The centre of the shares is 0.3, their plain mean: a day of 1000 with 10 % refused
# is out of control, by one of 10.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check spychart==1.0.0 numpy==2.4.6 pandas==3.1.1 matplotlib==3.11.2 seaborn==0.13.2 plotly==7.1.0
cd "$work"
cat >try.py <<'PYTHON'
import pandas as pd
from spychart import SPC
from spychart.spc_functions import mr_chart, p_chart, x_chart


def day(number):
    return f"2026-01-{number:02d}"


def table(values, **columns):
    return pd.DataFrame({"value": values, **columns}, index=pd.date_range(day(1), periods=len(values)))


def show(name, table, chart, change=None, **baseline):
    maker = SPC(table, "value", **baseline)
    if change:
        maker.add_process_change_date(change)
    made = maker.calculate_spc(chart)
    for centre, rows in made.groupby(made["CL"].round(6), sort=False):
        low, high = (" ".join(f"{value:.3f}" for value in sorted(set(rows[side]))) for side in ("LCL", "UCL"))
        outside = " ".join(str(value) for value in rows["process"][rows["Rule 1 violation"] == 1])
        print(f"{name}, {len(rows)} readings: centre {centre:.3f}, lower {low}, upper {high}, outside: {outside or 'none'}")


first, second = [10.0, 12.0, 10.0, 12.0, 10.0, 12.0], [20.0, 22.0, 20.0, 22.0, 20.0, 22.0]
show("first wheel alone", table(first), x_chart)
show("wheel changed", table(first + second), x_chart, day(7))
show("baseline of six days", table(first + second), x_chart, fix_control_start_dt=day(1), fix_control_end_dt=day(6))
show("ranges, first wheel alone", table(first), mr_chart)
show("ranges, wheel changed", table(first + second), mr_chart, day(7))
worn = [10.0, 11.0] * 7 + [14.5]
show("a worn day, first wheel alone", table(worn), x_chart)
show("a worn day, wheel changed", table(worn + second), x_chart, day(16))
show("shares", table([0.1, 0.5], sample_size=[1000, 10]), p_chart)
PYTHON
cat >expected <<'TEXT'
first wheel alone, 6 readings: centre 11.000, lower 5.681, upper 16.319, outside: none
wheel changed, 6 readings: centre 12.286, lower 4.307, upper 20.264, outside: none
wheel changed, 6 readings: centre 21.000, lower 15.681, upper 26.319, outside: none
baseline of six days, 12 readings: centre 11.000, lower 5.681, upper 16.319, outside: 20.0 22.0 20.0 22.0 20.0 22.0
ranges, first wheel alone, 6 readings: centre 2.000, lower 0.000, upper 6.540, outside: none
ranges, wheel changed, 6 readings: centre 3.000, lower 0.000, upper 9.810, outside: none
ranges, wheel changed, 6 readings: centre 2.000, lower 0.000, upper 6.540, outside: none
a worn day, first wheel alone, 15 readings: centre 10.767, lower 7.632, upper 13.901, outside: 14.5
a worn day, wheel changed, 15 readings: centre 11.344, lower 7.443, upper 15.244, outside: none
a worn day, wheel changed, 6 readings: centre 21.000, lower 15.681, upper 26.319, outside: none
shares, 2 readings: centre 0.300, lower 0.000 0.257, upper 0.343 0.735, outside: 0.1
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
