"""Random keys and clicks through whole sessions. Check for crashes, dead ends and false statements.

    python -m tests.safety.random_keys --hours 2 --seed 1

A user gone wild works with the whole window without a display: mostly what leads a session on, from the first start to
a saved report, now and then anything that a hand on keys and mouse can do. The sensors are simulated, twenty times as
fast as ours. Each life of the program ends by being closed or killed, and the next goes on with the same library; after
a few of them there is a new one. A fault is: an exception, a warning of Qt's, an error in the log, a process that ends
otherwise than it was asked to; a page that nothing leads away from; the screen's thread held up for seconds; a sentence
about patients, sessions or recordings that the library, read beside, contradicts for seconds. Each is written with
its life's seed, its step and what was done before; `--life SEED/NUMBER` plays one life alone, on a new library. It ends
with 1 if there was any.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from app.storage.keys import KeyRefusedError
from app.storage.layout import KEYS
from app.storage.opened import slots_of
from devices.files.session_folder import write_session
from devices.simulation.walker import DEMONSTRATION, simulate
from tests.driver import options
from tests.safety.random_visits import OPERATOR, PASSPHRASE
from tests.safety.said_and_held import HeldLibrary, left_open

LIVES = 8  # of one library
LIFE_S = (60.0, 300.0)
KILLED_SHARE = 0.35
ENDS_WITHIN_S = 120.0
TAIL = 6000  # letters of what a process stated last
HOMES = ("HOME", "XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME", "XDG_CACHE_HOME", "TMPDIR")


@dataclass(slots=True)
class Outcome:
    """What was reached, and what must not have been."""

    did: Counter[str] = field(default_factory=Counter)
    longest_held_up_s: float = 0.0
    faults: list[Mapping[str, Any]] = field(default_factory=list)

    def note(self, fault: Mapping[str, Any]) -> None:
        self.faults.append(fault)
        print(json.dumps(fault, indent=1), flush=True)

    def __str__(self) -> str:
        kinds = Counter(str(fault["fault"]) for fault in self.faults)
        did = ", ".join(f"{count} {what}" for what, count in sorted(self.did.items()))
        return f"{did}; screen held up for {self.longest_held_up_s:.1f} s at most; faults: {dict(kinds) or 'none'}"


def make_place(place: Path) -> None:
    """What a user has beside the program: folders to import from, good and bad, and one to save into."""
    for name in ("out", *(home.lower() for home in HOMES)):
        (place / name).mkdir(parents=True)
    write_session(simulate(DEMONSTRATION).session, place / "sessions" / "good")
    (place / "sessions" / "bad").mkdir()
    (place / "sessions" / "bad" / "session.toml").write_text("format = 1\n[patient]\ncode = [", encoding="utf-8")
    (place / "sessions" / "empty").mkdir()


def live(place: Path, seed: str, outcome: Outcome, seconds: float, end: str) -> None:
    """Let the program live once, and look at how it ended and what it left."""
    command = [sys.executable, "-m", "tests.safety.random_life", str(place), "--seed", seed]
    command += ["--seconds", f"{seconds:.0f}", "--end", end]
    environment = {**os.environ, **{home: str(place / home.lower()) for home in HOMES}}
    environment.pop("DISPLAY", None)
    errors, began = place / "errors.txt", datetime.now().astimezone().isoformat(timespec="seconds")
    with (
        errors.open("w") as reported,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=reported, text=True, env=environment) as process,
    ):
        watchdog_s = time.monotonic() + seconds + ENDS_WITHIN_S
        assert process.stdout is not None
        for line in process.stdout:
            _hear(line, seed, outcome)
        try:
            code = process.wait(timeout=max(1.0, watchdog_s - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            outcome.note({"fault": "does not end", "seed": seed, "what": errors.read_text()[-TAIL:]})
            return
    required = -signal.SIGKILL if end == "kill" else 0
    if code != required:
        kind = "hang" if "Timeout (" in errors.read_text() else "crash"
        outcome.note({"fault": kind, "seed": seed, "code": code, "what": errors.read_text()[-TAIL:]})
    outcome.did["lives"] += 1
    for what in _left(place / "library", began if end == "close" and code == required else None):
        outcome.note({"fault": "left behind", "seed": seed, "end": end, "what": what})


def _hear(line: str, seed: str, outcome: Outcome) -> None:
    try:
        reported = json.loads(line)
    except ValueError:
        return
    if "fault" in reported:
        outcome.note({"seed": seed, **reported})
    elif "did" in reported:
        outcome.did[reported["did"]] += reported.get("count", 1)
        outcome.longest_held_up_s = max(outcome.longest_held_up_s, reported.get("longest_held_up_s", 0.0))


def _left(library: Path, closed_since: str | None) -> list[str]:
    """What must not be so of a library that nobody has open, where it was closed after a life that began then."""
    if not (library / KEYS).exists():
        return []
    try:
        held = HeldLibrary(library, slots_of(library).open(OPERATOR, PASSPHRASE))
    except KeyRefusedError:
        return []  # the user has changed the passphrase
    faults = [str(row[0]) for row in held.ask("PRAGMA integrity_check") if row[0] != "ok"]
    faults += [f"row {row} refers to nothing" for row in held.ask("PRAGMA foreign_key_check")]
    files = [
        (name, str(file))
        for name, file in held.ask(
            "SELECT r.name, j.file FROM recordings r JOIN journals j ON j.recording_id = r.id WHERE r.state = 'closed'"
        )
    ]
    faults += [f"{name} has no journal {file}" for name, file in files if not (library / "recordings" / file).exists()]
    return faults + (left_open(held, closed_since) if closed_since is not None else [])


def play(seconds: float, seed: int, folder: Path) -> Outcome:
    """Live for so long."""
    outcome, chance = Outcome(), random.Random(seed)
    ends_s, life = time.monotonic() + seconds, 0
    while (left_s := ends_s - time.monotonic()) > 0:
        place = folder / f"place {life // LIVES}"
        if life % LIVES == 0:
            make_place(place)
        life += 1
        end = "kill" if chance.random() < KILLED_SHARE else "close"
        live(place, f"{seed}/{life}", outcome, min(chance.uniform(*LIFE_S), max(left_s, 10.0)), end)
        print(f"{(seconds - left_s) / 3600:.2f} h: {outcome}", flush=True)
    return outcome


def main() -> int:
    required = options(
        __doc__, hours=2.0, seed=1, life={"metavar": "SEED/NUMBER", "help": "this life alone, for two minutes"}
    )
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        if required.life:
            outcome = Outcome()
            make_place(Path(folder) / "place")
            live(Path(folder) / "place", required.life, outcome, 120.0, "close")
        else:
            outcome = play(3600.0 * required.hours, required.seed, Path(folder))
    print(outcome)
    return 1 if outcome.faults else 0


if __name__ == "__main__":
    sys.exit(main())
