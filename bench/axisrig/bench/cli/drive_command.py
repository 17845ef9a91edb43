"""The command `axisrig drive`; imports as in `axisrig.bench.cli.main`."""

from pathlib import Path
from typing import Annotated

import typer

from axisrig.bench.cli.beside.waiting import waiting_for_line
from axisrig.bench.cli.options import (
    BitrateOption,
    BusOption,
    ChannelOption,
    InterfaceOption,
    SegmentOption,
    SetOption,
    rejecting,
)
from axisrig.bench.cli.outside import hardware, to_stderr
from axisrig.kernel.errors import UserError

BySyncOption = Annotated[
    bool,
    typer.Option(
        "--by-sync",
        help="Time of the drives goes on by one period with each SYNC, however late it is.",
    ),
]


@rejecting
def drive(
    rig: Annotated[Path, typer.Argument(help="Rig file (TOML).")],
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    options: BusOption = None,
    bitrate: BitrateOption = None,
    segment: SegmentOption = None,
    axes: Annotated[
        list[str] | None, typer.Option("--axis", help="Only this axis; several allowed.")
    ] = None,
    for_s: Annotated[
        float | None, typer.Option("--for", min=0.0, help="End after so many seconds.")
    ] = None,
    by_sync: BySyncOption = False,
    is_real: Annotated[
        bool,
        typer.Option("--real", help="--interface ecat: the channel may be any Ethernet interface."),
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="Folder for bus log, events, latches and trace."),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option("--store", help="File that keeps the parameters stored by 1010."),
    ] = None,
    eds: Annotated[
        Path | None, typer.Option("--eds", help="Write the EDS of the drive there, and end.")
    ] = None,
    esi: Annotated[
        Path | None,
        typer.Option("--esi", help="Write the ESI file of the drive on EtherCAT there, and end."),
    ] = None,
    assignments: SetOption = None,
) -> None:
    """Run the virtual drives of a rig for the master of somebody else, until Ctrl-C.

    --interface ecat --channel IF: as EtherCAT slaves on an Ethernet interface; else on a CAN bus.
    """
    with waiting_for_line(f"making the drives of {rig}") as put_out:
        from axisrig.bench.campaign.hardware_runs import Outside
        from axisrig.bench.tools.virtual_drive import ethercat
        from axisrig.bench.tools.virtual_drive.serve import (
            drive_settings,
            serve,
            whose_eds,
            write_eds,
        )

        if interface == ethercat.INTERFACE or esi is not None:
            settings = ethercat.line_settings(rig, axes or [], assignments or [])
            if esi is not None:
                print(ethercat.write_esi(settings, esi))
                to_stderr(f"the drive of {ethercat.whose_esi(settings)}")
                return
            given = {"--bitrate": bitrate, "--option": options, "--segment": segment, "--eds": eds}
            _refuse([name for name, value in given.items() if value] + ["--by-sync"] * by_sync)
            wanted = ethercat.Wanted(channel, is_real, out, store, for_s)
            with hardware() as real_time:
                ethercat.serve_line(settings, wanted, real_time, put_out)
            return
        if is_real:
            raise UserError("this is for EtherCAT", value="--real", hint="--interface ecat")
        said = Outside(hardware, True, to_stderr, interface, channel, options, bitrate, segment)
        settings = drive_settings(rig, said, axes or [], assignments or [])
        if eds is not None:
            print(write_eds(settings, eds))
            to_stderr(f"the drive of {whose_eds(settings)}")
            return
        serve(settings, said, put_out, by_sync=by_sync, for_s=for_s, folder=out, store=store)


def _refuse(names: list[str]) -> None:
    for name in names:
        raise UserError("this is for CAN, not for EtherCAT", value=name, hint="leave it out")
