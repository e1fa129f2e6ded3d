"""The identification of one joint from the recordings that are in force, robust or as published."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from core.angles.measure import Geometry, pairs_of
from core.body import Joint
from core.calibration.bare_axis import Axes, bare_axes
from core.calibration.identify import Downs, Identification, identify_joint, moving_data
from core.calibration.joint_axis import heading_from_axes
from core.calibration.joint_centre import MAX_SD_M, nearest_to_sensors
from core.calibration.knees_help import helped_by_knee
from core.calibration.lag import Lag, find_lag
from core.calibration.validity import Basis
from core.published.identify import identify_as_published
from core.published.joint_centre import shifted_to_sensors
from core.results import AxisSource, Method
from core.session import Recording
from core.signal.datasets import Datasets
from core.signal.pair import Pair
from core.signal.sensors import SensorTracks

LAG_SAMPLES = 400
MIN_MOVED_S = 0.015  # tissue in walking looks up to 10 ms late


@dataclass(frozen=True, slots=True)
class Identified:
    """One joint as identified, before its clinical sign and zero.

    The centres in `geometry` are the best there are and serve eq 15, which hardly feels them; where not
    `is_centre_known` they are not reported. `is_bare`: no tissue rings, and the axes are those of the bare rates.
    """

    basis: Basis
    geometry: Geometry
    source: AxisSource
    recordings: tuple[str, ...]
    is_centre_known: bool
    centre_sd_m: float | None
    sign_margin: float
    hinge_residual_rad_s: float
    is_hinge: bool
    robust: Identification | None
    is_bare: bool = False

    @property
    def lag(self) -> Lag | None:
        return self.robust.lag if self.robust else None


def identify(
    tracks: SensorTracks, basis: Basis, method: Method, tau_s: float, knee: "Identified | None" = None
) -> Identified | None:
    """Identify one joint; None where its recordings hold too little movement.

    Parameters
    ----------
    tracks
        The sensors of one span of validity.
    basis
        The joint, and the recordings that it is identified from.
    method
        Robust, or as published.
    tau_s
        Time constant of the fusion of Seel, Raisch and Schauer 2014, doi 10.3390/s140406891, eq 15; it is passed on.
    knee
        Of an ankle, the knee above as it was identified, where it was.

    Returns
    -------
    Identified or None
        Unit axes (3,) and centres (3,), m, each in its own sensor's axes, and how sure they are.

    Examples
    --------
    >>> span = spans_of_validity(session)[0]
    >>> tracks = SensorTracks(session, span, unusable=frozenset(), rate_kind=RateKind.INSTANTANEOUS)
    >>> basis = basis_of(span, span[-1], Joint.LEFT_KNEE)
    >>> identify(tracks, basis, Method.ROBUST, tau_s=2.0).geometry.axis_1.shape
    (3,)
    """
    if method is Method.PUBLISHED:
        return _as_published(tracks, basis, tau_s)
    return _robustly(tracks, basis, tau_s, knee)


def _by_name(tracks: SensorTracks, names: tuple[str, ...]) -> list[Recording]:
    return [recording for recording in tracks.span if recording.name in names]


def identifying_recordings(basis: Basis) -> tuple[str, ...]:
    """A knee is identified by free motion, where there is any; an ankle by free motion and walks together."""
    free = (basis.free_motion,) if basis.free_motion else ()
    if basis.joint.is_knee:
        return free or basis.walks
    return (*free, *basis.walks)


def _pairs(tracks: SensorTracks, joint: Joint, names: tuple[str, ...], lag_s: float) -> tuple[Pair, ...]:
    """Stretches of the first block of each recording: ten minutes identify as well as ten hours."""
    return tuple(
        pair
        for recording in _by_name(tracks, names)
        for pair in pairs_of(tracks, recording, joint, tracks.blocks(recording)[0], lag_s)
    )


def _source(basis: Basis, is_hinge: bool) -> AxisSource:
    if is_hinge:
        return AxisSource.HINGE
    if not basis.free_motion:
        return AxisSource.WALKING
    return AxisSource.FREE_MOTION if basis.joint.is_knee or not basis.walks else AxisSource.POOLED


def _robustly(tracks: SensorTracks, basis: Basis, tau_s: float, knee: Identified | None) -> Identified | None:
    joint, names = basis.joint, identifying_recordings(basis)
    free = (basis.free_motion,) if basis.free_motion else ()
    found = identify_joint(
        lambda lag_s: _pairs(tracks, joint, names, lag_s),
        lambda lag_s: _pairs(tracks, joint, tuple(walk for walk in basis.walks if walk not in names), lag_s),
        lambda lag_s: _pairs(tracks, joint, free if free != names else (), lag_s),
        is_knee=joint.is_knee,
        is_from_walking=basis.free_motion is None,
        downs=downs_of(tracks, basis),
    )
    if found is None:
        return None
    centre_1, centre_2 = found.centre.proximal_m, found.centre.distal_m
    if joint.is_knee:
        centre_1, centre_2 = nearest_to_sensors(found.centre, found.axis_1, found.axis_2)
    (axis_1, axis_2), is_bare = _walked_axes(tracks, basis, found, knee)
    # a walking person's centre is not in the data; a hinge's is
    is_centre_known = found.centre_sd_m < MAX_SD_M and (found.is_hinge or basis.free_motion is not None)
    return Identified(
        basis=basis,
        geometry=Geometry(
            axis_1,
            axis_2,
            centre_1,
            centre_2,
            found.lag.lag_s,
            tau_s,
            found.centre.unknowns,
            found.is_hinge,
        ),
        source=_source(basis, found.is_hinge),
        recordings=names,
        is_centre_known=is_centre_known,
        centre_sd_m=found.centre_sd_m if is_centre_known else None,
        sign_margin=found.sign_margin,
        hinge_residual_rad_s=found.hinge_residual_rad_s,
        is_hinge=found.is_hinge,
        robust=found,
        is_bare=is_bare,
    )


class WalkedAxes(NamedTuple):
    """Axes (3,) of a joint; `is_bare`: of an ankle that walks without tissue."""

    axes: Axes
    is_bare: bool = False


def _walked_axes(tracks: SensorTracks, basis: Basis, found: Identification, knee: Identified | None) -> WalkedAxes:
    if basis.joint.is_knee or found.is_hinge or not found.did_flexion_dominate:
        return WalkedAxes((found.axis_1, found.axis_2))
    walked = moving_data(_pairs(tracks, basis.joint, basis.walks, found.lag.lag_s))
    return walked_axes((found.axis_1, found.axis_2), basis, walked, knee, downs_of(tracks, basis))


def walked_axes(
    axes: Axes, basis: Basis, walked: Datasets | None, knee: Identified | None, downs: Downs | None
) -> WalkedAxes:
    """Correct an ankle's axes by its walks: bare rates without tissue, else by the knee if no free motion."""
    bare = bare_axes(walked, axes) if walked is not None else None
    if bare is not None:
        return WalkedAxes(bare, is_bare=True)
    if basis.free_motion or knee is None or downs is None:
        return WalkedAxes(axes)
    return WalkedAxes(helped_by_knee(axes, knee.geometry.axis_2, downs) or axes)


def downs_of(tracks: SensorTracks, basis: Basis) -> Downs | None:
    """Specific forces (3,) of both sensors of a joint in its standing; None without one."""
    for recording in _by_name(tracks, (basis.standing,) if basis.standing else ()):
        rests = [tracks.rest(recording, site) for site in (basis.joint.proximal, basis.joint.distal)]
        if rests[0] is not None and rests[1] is not None:
            return rests[0].acc_m_s2, rests[1].acc_m_s2
    return None


def _as_published(tracks: SensorTracks, basis: Basis, tau_s: float) -> Identified | None:
    joint = basis.joint
    free = (basis.free_motion,) if basis.free_motion else ()
    axis_names = (free or basis.walks) if joint.is_knee else (basis.walks or free)
    axis_data = moving_data(_pairs(tracks, joint, axis_names, 0.0))
    centre_data = moving_data(_pairs(tracks, joint, free or basis.walks, 0.0))
    if axis_data is None:
        return None
    found = identify_as_published(axis_data, centre_data or axis_data)
    o1, o2 = found.centre_1_m, found.centre_2_m
    if joint.is_knee:
        o1, o2 = shifted_to_sensors(o1, o2, found.axis_1, found.axis_2)
    return Identified(
        basis=basis,
        geometry=Geometry(found.axis_1, found.axis_2, o1, o2, 0.0, tau_s, np.concatenate([o1, o2, np.zeros(6)]), False),
        source=AxisSource.WALKING if axis_names == basis.walks else AxisSource.FREE_MOTION,
        recordings=tuple(dict.fromkeys((*axis_names, *free))),
        is_centre_known=True,
        centre_sd_m=None,
        sign_margin=found.pairing_ratio,
        hinge_residual_rad_s=found.residual_rad_s,
        is_hinge=False,
        robust=None,
    )


def clock_moved_s(tracks: SensorTracks, recording: Recording, found: Identified) -> float:
    """Give how far one recording's distal clock is from the identified lag, s; 0 where not significant."""
    geometry, joint = found.geometry, found.basis.joint
    pairs = pairs_of(tracks, recording, joint, tracks.blocks(recording)[0], geometry.lag_s)
    data = moving_data(tuple(pairs))
    if data is None:
        return 0.0
    some = data.thinned(LAG_SAMPLES)
    lag = find_lag(some, heading_from_axes(some, geometry.axis_1[None], geometry.axis_2[None])[0])
    return lag.lag_s if abs(lag.lag_s) > MIN_MOVED_S else 0.0
