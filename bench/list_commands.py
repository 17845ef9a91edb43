"""The commands that list what plans and rigs may say; imports as in `bench.cli`."""

from typing import Annotated

import typer

from bench.options import rejecting
from bench.params.command import params


@rejecting
def metrics() -> None:
    """List what a check column may ask for."""
    from bench.run.campaign import metrics_table

    print(metrics_table())


@rejecting
def drives(
    profile: Annotated[
        str | None, typer.Argument(help="Name of a profile: all its keys, not the list.")
    ] = None,
) -> None:
    """List the drive profiles that a rig may name, or the keys of one."""
    from bench.drive.profiles import profile_listing

    print(profile_listing(profile))


@rejecting
def faults(
    kind: Annotated[
        str | None, typer.Argument(help="A kind: what bus, drive and kernel do, not the list.")
    ] = None,
) -> None:
    """List what a fault column may bring about, or the reactions to one kind."""
    from bench.rig.faults import faults_table

    print(faults_table(kind))


LISTINGS = (metrics, drives, faults, params)
