"""Many session folders to measure a batch with: some simulated walks, each under many names."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

from devices.files.session_folder import write_session
from devices.walker import FreeMotion, Standing, Walk, WalkerSettings, simulate


def write_walks(folder: Path, count: int, different: int, strides: int) -> None:
    """`count` session folders, of which so many are different; the others share their files on the disk."""
    recordings = (Standing(), FreeMotion(), Walk(strides=strides))
    for number in range(count):
        place = folder / f"visit {number:04d}"
        if number < different:
            session = simulate(WalkerSettings(seed=number, recordings=recordings)).session
            patient = replace(session.patient, code=f"DEMO-{number}")
            write_session(replace(session, patient=patient), place)
        else:
            shutil.copytree(folder / f"visit {number % different:04d}", place, copy_function=os.link)
