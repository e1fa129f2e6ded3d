"""Two stations of a clinic work with one library, seen on two screens.

Check this also when the server goes away amid a walk.

    python -m tests.safety.two_displays OUT

Starts a PostgreSQL of its own and two instances of the application, each on a display of its own (Xvfb with openbox)
and with folders of its own, worked from outside by xdotool as `tests/tours/tour.py` does. Station one begins with a new
library and moves it to the server in the settings; station two joins at its first start. Then

1. a session is recorded on one and reviewed on the other, which was not started again;
2. both open the same patient and change the height: what the second states does not overwrite the first, and it is
reported; 3. the server is stopped at once amid a walk, which goes on and is stopped; once the server is there again
the walk is
   in the library once, with all its samples, and is read on the other station.

After each the database is looked into. Pictures of every stop go into OUT, a folder for each station.
"""

import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from subprocess import PIPE, Popen
from typing import Any

import numpy as np

from app.storage.clinic.joining import join
from app.storage.exchange import session_with_samples
from app.storage.opened import open_library
from core.session import RecordingKind
from devices.decoders import DECODERS
from tests.benchmarks.own_display import own_display, own_environment
from tests.driver import options
from tests.safety.clinic_material import OwnServer, Row, own_server, rows_of
from tests.tours.tour import INSIDE, WINDOW, Application, TourError, lead
from tests.tours.tour_stops import (
    DIGITS,
    KEYBOARD,
    PASSPHRASE,
    PLACES,
    Seen,
    Stop,
    at,
    at_step,
    is_recording,
    offers,
    states,
    walk,
)

LOOKS = (f"light {WINDOW}",)
CODE = "DEMO-7"
HEIGHTS = ("180", "182")  # cm, stated at station one, then at station two
PATIENCE_S = 60.0
AWAY_S = 12.0  # that a walk goes on without a server
MOST_ASKED_S = 0.5  # for an answer of a window's own thread; on a busy machine, with what xdotool takes
LONGEST_GAP_S = 0.05  # between samples of 100 Hz: none is missing


class WrongError(Exception):
    """What is in the library, or on a screen, is not what has to be."""


@dataclass(slots=True)
class Server:
    """A PostgreSQL of the proof's own, and its one database."""

    postgres: OwnServer
    address: str

    def rows(self, query: str) -> list[Row]:
        return rows_of(self.address, query)


@dataclass(slots=True)
class StationOnScreen:
    """One instance of the application: its window, and where its pictures go."""

    name: str
    application: Application
    out: Path

    def lead(self, *stops: Stop) -> None:
        try:
            lead(self.application, stops, self.out, LOOKS)
        except TourError as end:
            raise WrongError(f"{self.name}: {end}") from end

    def seen(self) -> Seen:
        return self.application.seen()


def prove(out: Path) -> Iterator[str]:
    """Go through all steps; gives a line for each."""
    with (
        tempfile.TemporaryDirectory(prefix="gaitwright-clinic-") as folder,
        _server() as server,
        _station("one", out) as one,
        _station("two", out) as two,
    ):
        place = Path(folder) / "recordings"
        place.mkdir()
        _set_up(one, two, server, place)
        yield f"station one moved its library to the server, station two joined: {_counted(server)}"
        _review_elsewhere(one, two, server)
        yield f"what station one recorded is reviewed on station two: {_counted(server)}"
        yield _change_the_same(one, two, server)
        yield _lose_the_server(one, two, server, Path(folder))


def _set_up(one: StationOnScreen, two: StationOnScreen, server: Server, place: Path) -> None:
    first = next(number for number, stop in enumerate(KEYBOARD) if stop.name == "05-home")
    one.lead(*KEYBOARD[:first])
    one.lead(
        Stop("10-home", offers("New patient"), ("click Settings",)),
        Stop(
            "11-settings",
            states("Several workstations"),
            (
                "to Address of the clinic",
                f"type {server.address}",
                "to Shared storage that all workstations",
                f"type {place}",
                "to Move to the clinic",
            ),
        ),
        Stop("12-to-be-moved", states("Several workstations"), ("press space",)),
        Stop(
            "13-moved",
            states("are now on the clinic's server, checked row by row"),
            ("press Escape",),
            patience_s=PATIENCE_S,
        ),
        Stop("14-home", offers("New patient")),
    )
    two.lead(
        Stop("10-first-start", at("FirstStartPage"), ("click Join the clinic",)),
        Stop("11-wrong", at("JoinPage"), ("type nowhere", "press Return")),
        Stop(
            "12-refused",
            lambda seen: any(
                "This is not the address of a PostgreSQL server" in name for name in (*seen.words, *seen.controls)
            ),
            ("press ctrl+a", f"type {server.address}"),
        ),
        Stop("13-typed", at("JoinPage"), ("press Return",)),
        Stop(
            "13a-place",
            states("The server specifies this storage for the recordings"),
            ("press Return",),
            patience_s=PATIENCE_S,
        ),
        Stop("14-log-in", states("The clinic's library on"), (f"type {PASSPHRASE}", "press Return")),
        Stop("15-home", offers("New patient"), patience_s=PATIENCE_S),
    )
    _expect(server.rows("SELECT count(*) AS n FROM operators")[0]["n"] == 1, "one operator is on the server")


def _review_elsewhere(one: StationOnScreen, two: StationOnScreen, server: Server) -> None:
    by_name = {stop.name: stop for stop in KEYBOARD}
    one.lead(
        Stop("20-home", offers("New patient"), ("press ctrl+n",)),
        *(by_name[name] for name in ("06-patient", "07-patient-typed", "07a-source", "07b-sensors", "07c-placed")),
        *(by_name[name] for name in ("08a-stand-still", "08b-standing", "09-free-motion")),
        *walk(20, ("press 1", "press space"), "press space"),
        by_name["10d-keep"],
        Stop("31-kept", offers("Results"), ("press Return",)),
        Stop("32-results", offers("Legs", "Data"), patience_s=PATIENCE_S),
        Stop("33-leave", at_step("ResultsStep"), ("click All patients",)),
        Stop("34-home", offers("New session")),
    )
    _wait_until(lambda: not _waiting(server), "all recordings are handed over")
    two.lead(
        Stop("20-appeared", offers("New session for DEMO-7"), ("to Visits", "press Down", "press Return")),
        Stop("21-reviewed", offers("Legs", "Data"), patience_s=PATIENCE_S, lingers_s=2.0),
    )
    found = server.rows("SELECT kind, state FROM recordings ORDER BY kind")
    kinds = sorted(row["kind"] for row in found)
    _expect(kinds == ["free_motion", "standing", "walking"], f"three recordings: {found}")
    _expect({row["state"] for row in found} == {"closed"}, f"all are closed: {found}")


def _change_the_same(one: StationOnScreen, two: StationOnScreen, server: Server) -> str:
    """Both have the patient's page open before either changes it."""
    before = _patient(server)
    one.lead(
        Stop("40-home", offers("New session for DEMO-7"), ("to Visits", "press Down", "press Return")),
        Stop("41-session", offers("Legs"), ("press ctrl+1",), patience_s=PATIENCE_S),
        Stop("42-patient", at_step("PatientStep"), ("to Body height",)),
    )
    two.lead(
        Stop("40-session", offers("Legs"), ("press ctrl+1",)),
        Stop("41-patient", at_step("PatientStep"), ("to Body height",)),
    )
    one.lead(Stop("43-changes", at_step("PatientStep"), ("press ctrl+a", f"type {HEIGHTS[0]}", "press Tab")))
    _wait_until(lambda: _patient(server)["version"] == before["version"] + 1, "station one's height is saved")
    two.lead(Stop("42-changes", at_step("PatientStep"), ("press ctrl+a", f"type {HEIGHTS[1]}", "press Tab")))
    reported = "meanwhile"
    two.lead(
        Stop(
            "43-told",
            lambda seen: any(reported in words for words in seen.words),
            ("click Leave theirs",),
            lingers_s=1.0,
        ),
        Stop("44-answered", lambda seen: at_step("PatientStep")(seen) and not seen.states(reported), lingers_s=1.0),
    )
    after = _patient(server)
    # station two's own value is in the history, made and taken back; the row holds the first one's
    _expect(round(float(after["height_m"]) * 100) == int(HEIGHTS[0]), f"the height is the first one's: {after}")
    return f"both changed the height: {HEIGHTS[0]} cm is in the library, as station two was asked and answered"


def _lose_the_server(one: StationOnScreen, two: StationOnScreen, server: Server, folder: Path) -> str:
    placed = tuple(key for place in PLACES.values() for key in (f"press {DIGITS[place]}", "press Down"))
    one.lead(
        Stop("50-leave", at_step("PatientStep"), ("click All patients",)),
        Stop("51-home", offers("New session for DEMO-7"), ("click New session",)),
        Stop("52-patient", at_step("PatientStep"), ("click Put on sensors",)),
        Stop("53-source", at_step("SensorsStep"), ("press Return",), lingers_s=1.0),
        Stop("53b-sensors", offers("Detect from movement"), placed, lingers_s=5.0),
        Stop("53c-placed", states("All six sensors are assigned and connected"), ("press Return",), lingers_s=1.0),
        Stop("54-stand-still", at_step("StandStillStep"), ("press space",), lingers_s=1.0),
        Stop("55-standing", is_recording, lingers_s=1.0),
        Stop("56-free-motion", lambda seen: at_step("FreeMotionStep")(seen) and seen.is_recording, lingers_s=7.0),
        Stop("57-choose", offers("Barefoot"), ("press 1", "press space"), lingers_s=1.0, patience_s=90.0),
        Stop("58-walking", is_recording, lingers_s=3.0),
    )
    began_s = time.monotonic()
    server.postgres.kill()
    slowest_s = _watch(one, AWAY_S)
    one.lead(Stop("59-away", lambda seen: any("does not respond" in one for one in (seen.banner, *seen.words))))
    two.lead(Stop("60-away", lambda seen: any("does not respond" in one for one in (seen.banner, *seen.words))))
    one.application.hand("key", "space")
    walked_s = time.monotonic() - began_s
    slowest_s = max(slowest_s, _watch(one, 5.0))
    one.lead(Stop("60-stopped", lambda seen: not seen.states("Stop walk")))
    server.postgres.start()
    one.lead(
        Stop("61-back", lambda seen: not any("does not respond" in one for one in (seen.banner, *seen.words))),
        Stop("62-asked", offers("Keep 1"), ("press k",), patience_s=PATIENCE_S, lingers_s=2.0),
        Stop("63-kept", offers("Results"), ("press Return",), patience_s=PATIENCE_S),
        Stop("64-results", offers("Legs", "Data"), patience_s=PATIENCE_S, lingers_s=2.0),
        Stop("65-leave", at_step("ResultsStep"), ("click All patients",)),
        Stop("66-home", offers("New session")),
    )
    _wait_until(lambda: not _waiting(server), "what was recorded meanwhile is handed over")
    two.lead(
        Stop("61-leave", at_step("PatientStep"), ("click All patients",), patience_s=PATIENCE_S),
        Stop("62-home", offers("New session for DEMO-7"), ("to Visits", "press Home", "press Return"), lingers_s=3.0),
        Stop("63-reviewed", offers("Legs", "Data"), patience_s=PATIENCE_S, lingers_s=2.0),
    )
    samples, longest_s = _read_walk(server, folder / "third", walked_s)
    return (
        f"the server went amid a walk and came back: it is there once with {samples} samples of each of six sensors, "
        f"none missing in {longest_s:.1f} s; a window answered in {1000 * slowest_s:.0f} ms at most meanwhile"
    )


def _read_walk(server: Server, folder: Path, walked_s: float) -> tuple[int, float]:
    """Read the latest session as a third station; how many samples each sensor has of its walk, and how long it is."""
    join(folder, server.address, str(folder.with_name("recordings")))
    with open_library(folder, PASSPHRASE) as opened:
        sessions = opened.library.sessions.list()
        _expect(len(sessions) == 2, f"two sessions: {len(sessions)}")
        stored = opened.library.sessions.view(sessions[0].id)
        walks = [one for one in stored.recordings if one.details.kind is RecordingKind.WALKING]
        _expect(len(walks) == 1, f"the walk is there once: {len(walks)}")
        read = session_with_samples(opened, stored, DECODERS, lambda _share, _what: None)
    (reported,) = (one for one in read.recordings if one.kind is RecordingKind.WALKING)
    _expect(len(reported.imu) == 6, f"six sensors: {sorted(reported.imu)}")
    gaps_s = {site: float(np.diff(block.time_s).max()) for site, block in reported.imu.items()}
    _expect(max(gaps_s.values()) < LONGEST_GAP_S, f"no sample is missing: {gaps_s}")
    lasted_s = min(float(block.time_s[-1] - block.time_s[0]) for block in reported.imu.values())
    _expect(lasted_s > walked_s, f"the walk goes on without the server: {lasted_s:.1f} s of more than {walked_s:.1f} s")
    return min(len(block.time_s) for block in reported.imu.values()), lasted_s


def _watch(station: StationOnScreen, for_s: float) -> float:
    """Ask the window's own thread again and again; the longest that it let wait."""
    until_s, slowest_s = time.monotonic() + for_s, 0.0
    while time.monotonic() < until_s:
        asked_s = time.monotonic()
        station.seen()
        slowest_s = max(slowest_s, time.monotonic() - asked_s)
        time.sleep(0.02)
    _expect(slowest_s < MOST_ASKED_S, f"{station.name}: the window stood still for {slowest_s:.2f} s")
    return slowest_s


def _patient(server: Server) -> dict[str, Any]:
    (row,) = server.rows(f"SELECT version, height_m FROM patients WHERE code = '{CODE}'")
    return row


def _waiting(server: Server) -> bool:
    """Whether something is being recorded, or waits at a station."""
    query = (
        "SELECT count(*) AS n FROM recordings r LEFT JOIN journals j ON j.recording_id = r.id "
        "WHERE r.state = 'open' OR j.kept_as = '' OR j.kept_as IS NULL"
    )
    return bool(server.rows(query)[0]["n"])


def _counted(server: Server) -> str:
    tables = ("patients", "sessions", "recordings", "audit")
    return ", ".join(f"{server.rows(f'SELECT count(*) AS n FROM {one}')[0]['n']} {one}" for one in tables)


def _wait_until(is_so: Any, what: str) -> None:
    until_s = time.monotonic() + PATIENCE_S
    while not is_so():
        if time.monotonic() > until_s:
            raise WrongError(f"not in {PATIENCE_S:.0f} s: {what}")
        time.sleep(0.3)


def _expect(is_so: bool, what: str) -> None:
    if not is_so:
        raise WrongError(what)


@contextmanager
def _server() -> Iterator[Server]:
    # a short path: a socket's has 107 letters at most
    with tempfile.TemporaryDirectory(prefix="pg") as folder, own_server(Path(folder) / "pg") as postgres:
        yield Server(postgres, postgres.database())


@contextmanager
def _station(name: str, out: Path) -> Iterator[StationOnScreen]:
    """The application on a display of its own, of a user who has nothing yet."""
    with own_display() as display, own_environment(display) as environment:
        process = _started(environment)
        application = Application(process, display, Path(environment["HOME"]))
        try:
            application.ask("begin")
            yield StationOnScreen(name, application, out / name)
            application.ask("end")
            process.wait(timeout=PATIENCE_S)
        finally:
            process.kill()
            process.wait()


def _started(environment: Mapping[str, str]) -> Popen[str]:
    return Popen(
        list(INSIDE),
        cwd=environment["HOME"],
        env=dict(environment),
        stdin=PIPE,
        stdout=PIPE,
        text=True,
    )


def main() -> int:
    try:
        for line in prove(options(__doc__, out=(Path, "the folder for the pictures")).out.resolve()):
            print(f"- {line}", flush=True)
    except WrongError as wrong:
        print(wrong)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
