"""What is in for the analysis of a session where only the handing out is looked at; workers import it by name."""

import hashlib
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class StandIn:
    """A task that is a number, and the folder where it notes that it was begun; empty: nowhere."""

    number: int
    notes: str = ""
    rounds: int = 1


def digest_of(task: StandIn) -> str:
    """A figure that only this task gives, after some work."""
    note(task)
    digest = str(task.number).encode()
    for _ in range(task.rounds):
        digest = hashlib.sha256(digest).digest()
    return digest.hex()


def ends_its_worker(task: StandIn) -> str:
    """As `digest_of`, but number 13 kills whoever does it, each time."""
    note(task)
    if task.number == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    return digest_of(StandIn(task.number))


def ends_its_worker_once(task: StandIn) -> str:
    """As `digest_of`, but number 13 kills whoever does it the first time."""
    is_first = not begun(task)
    note(task)
    if task.number == 13 and is_first:
        os.kill(os.getpid(), signal.SIGKILL)
    return digest_of(StandIn(task.number))


def fails(task: StandIn) -> str:
    """As `digest_of`, but odd numbers raise."""
    if task.number % 2:
        raise ValueError(f"{task.number} is odd")
    return digest_of(task)


def sleeps(task: StandIn) -> int:
    """Take as many milliseconds as the number states."""
    time.sleep(task.number / 1000)
    return task.number


def note(task: StandIn) -> None:
    if task.notes:
        with (Path(task.notes) / str(task.number)).open("a", encoding="utf-8") as file:
            file.write("begun\n")


def begun(task: StandIn) -> int:
    """How often a task was begun."""
    path = Path(task.notes) / str(task.number)
    return len(path.read_text(encoding="utf-8").splitlines()) if path.exists() else 0
