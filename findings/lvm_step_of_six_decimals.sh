#!/usr/bin/env bash
# lvmio 1.0.0 writes the sample interval with six decimals: a minute at 1024 Hz is 27 ms too long when it is read again.
#
# A position is measured for a minute at some rates and written as LabVIEW measurement file, where X0 and Delta_X are the start and the interval of each channel. The guess: the interval
# comes back as it was, for X0 is written with 16 decimals. What comes: 1/1024 s is 0.000977 s, and 1/3000 s is 0.000333 s, in the same file whose X column, where there
# is one, has the right times to the end; the reader takes the interval and leaves the column, so that the last sample is at 60.026 s where
# its row says 59.999. Whoever compares with another recording sees a drift of 448 ppm, a spectrum is off by as much. A faster rate is better off:
# 1/51200 s has an exponent and six digits behind the first. With precision=12 all are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check lvmio==1.0.0
cd "$work"
cat >try.py <<'PYTHON'
import lvmio


def show(rate_hz, seconds=60, **how):
    samples = [0.001 * (at % 7) for at in range(rate_hz * seconds)]
    lvmio.write_lvm("log.lvm", [lvmio.Channel("position", samples, unit="mm", x0=0.0, delta_x=1 / rate_hz)], **how)
    lines = [line for line in open("log.lvm").read().split("\n") if line.strip()]
    step = next(line.split("\t")[1] for line in lines if line.startswith("Delta_X"))
    read = lvmio.read_lvm("log.lvm").segments
    end = read[0]["position"].time_axis()[-1]
    row = lines[-1].split("\t")[0] or "none"
    print(f"{rate_hz} Hz {how}: Delta_X {step}, segments {len(read)}, last sample {(len(samples) - 1) / rate_hz:.6f} s, in its row {row}, read {end:.6f} s")


for rate_hz in (1000, 1024, 2048, 3000):
    show(rate_hz)
show(1024, x_columns="No")
show(3000, x_columns="Multi")
show(51200, seconds=1)
show(1024, precision=12)
PYTHON
cat >expected <<'TEXT'
1000 Hz {}: Delta_X 0.001000, segments 1, last sample 59.999000 s, in its row 59.999000, read 59.999000 s
1024 Hz {}: Delta_X 0.000977, segments 1, last sample 59.999023 s, in its row 59.999023, read 60.025903 s
2048 Hz {}: Delta_X 0.000488, segments 1, last sample 59.999512 s, in its row 59.999512, read 59.964952 s
3000 Hz {}: Delta_X 0.000333, segments 1, last sample 59.999667 s, in its row 59.999667, read 59.939667 s
1024 Hz {'x_columns': 'No'}: Delta_X 0.000977, segments 1, last sample 59.999023 s, in its row none, read 60.025903 s
3000 Hz {'x_columns': 'Multi'}: Delta_X 0.000333, segments 1, last sample 59.999667 s, in its row 59.999667, read 59.939667 s
51200 Hz {}: Delta_X 1.953125E-5, segments 1, last sample 0.999980 s, in its row 0.999980, read 0.999980 s
1024 Hz {'precision': 12}: Delta_X 0.000976562500, segments 1, last sample 59.999023 s, in its row 59.999023437500, read 59.999023 s
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
