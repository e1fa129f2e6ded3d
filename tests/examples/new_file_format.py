"""Read files of a program that is not known yet, and write them as a session folder.

    python -m tests.examples.new_file_format THIGH.csv SHANK.csv SESSION

The program writes one line per sample, with a heading: a counter at 100 Hz, angular rate in deg/s, specific force in g.
Everything is turned to SI units in the sensor's own axes; a counter that jumps leaves a gap in time, which is never
filled. Printed is how many samples each site has, how many are missing, and where the session is. From then on every
command reads it, `gaitwright analyse SESSION --out OUT` among them.
"""

import sys
from pathlib import Path

import numpy as np

from core import ImuBlock, RateKind, Recording, RecordingKind, SensorInfo, Session, Site
from devices import read_session, write_session

RATE_HZ = 100.0
G_M_S2 = 9.80665


def read_block(file: Path) -> ImuBlock:
    """One sensor's samples from one file of that program."""
    counter, *columns = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2).T
    return ImuBlock(
        sensor=file.stem,
        time_s=counter / RATE_HZ,
        gyr_rad_s=np.deg2rad(columns[:3]).T,
        acc_m_s2=G_M_S2 * np.array(columns[3:6]).T,
    )


def main(thigh: Path, shank: Path, folder: Path) -> None:
    imu = {Site.LEFT_THIGH: read_block(thigh), Site.LEFT_SHANK: read_block(shank)}
    walk = Recording(name="walk 1", kind=RecordingKind.WALKING, folder="walk_1", imu=imu)
    # say it where it is known: else the analysis finds out whether a rate is an instant's or a mean
    sensors = {site: SensorInfo(rate_hz=RATE_HZ, rate_kind=RateKind.INSTANTANEOUS) for site in imu}
    write_session(Session((walk,), sensors=sensors), folder)
    for site, block in read_session(folder).recordings[0].imu.items():
        missing = round(RATE_HZ * (block.time_s[-1] - block.time_s[0])) + 1 - len(block)
        print(f"{site}: {len(block)} samples, {missing} missing")
    print(f"written to {folder}")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
