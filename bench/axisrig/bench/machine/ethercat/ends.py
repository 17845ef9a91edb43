"""Both ends of one drive on an EtherCAT line, whatever its family."""

from collections.abc import Callable
from typing import NamedTuple

from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.machine.ethercat.slaves import Entered
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.ethercat.carrier import EthercatCarrier
from axisrig.kernel.drives.ethercat.mailbox_port import MailboxPort
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.drives.ethercat.slave_data import SlaveData
from axisrig.kernel.drives.ethercat.steps import DriveSteps
from axisrig.kernel.drives.ethercat.transactions import Transactions
from axisrig.kernel.drives.interface import Drive, DriveWatch
from axisrig.kernel.time.clock import Clock
from axisrig.kernel.time.scheduler import Scheduler


class Plugged(NamedTuple):
    """What a drive is made of. seed: of everything random in it. entered: gets its states."""

    settings: Settings
    axis: str
    scheduler: Scheduler
    beside: Beside
    seed: int
    entered: Entered


class Connected(NamedTuple):
    """The control's end of a drive.

    port: its mailbox. link: the drive as the channel sees it. steps: its start-up. watch: makes the
    watch over it.
    """

    port: MailboxPort
    link: Drive
    steps: DriveSteps
    watch: Callable[[EthercatCarrier], DriveWatch]


class SlaveEnds:
    """A virtual drive, and what the control needs of it; a family derives its own.

    settings, data: of the process image of the control.
    """

    node: EthercatDrive
    settings: SlaveSettings
    data: SlaveData

    def connect(self, transactions: Transactions, clock: Clock) -> Connected:
        """Make the control's end."""
        raise NotImplementedError
