#!/usr/bin/env bash
# ptcal 0.1.4 gives a platinum thermometer a resistance below zero as soon as the temperature is below 0.01 degrees Celsius, and calibrates by it without a residual.
#
# A thermometer without any deviation from the scale, 100 ohm at the triple point of water, is asked for its resistance. The guess: 84.414 ohm at the mercury point, 21.586 at that of argon,
# 99.996 at the ice point (ITS-90, W_r of the fixed points; the polynomial of equation 9a gives the logarithm of W_r, that of 10a gives W_r itself), and the temperatures back. What
# comes: -16.9 ohm, -153.3 and 0.0, for the logarithm stands for the ratio, and back 213 degrees, 241 and 250. A calibration by ideal readings at argon, mercury, water, gallium and zinc
# has coefficients of -7.0 and -3.1 below the triple point, where 0 is right, and residuals of 0 mK, as two coefficients meet two points. Above the triple point all is right to 1 mK.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check ptcal==0.1.4 numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io

import pandas as pd
from ptcal import PtCalibrator, PtSensor

POINTS = (("argon", -189.3442, 0.21585975), ("mercury", -38.8344, 0.84414211), ("ice", 0.0, 0.99996012), ("gallium", 29.7646, 1.11813889), ("zinc", 419.527, 2.56891730))
ideal = PtSensor("1", standard="ITS90", R_TPW=100.0)
for name, temperature, ratio in POINTS:
    ohm = ideal.get_resistance(temperature)
    print(f"{name}, {temperature} C: {ohm:.3f} ohm, by the scale {100 * ratio:.3f}; {100 * ratio:.3f} ohm are {ideal.get_temperature(100 * ratio):.3f} C")
rows = [("1", temperature, 0.001, 100 * ratio) for name, temperature, ratio in POINTS if name != "ice"] + [("1", 0.01, 0.001, 100.0)]
with contextlib.redirect_stdout(io.StringIO()):
    calibration = PtCalibrator(pd.DataFrame(rows), sensor_type="Pt100")
    calibration.calculate_its90()
found = calibration.coeffs_its90.iloc[0]
print(f"calibrated by ideal readings: above a {abs(found['a7']):.4f}, b {abs(found['b7']):.4f}; below a {found['a_neg']:.4f}, b {found['b_neg']:.4f};",
      f"residuals below {calibration.residuen_its.query('Temperatur < 0')['ITS90_Residuum_mK'].abs().max():.3f} mK")
PYTHON
cat >expected <<'TEXT'
argon, -189.3442 C: -153.313 ohm, by the scale 21.586; 21.586 ohm are 241.289 C
mercury, -38.8344 C: -16.943 ohm, by the scale 84.414; 84.414 ohm are 213.290 C
ice, 0.0 C: -0.004 ohm, by the scale 99.996; 99.996 ohm are 250.000 C
gallium, 29.7646 C: 111.814 ohm, by the scale 111.814; 111.814 ohm are 29.765 C
zinc, 419.527 C: 256.892 ohm, by the scale 256.892; 256.892 ohm are 419.526 C
calibrated by ideal readings: above a 0.0000, b 0.0000; below a -7.0341, b -3.1332; residuals below 0.000 mK
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
