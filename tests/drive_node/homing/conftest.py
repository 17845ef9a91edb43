"""The tests of homing share one machine, `homing_machine.py`."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
