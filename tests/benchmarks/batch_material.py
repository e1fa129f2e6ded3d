"""Many session folders to measure a batch with: some simulated walks, each under many names."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

from devices.files.session_folder import write_session
from devices.simulation.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate


def write_walks(folder: Path, count: int, different: int, strides: int, walks: int) -> None:
    """`count` sessions of so many walks, of which some are different; the others share their files on the disk."""
    walked: list[Standing | FreeMotion | Walk] = [Walk(f"walk {1 + each}", strides=strides) for each in range(walks)]
    recordings = (Standing(), FreeMotion(), *walked)
    for number in range(count):
        place = folder / f"visit {number:04d}"
        if number < different:
            session = simulate(WalkerSettings(seed=number, recordings=recordings)).session
            patient = replace(session.patient, code=f"DEMO-{number}")
            write_session(replace(session, patient=patient), place)
        else:
            shutil.copytree(folder / f"visit {number % different:04d}", place, copy_function=os.link)
