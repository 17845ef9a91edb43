"""Shows the run that is under way, on a page or in the terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import partial

from axisrig.bench.campaign.progress import CampaignProgress, Watch
from axisrig.bench.cli.beside.feed import Feed
from axisrig.bench.cli.beside.server import serving
from axisrig.bench.cli.beside.terminal import drawing
from axisrig.bench.cli.beside.ticking import ticking
from axisrig.bench.machine.live.pipe import Inlet
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError

PIPE = "live"


def showing(
    clock: Callable[[], float],
    put_out: Callable[[str], None],
    *,
    on_page: bool,
    in_terminal: bool,
) -> Watch:
    """Return what shows the states of runs beside their campaign.

    clock: gives seconds of wall time. put_out: takes the address of the page. Raises UserError for
    a terminal that is none.
    """
    if in_terminal and not sys.stderr.isatty():
        raise UserError("--live-terminal needs a terminal", hint="--live shows the same on a page")
    live = session_folder() / PIPE

    @contextmanager
    def beside(progress: CampaignProgress) -> Iterator[None]:
        with ExitStack() as open_:
            inlet = open_.enter_context(closing(Inlet(live)))
            feed = Feed(inlet, clock, progress.as_data)
            open_.enter_context(ticking(progress))
            if in_terminal:
                progress.show_beneath(lambda: drawing(feed.look()))
                open_.callback(partial(progress.show_beneath, None))
            if on_page:
                put_out(f"live: {open_.enter_context(serving(feed))}")
            yield

    return Watch(beside, live)
