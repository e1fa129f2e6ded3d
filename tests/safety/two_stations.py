"""T15: two stations of one library on a server.

Check for lost updates and for lost recordings made while the server was gone.

    python -m tests.safety.two_stations --edits 10000 --outage 600 --moves 200

Three things, each left out where its number is 0: edits of both stations at once (`station_edits`), recording while the
server, the shared place and the stations themselves go (`station_outages`), and moving a library to the server and
back while being killed (`moving_kills`).
"""

import argparse
import logging
import tempfile
import time
from pathlib import Path

from tests.safety.clinic_material import make_clinic, own_server
from tests.safety.moving_kills import move_killed
from tests.safety.station_edits import edit_together
from tests.safety.station_outages import live_through_outages


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--edits", type=int, default=10_000, help="of both stations")
    parser.add_argument("--outage", type=float, default=600.0, metavar="S", help="how long things go wrong")
    parser.add_argument("--moves", type=int, default=200, metavar="KILLS", help="of moves there and back")
    parser.add_argument("--seed", type=int, default=1)
    required = parser.parse_args()
    logging.disable(logging.CRITICAL)  # a server that is gone is what this is about
    faults = []
    # a short path: a server's socket has 107 letters at most
    with tempfile.TemporaryDirectory(prefix="t15") as name, own_server(Path(name) / "pg") as server:
        Path(name).chmod(0o755)  # for the server's own user
        for what, work in (
            ("edits", lambda folder: edit_together(make_clinic(folder, server), folder, required.edits, required.seed)),
            (
                "outage",
                lambda folder: live_through_outages(
                    make_clinic(folder, server), server, folder, required.outage, required.seed
                ),
            ),
            ("moves", lambda folder: move_killed(server, folder, required.moves, required.seed)),
        ):
            if getattr(required, what):
                folder, begin_s = Path(name) / what, time.monotonic()
                folder.mkdir()
                found = work(folder)
                print(f"{what}: {found}, in {time.monotonic() - begin_s:.0f} s", flush=True)
                faults += found.faults
    print(*(f"- {fault}" for fault in faults), sep="\n")
    raise SystemExit(bool(faults))


if __name__ == "__main__":
    main()
