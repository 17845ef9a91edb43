#!/usr/bin/env bash
# sdfio 2.0.0 makes a flat surface of a rough one when it converts floating-point heights to integers.
#
# A ground surface of some micrometres lacks one point and is written as SDF (ISO 25178-71) with the heights as they come, binary64, whose scale is 1 m. Older
# programs read 16 bits only, for which the page of the package names `sdfio convert -t int16`. The guess: a scale of fractions of a nanometre is chosen, as it is when the same
# heights are written as int16 at once, and each height is within half a step. What comes: the scale of 1 m is kept, for all heights "fit" into 16 bits: each is rounded to 0 m.
# The exit code is 0 and there is no word; the missing point is still missing. So with int32, and in Python with refit_z_scale=True. Heights of 32-bit integers
# are refused as out of range if they are to have 16 bits.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check sdfio==2.0.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import subprocess

import numpy as np
import sdfio

heights_m = 1e-6 * np.array([[0.8, -2.4, 1.1, 3.9], [-0.3, np.nan, 2.2, -3.1], [1.7, 0.4, -1.9, 0.6]])


def show(name, read):
    step, off = read.header.z_scale, np.nanmax(abs(read.data - heights_m))
    extent = np.nanmax(read.data) - np.nanmin(read.data)
    print(f"{name}: step {step:.3g} m, height {1e6 * extent:.3f} um, off by {1e6 * off:.3f} um, missing {np.isnan(read.data).sum()}")


for kind in ("int16", "int32"):
    about = sdfio.Metadata(data_type=getattr(sdfio.DataType, kind.upper()))
    sdfio.write("once.sdf", heights_m, x_scale=1e-6, y_scale=1e-6, metadata=about)
    show(f"{kind} at once", sdfio.read("once.sdf"))
sdfio.write("surface.sdf", heights_m, x_scale=1e-6, y_scale=1e-6)
show("binary64", sdfio.read("surface.sdf"))
for kind in ("binary32", "int16", "int32"):
    done = subprocess.run(["venv/bin/sdfio", "convert", "-t", kind, "surface.sdf", "again.sdf"], capture_output=True, text=True)
    show(f"converted to {kind} (exit {done.returncode}, output {done.stdout + done.stderr!r})", sdfio.read("again.sdf"))
refitted = sdfio.read("surface.sdf").with_revision(sdfio.Revision.ISO_2_0, data_type=sdfio.DataType.INT16, refit_z_scale=True)
refitted.save("again.sdf")
show("in Python, refit_z_scale", sdfio.read("again.sdf"))
about = sdfio.Metadata(data_type=sdfio.DataType.INT32)
sdfio.write("once.sdf", heights_m, x_scale=1e-6, y_scale=1e-6, metadata=about)
done = subprocess.run(["venv/bin/sdfio", "convert", "-t", "int16", "once.sdf", "again.sdf"], capture_output=True, text=True)
print("int32 to int16: exit", done.returncode, done.stderr.strip())
PYTHON
cat >expected <<'TEXT'
int16 at once: step 1.19e-10 m, height 7.000 um, off by 0.000 um, missing 1
int32 at once: step 1.82e-15 m, height 7.000 um, off by 0.000 um, missing 1
binary64: step 1 m, height 7.000 um, off by 0.000 um, missing 1
converted to binary32 (exit 0, output ''): step 1 m, height 7.000 um, off by 0.000 um, missing 1
converted to int16 (exit 0, output ''): step 1 m, height 0.000 um, off by 3.900 um, missing 1
converted to int32 (exit 0, output ''): step 1 m, height 0.000 um, off by 3.900 um, missing 1
in Python, refit_z_scale: step 1 m, height 0.000 um, off by 3.900 um, missing 1
int32 to int16: exit 1 sdfio: error: Data value out of range for SDF data type INT16 (-32768..32767)
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
