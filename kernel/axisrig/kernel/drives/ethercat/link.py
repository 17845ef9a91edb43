"""The control's end of one drive on EtherCAT: CiA 402 in a process image, and the slave's state."""

from axisrig.kernel.drives.cia402.link import Cia402Drive
from axisrig.kernel.drives.cia402.words import latch_object
from axisrig.kernel.drives.ethercat.image import objects_of
from axisrig.kernel.drives.ethercat.image_data import ImageData
from axisrig.kernel.drives.ethercat.mailbox import Mailbox
from axisrig.kernel.drives.ethercat.settings import SlaveSettings
from axisrig.kernel.time.clock import TimeNs


class EthercatLink(Cia402Drive):
    """One drive, read and written once per cycle."""

    def __init__(
        self,
        settings: SlaveSettings,
        data: ImageData,
        mailbox: Mailbox,
        *,
        proves_latches: bool = False,
        proves_places: bool = False,
    ) -> None:
        super().__init__(
            settings, data, mailbox, proves_latches=proves_latches, proves_places=proves_places
        )
        self.mailbox = mailbox
        self._has_second = any(o.field == "second" for o in objects_of(settings.inputs))
        mailbox.emergency = self.note_emergency

    @property
    def has_second(self) -> bool:
        """Whether the inputs carry the second encoder."""
        return self._has_second

    def second_period_ns(self, cycle_ns: TimeNs) -> TimeNs | None:
        """Return how often 0x60E4:1 is promised: with each cycle."""
        return cycle_ns if self._has_second else None


def make_data(settings: SlaveSettings) -> ImageData:
    """Make the cyclic values of a drive."""
    return ImageData(settings, latch_object(settings.probe_input, settings.edge))
