"""Public recordings with optical references, as session folders and reference files in a folder of their own.

Nothing of them is kept: they are made again from the shared data for every run.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from core.body import Side, Site
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from devices.files.session_folder import write_session
from tests.benchmarks.gait import optical_foot

HINGES = ("1D_02", "1D_03")
HINGE_SITES = {Site.LEFT_THIGH: "1", Site.LEFT_SHANK: "2"}


@dataclass(frozen=True, slots=True)
class Referenced:
    """A session folder and the files of its reference."""

    name: str
    session: Path
    references: tuple[Path, ...]


def recordings_with_references(data: Path, folder: Path) -> Iterator[Referenced]:
    """Make them one by one."""
    for name in HINGES:
        yield hinge(data, folder, name)
    yield feet(data, folder)


def hinge(data: Path, folder: Path, name: str) -> Referenced:
    """Two sensors on a mechanical hinge, worn as thigh and shank, and the optical angle where it is valid."""
    with np.load(data / "hinge_mechanical" / f"{name}.npz") as archive:
        arrays = {key: np.asarray(archive[key], dtype=np.float64) for key in archive.files}
    time_s = np.arange(len(arrays["acc1"])) / float(arrays["fs"])
    imu = {site: ImuBlock(site, time_s, arrays[f"gyr{k}"], arrays[f"acc{k}"]) for site, k in HINGE_SITES.items()}
    place = folder / name
    place.mkdir()
    write_session(Session((Recording("hinge", RecordingKind.FREE_MOTION, "hinge", imu),)), place / "session")
    angle_deg = np.rad2deg(np.where(arrays["ref_ok"] > 0, arrays["angle_ref_rad"], np.nan))
    cells = (f"{t:.4f},{'' if np.isnan(angle) else f'{angle:.5f}'}" for t, angle in zip(time_s, angle_deg, strict=True))
    return Referenced(f"hinge {name}", place / "session", (_written(place, "optics", "time_s,left_knee", cells),))


def feet(data: Path, folder: Path) -> Referenced:
    """Both feet of a person who walks and turns, and the optical events and strides."""
    with np.load(data / "feet_mocap_events" / "healthy_feet.npz") as archive:
        fs = float(archive["fs"])
        imu = {}
        for site in (Site.LEFT_FOOT, Site.RIGHT_FOOT):
            gyr, acc = (np.asarray(archive[f"{site}_{kind}"], dtype=np.float64) for kind in ("gyr", "acc"))
            imu[site] = ImuBlock(site, np.arange(len(gyr)) / fs, gyr, acc)
    place = folder / "feet"
    place.mkdir()
    write_session(Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imu),)), place / "session")
    events, strides = [], []
    for side in Side:
        for stride in optical_foot(data, side).strides:
            events += [(stride.initial_contact_s, side, "initial_contact"), (stride.toe_off_s, side, "toe_off")]
            strides.append(f"{side},{stride.start_s:.5f},{stride.end_s:.5f},{stride.length_m:.5f}")
    rows = [f"{at_s:.5f},{side},{event}" for at_s, side, event in sorted(events)]
    return Referenced(
        "feet",
        place / "session",
        (
            _written(place, "events", "time_s,side,event", rows),
            _written(place, "strides", "side,start_s,end_s,stride_length_m", strides),
        ),
    )


def _written(place: Path, name: str, header: str, rows: Iterable[str]) -> Path:
    path = place / f"{name}.csv"
    path.write_text("\n".join([header, *rows, ""]), encoding="utf-8")
    return path
