"""Start-up of a drive over SDO: mapping, SYNC period, mode, then NMT operational.

The calls block until the drive has answered; on a simulated bus that takes simulated time, on a
real one wall time. Order of a mapping change: CiA 301 (disable by bit 31 of the COB-ID, empty the
mapping, write the entries, write their number, set the type, enable).
"""

from typing import Any

from canopen.sdo.exceptions import SdoAbortedError, SdoCommunicationError

from kernel.drives.mapping import Telegram
from kernel.errors import Alarm

NOT_VALID = 1 << 31
CSP = 8


def _communication_index(telegram: Telegram) -> int:
    base = 0x1800 if telegram.name.startswith("T") else 0x1400
    return base + int(telegram.name[-1]) - 1


def map_telegram(sdo: Any, telegram: Telegram, node_id: int) -> None:
    """Write one PDO's mapping and communication parameters."""
    communication = sdo[_communication_index(telegram)]
    mapping = sdo[_communication_index(telegram) + 0x200]
    cob_id = telegram.cob_id(node_id)
    communication[1].raw = cob_id | NOT_VALID
    mapping[0].raw = 0
    for position, mapped in enumerate(telegram.objects, 1):
        mapping[position].raw = mapped.entry
    mapping[0].raw = len(telegram.objects)
    communication[2].raw = telegram.transmission
    if telegram.inhibit_100us:
        communication[3].raw = telegram.inhibit_100us
    communication[1].raw = cob_id


def commission(node: Any, telegrams: dict[str, Telegram], sync_period_us: int, axis: str) -> None:
    """Configure one drive and start it (NMT operational).

    node: canopen RemoteNode. Raises Alarm 900011 when the drive refuses an object or is silent.
    """
    step = "0x1006 communication cycle period"
    try:
        node.sdo[0x1006].raw = sync_period_us
        for telegram in telegrams.values():
            step = f"mapping of {telegram.name}"
            map_telegram(node.sdo, telegram, node.id)
        step = "0x6060 modes of operation (cyclic synchronous position)"
        node.sdo[0x6060].raw = CSP
    except (SdoAbortedError, SdoCommunicationError) as error:
        raise Alarm(900011, axis=axis, node=node.id, step=step, answer=str(error)) from error
    node.nmt.send_command(0x01)
