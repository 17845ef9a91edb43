"""The commands that list what plans and rigs may say; imports as in `bench.cli`."""

from typing import Annotated

import typer

from bench.options import rejecting


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
def faults() -> None:
    """List what a fault column may bring about."""
    from bench.rig.faults import faults_table

    print(faults_table())


LISTINGS = (metrics, drives, faults)
