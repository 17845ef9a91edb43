"""The ESI file of a drive: its description for the tools of masters. Source: docs/ethercat.md."""

from typing import Final
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from axisrig.bench.drive.ethercat.description import ASSIGN_ACTIVATE, Description, Pdo
from axisrig.bench.drive.ethercat.sii import CONFIGURATION, SIZE

_TYPES: Final = {2: "SINT", 3: "INT", 4: "DINT", 5: "USINT", 6: "UINT", 7: "UDINT"}
_FMMUS: Final = {1: "Outputs", 2: "Inputs", 3: "MBoxState"}
_MANAGERS: Final = {1: "MBoxOut", 2: "MBoxIn", 3: "Outputs", 4: "Inputs"}


def esi_text(description: Description) -> str:
    """Return the ESI file of a drive; the same text on every call."""
    root = Element("EtherCATInfo", Version="1.6")
    vendor = SubElement(root, "Vendor")
    _text(vendor, "Id", _hex(description.vendor, 8))
    _text(vendor, "Name", description.vendor_name)
    descriptions = SubElement(root, "Descriptions")
    group = SubElement(SubElement(descriptions, "Groups"), "Group")
    _text(group, "Type", description.group)
    _text(group, "Name", description.group)
    device = SubElement(SubElement(descriptions, "Devices"), "Device", Physics="YY")
    _identity(device, description)
    for use in description.fmmus:
        _text(device, "Fmmu", _FMMUS[use])
    for manager in description.managers:
        sizes = {"DefaultSize": str(manager.length)}
        if manager.kind in (1, 2):
            sizes |= {"MinSize": "32", "MaxSize": "1024"}
        place = {"StartAddress": _hex(manager.start, 4), "ControlByte": _hex(manager.control, 2)}
        _text(device, "Sm", _MANAGERS[manager.kind], **sizes, **place, Enable="1")
    for kind, pdos in (("RxPdo", description.rxpdos), ("TxPdo", description.txpdos)):
        for pdo in pdos:
            _pdo(device, kind, pdo, is_fixed="PdoConfig" not in description.coe)
    mailbox = SubElement(device, "Mailbox", DataLinkLayer="1")
    if description.is_sercos:
        SubElement(mailbox, "SoE", ChannelCount="1")
    else:
        SubElement(mailbox, "CoE", dict.fromkeys((*description.coe, "SegmentedSdo"), "1"))
    _clock(device)
    eeprom = SubElement(device, "Eeprom")
    _text(eeprom, "ByteSize", str(SIZE))
    _text(eeprom, "ConfigData", CONFIGURATION.hex())
    indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="unicode") + "\n"


def _identity(device: Element, description: Description) -> None:
    code = {
        "ProductCode": _hex(description.product, 8),
        "RevisionNo": _hex(description.revision, 8),
    }
    _text(device, "Type", description.order, **code)
    _text(device, "Name", description.name)
    _text(device, "GroupType", description.group)
    if not description.is_sercos:
        _text(SubElement(device, "Profile"), "ProfileNo", "402")


def _pdo(device: Element, kind: str, pdo: Pdo, *, is_fixed: bool) -> None:
    assigned = {} if pdo.manager is None else {"Sm": str(pdo.manager)}
    element = SubElement(device, kind, {"Fixed": "1"} | assigned if is_fixed else assigned)
    _text(element, "Index", _hex(pdo.index, 4))
    _text(element, "Name", pdo.name)
    for entry in pdo.entries:
        part = SubElement(element, "Entry")
        _text(part, "Index", _hex(entry.index, 4))
        _text(part, "SubIndex", str(entry.sub))
        _text(part, "BitLen", str(entry.bits))
        _text(part, "Name", entry.name)
        _text(part, "DataType", _TYPES[entry.kind])


def _clock(device: Element) -> None:
    modes = SubElement(device, "Dc")
    synchron = SubElement(modes, "OpMode")
    _text(synchron, "Name", "DC-Synchron")
    _text(synchron, "AssignActivate", _hex(ASSIGN_ACTIVATE, 4))
    _text(synchron, "CycleTimeSync0", "0", Factor="1")
    _text(synchron, "ShiftTimeSync0", "0")
    free = SubElement(modes, "OpMode")
    _text(free, "Name", "SM-Synchron")
    _text(free, "AssignActivate", _hex(0, 4))


def _text(parent: Element, name: str, text: str, **attributes: str) -> None:
    SubElement(parent, name, attributes).text = text


def _hex(value: int, digits: int) -> str:
    return f"#x{value:0{digits}X}"
