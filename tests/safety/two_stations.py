"""T15: two stations of one library on a server.

Check for lost updates and for lost recordings made while the server was gone.

    python -m tests.safety.two_stations --edits 10000 --outage 600 --moves 200

Three things, each left out where its number is 0: edits of both stations at once (`station_edits`), recording while the
server, the shared place and the stations themselves go (`station_outages`), and moving a library to the server and
back while being killed (`moving_kills`).
"""

import argparse
import logging
from collections.abc import Iterator
from pathlib import Path

from tests.driver import Found, drive
from tests.safety.clinic_material import make_clinic, own_server
from tests.safety.moving_kills import move_killed
from tests.safety.station_edits import edit_together
from tests.safety.station_outages import live_through_outages


def run(asked: argparse.Namespace, folder: Path) -> Iterator[tuple[str, Found]]:
    logging.disable(logging.CRITICAL)  # a server that is gone is what this is about
    folder.chmod(0o755)  # for the server's own user
    edits, outage, moves = (folder / name for name in ("edits", "outage", "moves"))
    for one in (edits, outage, moves):
        one.mkdir()
    with own_server(folder / "pg") as server:
        if asked.edits:
            yield "edits", edit_together(make_clinic(edits, server), edits, asked.edits, asked.seed)
        if asked.outage:
            clinic = make_clinic(outage, server)
            yield "outage", live_through_outages(clinic, server, outage, asked.outage, asked.seed)
        if asked.moves:
            yield "moves", move_killed(server, moves, asked.moves, asked.seed)


if __name__ == "__main__":
    drive(
        __doc__,
        run,
        edits=(10_000, "of both stations"),
        outage=(600.0, "for how many seconds things go wrong"),
        moves=(200, "kills of moves there and back"),
        seed=1,
    )
