"""When the patient rises and sits, from the thighs' tilt against gravity: no pelvis sensor is needed.

Nor is one used: on the walker the pelvis's pitch (over 10 deg/s until the thighs are under 15 deg) showed the
beginning of a rise a median 0.63 s early, as people lean before they rise, and of one in six not at all, where the
thighs are 0.006 s off; the end 0.08 s off against 0.012 s (`tests.validation.pelvis_courses`, 240 rises, rigid and
soft tissue).

The tilt is the angle between the vertical in the sensor's axes now and in standing, so that it needs no axis of the
thigh. The offline filter runs over the recording both ways, which short and deep flexion asks for.
"""

from dataclasses import dataclass

import numpy as np

from core.body import Segment, Side, Site
from core.samples import BoolArray, FloatArray
from core.session import Recording, RecordingKind
from core.signal.sensors import SensorTracks
from core.timed.found import Rise, Sitting

STEP_S = 0.01
SEATED_RAD, STANDING_RAD = np.deg2rad(50.0), np.deg2rad(30.0)  # a step lifts the mean of both thighs by less
EDGE_SHARE = 0.1  # of the way between seat and standing: from there on the thighs have left or reached it
QUIET_RAD_S = np.deg2rad(15.0)
REST_S = 1.0  # beside a rise or a sitting down, the patient is standing; and what a sensor may miss at either end


@dataclass(frozen=True, slots=True)
class SeatMotions:
    """Every rise and every sitting down, ascending; `has_thighs` False: nothing shows them."""

    rises: tuple[Rise, ...]
    sittings: tuple[Sitting, ...]
    has_thighs: bool = True


NO_SEAT = SeatMotions((), ())


def seat_motions(tracks: SensorTracks, recording: Recording) -> SeatMotions:
    """Rises and sittings of one recording, by the thighs that gave samples throughout and stood in the session."""
    tilts = []
    start_s, end_s = tracks.span_of(recording)
    time_s = np.arange(start_s, end_s, STEP_S)
    for side in Side:
        site = Site(f"{side}_{Segment.THIGH}")
        tilt = _tilt(tracks, recording, site, time_s)
        if tilt is not None:
            tilts.append(tilt)
    if not tilts:
        return SeatMotions((), (), has_thighs=False)
    return motions_of_tilt(time_s, np.mean(tilts, axis=0))


def _tilt(tracks: SensorTracks, recording: Recording, site: Site, time_s: FloatArray) -> FloatArray | None:
    """How far a thigh is tilted from standing (n,), rad; None where it was silent, or nobody stood."""
    upright = _upright(tracks, site)
    if upright is None or not tracks.is_usable(recording, site):
        return None
    worn = tracks.oriented(recording, site, tracks.blocks(recording)[0])
    if len(worn) != 1 or worn[0].track.start_s > time_s[0] + REST_S or worn[0].track.end_s < time_s[-1] - REST_S:
        return None
    up = worn[0].earth_from_sensor[:, 2]
    return np.asarray(np.interp(time_s, worn[0].track.time_s, np.arccos(np.clip(up @ upright, -1.0, 1.0))))


def _upright(tracks: SensorTracks, site: Site) -> FloatArray | None:
    """The vertical (3,) in a sensor's axes while the patient is standing."""
    for recording in tracks.span:
        if recording.kind is RecordingKind.STANDING and (rest := tracks.rest(recording, site)) is not None:
            return np.asarray(rest.acc_m_s2 / np.linalg.norm(rest.acc_m_s2))
    return None


def motions_of_tilt(time_s: FloatArray, tilt_rad: FloatArray) -> SeatMotions:
    """Find rises and sittings from the thighs' tilt from standing, on an even clock."""
    state = np.where(tilt_rad > SEATED_RAD, 1, np.where(tilt_rad < STANDING_RAD, -1, 0))
    sure = np.flatnonzero(state)
    changes = np.flatnonzero(np.diff(state[sure]))
    rate = np.abs(np.gradient(tilt_rad, time_s)) if len(time_s) > 1 else np.zeros_like(tilt_rad)
    edges = [0, *(int(sure[k + 1]) for k in changes), len(tilt_rad)]
    near = round(REST_S / STEP_S)
    rises, sittings = [], []
    for number, k in enumerate(changes.tolist()):
        before, after = int(sure[k]), int(sure[k + 1])
        earlier, later = slice(edges[number], before + 1), slice(after, edges[number + 2])
        if state[after] < 0:
            seat = _seat_level(tilt_rad[earlier], rate[earlier])
            stand = float(tilt_rad[later][:near].min())
            left = _last(tilt_rad[: after + 1] >= seat - EDGE_SHARE * (seat - stand), edges[number])
            upright = after + int(np.argmax(tilt_rad[later] <= stand + EDGE_SHARE * (seat - stand)))
            rises.append(Rise(float(time_s[left]), float(time_s[upright])))
        else:
            seat = _seat_level(tilt_rad[later], rate[later])
            stand = float(tilt_rad[earlier][-near:].min())
            begins = _last(tilt_rad[: after + 1] <= stand + EDGE_SHARE * (seat - stand), edges[number])
            down = after + int(np.argmax(tilt_rad[later] >= seat - EDGE_SHARE * (seat - stand)))
            sittings.append(Sitting(float(time_s[begins]), float(time_s[down])))
    return SeatMotions(tuple(rises), tuple(sittings))


def _seat_level(tilt: FloatArray, rate: FloatArray) -> float:
    """Where the thighs rest on the seat: the middle of what is quiet, else the most they reach."""
    quiet = tilt[rate < QUIET_RAD_S]
    return float(np.median(quiet) if len(quiet) else tilt.max())


def _last(holds: BoolArray, begin: int) -> int:
    """The last index from `begin` on at which it holds."""
    found = np.flatnonzero(holds[begin:])
    return begin + (int(found[-1]) if len(found) else 0)
