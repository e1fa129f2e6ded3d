"""Sessions and files that the examples are run on: by their tests, and by the site for what each prints.

All are simulated and the same in every run.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from core.body import LEG_SITES, Site
from core.samples import G_M_S2, ImuBlock
from core.session import Session
from core.timed.protocols import PlannedTest, TimedProtocol
from devices.simulation.walker import FreeMotion, SimulatedSession, Standing, Walk, WalkerSettings
from devices.simulation.walker_body import CourseKind
from devices.simulation.walker_courses import draw_course, simulate_course
from tests.examples import new_sensor

LEFT_LEG = (Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT)
SLOW, FAST = 0.9, 1.3

# long enough for a port to be opened meanwhile
ONE_LEG = WalkerSettings(
    seed=3,
    sites=LEFT_LEG,
    recordings=(Standing(duration_s=2.0), FreeMotion(duration_s=5.0), Walk(strides=6, standing_before_s=3.0)),
)
TWO_WALKS = WalkerSettings(
    seed=7,
    recordings=(
        Standing(),
        FreeMotion(),
        *(Walk(name, speed_m_s=speed, strides=7) for name, speed in (("slow", SLOW), ("fast", FAST))),
    ),
)
LOST_SAMPLES = slice(50, 53)
LOST_FRAMES, DAMAGED_FRAME = slice(100, 102), 20


def last_block(simulated: SimulatedSession, site: Site) -> ImuBlock:
    return simulated.session.recordings[-1].imu[site]


def up_and_go() -> Session:
    """A session with one timed test."""
    course = simulate_course(replace(draw_course(CourseKind.UP_AND_GO, 1), sites=LEG_SITES))
    *before, walk = course.session.recordings
    planned = replace(walk, test=PlannedTest(TimedProtocol.UP_AND_GO))
    return replace(course.session, recordings=(*before, planned))


def write_own_arrays(simulated: SimulatedSession, file: Path) -> None:
    """A walk of the left leg as arrays of one's own."""
    blocks = {name: last_block(simulated, site) for name, site in zip("ABC", LEFT_LEG, strict=True)}
    arrays = {name: np.column_stack([one.time_s, one.gyr_rad_s, one.acc_m_s2]) for name, one in blocks.items()}
    np.savez(file, allow_pickle=False, **arrays)


def write_counted_lines(block: ImuBlock, file: Path) -> None:
    """Samples as the program of `new_file_format` writes them; three are lost."""
    rows = np.column_stack([np.round(100 * block.time_s), np.rad2deg(block.gyr_rad_s), block.acc_m_s2 / G_M_S2])
    kept = np.delete(rows, LOST_SAMPLES, axis=0)
    np.savetxt(file, kept, delimiter=",", header="counter,gx,gy,gz,ax,ay,az", comments="")


def frames_of_new_sensor() -> bytes:
    """What the sensor of `new_sensor` sent; its counter starts again once, two frames are lost and one is damaged."""
    frames = [_frame(number) for number in range(300)]
    frames[DAMAGED_FRAME] = frames[DAMAGED_FRAME][:4] + b"\x7f" + frames[DAMAGED_FRAME][5:]
    del frames[LOST_FRAMES]
    return b"".join(frames) + frames[-1][:7]


def _frame(number: int) -> bytes:
    body: bytes = new_sensor.FRAME.pack(0xA5, number % 256, number, -5, 0, 0, 0, 981, 0, 0)[:-2]
    return body + bytes([sum(body) % 256, 0x5A])
