#!/usr/bin/env bash
# sdypy-io-tdms 0.1.2 cuts the start of a TDMS signal to the second and its name at a slash, and writes neither the start nor more than 24 bits.
#
# A position from 12:00:00.999 on, its first sample 0.5 s later, and a spectrum stand in a TDMS file as LabVIEW keeps waveforms (wf_start_time, wf_start_offset, wf_increment, wf_xunit_string).
# The guess: each comes as a signal of its sampling rate (SEP005, the form that the package reads into), whose time stamp is that of its first sample, 12:00:01.499, as npTDMS itself has it in
# time_track; names are as they are, and a channel without an increment costs nothing but itself. What is written is read back, a count of 2^24 + 1 too. What comes: a start
# of 12:00:00, 1.499 s too early, with no word; of the name "vz mm/s" is left "vz", the two letters before the slash gone as well; the spectrum, in steps
# of 2 Hz, is a signal sampled at 0.5 Hz. With one text beside them no channel of the file is read. Written, the signal has no start at all, and the
# count is one less, for all is written as 32-bit floats.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check sdypy-io-tdms==0.1.2 sdypy-sep005==1.0.1 nptdms==1.13.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter
from sdypy_io_tdms.tdms import read_tdms, write_tdms

START = np.datetime64("2026-03-01T12:00:00.999", "us")


def channel(name, values, **properties):
    return ChannelObject("rig", name, np.array(values), properties=properties)


def shown(*channels):
    with TdmsWriter("made.tdms") as writer:
        writer.write_segment(channels)
    try:
        signals = read_tdms("made.tdms")
    except KeyError as error:
        return f"refused, KeyError {error}"
    return "; ".join(f"{signal['name']!r} from {signal.get('start_timestamp')}, {signal['fs']:.10g} Hz" for signal in signals)


position = channel("z", [1.0, 2.0], wf_start_time=START, wf_start_offset=0.5, wf_increment=0.001, unit_string="mm")
speed = channel("vz mm/s", [1.0, 2.0], wf_start_time=START, wf_start_offset=0.0, wf_increment=0.001, unit_string="mm/s")
spectrum = channel("Sz", [1.0, 2.0], wf_start_offset=0.0, wf_increment=2.0, wf_xname="Frequency", wf_xunit_string="Hz", unit_string="mm")
note = ChannelObject("rig", "note", ["touched", "clear"])
print("position:", shown(position))
print("first sample by npTDMS:", TdmsFile("made.tdms")["rig"]["z"].time_track(absolute_time=True, accuracy="ms")[0])
print("speed:", shown(speed))
print("spectrum:", shown(spectrum))
print("position and a text:", shown(position, note))
count = {"group": "rig", "name": "count", "unit_str": "", "fs": 1000.0, "data": np.array([16777217.0]), "start_timestamp": "2026-03-01T12:00:00"}
write_tdms(count, "written.tdms")
(again,) = read_tdms("written.tdms")
print("written from", count["start_timestamp"], f"with {count['data'][0]:.0f}, read from", again.get("start_timestamp"), f"with {again['data'][0]:.0f}")
PYTHON
cat >expected <<'TEXT'
position: 'z' from 2026-03-01T12:00:00, 1000 Hz
first sample by npTDMS: 2026-03-01T12:00:01.499000
speed: 'vz ' from 2026-03-01T12:00:00, 1000 Hz
spectrum: 'Sz' from None, 0.5 Hz
position and a text: refused, KeyError 'wf_increment'
written from 2026-03-01T12:00:00 with 16777217, read from None with 16777216
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
