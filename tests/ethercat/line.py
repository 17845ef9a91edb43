"""A small master for tests: frames by hand on a simulated line of slaves."""

import struct
from collections.abc import Sequence

from tests.drive_node.conftest import FakeAxis, Signal

from axisrig.bench.bus.ethercat.segment import EthercatSegment, Link
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.node import EthercatDrive, SlaveSettings
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler
