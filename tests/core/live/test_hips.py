"""Hips, live: the angle of a body whose truth is known, whatever the blocks, and the motion that shows the heading."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from core.body import LEG_SITES, Joint, Side, Site, hip_of
from core.hip.results import HipIdentification
from core.live.free_motion import LiveFreeMotion
from core.live.hip_heading import HipHeadingState
from core.live.walking import LiveWalk
from core.samples import FloatArray, ImuBlock
from devices.simulation.walker import (
    FreeMotion,
    Motion,
    SimulatedSession,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
    simulate,
)
from devices.simulation.walker_pelvis import hip_truth
from tests.core.cut_blocks import in_blocks, part_of
from tests.core.standing import live_sensors

PELVIS_AND_THIGHS = (Site.LEFT_THIGH, Site.RIGHT_THIGH, Site.PELVIS)
HIPS = tuple(hip_of(side) for side in Side)


@lru_cache(maxsize=1)
def walk() -> SimulatedSession:
    """A rigid walk of 16 s with a half turn."""
    settings = WalkerSettings(
        seed=4,
        sites=PELVIS_AND_THIGHS,
        recordings=(Standing(), Walk(strides=14, turn_rad=np.pi, standing_before_s=1.0)),
    )
    return simulate(settings)


def moved(motion: Motion, tissue: Tissue = Tissue.SOFT) -> SimulatedSession:
    recordings = (Standing(), FreeMotion(duration_s=12.0, motion=motion))
    return simulate(WalkerSettings(seed=3, sites=PELVIS_AND_THIGHS, tissue=tissue, recordings=recordings))


def true_hips(made: SimulatedSession) -> dict[Joint, HipIdentification]:
    """What an analysis that makes no error finds: the bones' own frames."""
    frames = {site: made.moved[-1].mountings[site].segment_from_sensor for site in PELVIS_AND_THIGHS}
    nothing = np.zeros(3)
    return {
        joint: HipIdentification(
            centre_proximal_m=nothing,
            centre_distal_m=nothing,
            margin=10.0,
            disagreement=0.0,
            heading_sd_rad=0.01,
            is_3d=True,
            moving_s=20.0,
            lag_s=0.0,
            standing_from="standing",
            centres_apart_m=0.17,
            frame_proximal=frames[Site.PELVIS],
            frame_distal=frames[joint.distal],
        )
        for joint in HIPS
    }


def reported(
    live: LiveWalk, blocks: Iterator[dict[Site, ImuBlock]] | Sequence[Mapping[Site, ImuBlock]]
) -> dict[Joint, FloatArray]:
    """Stamps, angles in degrees, their standard deviations, and whether they are provisional (4, n), of each hip."""
    found: dict[Joint, list[FloatArray]] = {}
    for block in blocks:
        for joint, new in live.update(block).joints.items():
            rows = new.samples.time_s, np.rad2deg(new.samples.angle_rad), np.rad2deg(new.samples.sd_rad)
            found.setdefault(joint, []).append(np.stack([*rows, np.full(len(new.samples), new.is_provisional)]))
    return {joint: np.concatenate(parts, axis=1) for joint, parts in found.items()}


def live_walk(made: SimulatedSession, hips: Mapping[Joint, HipIdentification] | None = None) -> LiveWalk:
    return LiveWalk(live_sensors(made.session), {}, true_hips(made) if hips is None else hips)


def true_deg(made: SimulatedSession, side: Side, time_s: FloatArray) -> FloatArray:
    """The anatomical angle (n,), which the bones' own frames give."""
    pelvis = made.moved[-1].pelvis
    assert pelvis is not None
    known = hip_truth(
        pelvis, None, made.moved[-1].legs[side], side, made.moved[-1].mountings, made.moved[-1].clocks, {}
    )
    return np.rad2deg(np.interp(time_s, known.time_s, known.flexion_rad))


def test_a_live_hip_reads_what_its_bones_do_first_by_the_vertical_then_by_the_heading() -> None:
    made = walk()
    for joint, (time_s, angle_deg, sd_deg, is_provisional) in reported(
        live_walk(made), in_blocks(made.session.recordings[-1].imu, 0.15)
    ).items():
        error_deg = angle_deg - true_deg(made, joint.side, time_s)
        for by_vertical, limit_deg in ((True, 1.6), (False, 0.8)):
            those = (is_provisional == by_vertical) & (time_s > 1.0)
            assert np.count_nonzero(those) > 200
            assert np.sqrt(np.mean(error_deg[those] ** 2)) < limit_deg
        assert np.all(np.diff(is_provisional) <= 0)  # once sure it stays so
        assert np.mean(np.abs(error_deg) < 2 * sd_deg) > 0.99
        steps_deg = np.diff(error_deg)
        assert np.max(np.abs(steps_deg)) < 0.5  # it goes over without a jump


def test_blocks_of_any_size_and_order_say_the_same() -> None:
    made = walk()
    imu = {site: part_of(block, 0.0, 9.0) for site, block in made.session.recordings[-1].imu.items()}
    at_once = reported(live_walk(made), [imu])
    one_by_one = [{site: part} for parts in in_blocks(imu, 0.13) for site, part in reversed(parts.items())]
    for blocks in (list(in_blocks(imu, 0.05)), one_by_one):
        for joint, (time_s, angle_deg, sd_deg, _) in reported(live_walk(made), blocks).items():
            whole = at_once[joint][:, : len(time_s)]
            assert len(time_s) > 880
            assert np.allclose(whole[:3], [time_s, angle_deg, sd_deg], rtol=0, atol=1e-4)


def test_a_hip_that_is_found_amid_a_walk_is_shown_from_there_on() -> None:
    made = walk()
    live = live_walk(made, {})
    blocks = list(in_blocks(made.session.recordings[-1].imu, 0.1))
    assert reported(live, blocks[:80]) == {}
    live.find_hips(true_hips(made))
    time_s, angle_deg, _, is_provisional = reported(live, blocks[80:120])[Joint.LEFT_HIP]
    assert time_s[0] >= 7.5
    assert not is_provisional[-1]  # the heading was followed before
    settled = time_s > time_s[0] + 2.0
    assert np.std((angle_deg - true_deg(made, Side.LEFT, time_s))[settled]) < 1.0


def test_other_frames_are_gone_over_to_without_a_jump() -> None:
    made = walk()
    live, blocks = live_walk(made), list(in_blocks(made.session.recordings[-1].imu, 0.1))
    before = reported(live, blocks[:60])[Joint.LEFT_HIP]
    turned = {
        joint: replace(found, frame_distal=_pitched(0.2) @ found.frame_distal)
        for joint, found in true_hips(made).items()
    }
    live.find_hips(turned)
    after = reported(live, blocks[60:120])[Joint.LEFT_HIP]
    time_s, angle_deg = np.concatenate([before[:2], after[:2]], axis=1)
    error_deg = angle_deg - true_deg(made, Side.LEFT, time_s)
    assert np.max(np.abs(np.diff(error_deg))) < 0.5
    assert np.mean(error_deg[-100:]) == pytest.approx(np.rad2deg(0.2), abs=1.0)  # a thigh that leans back is bent


def _pitched(by_rad: float) -> FloatArray:
    c, s = np.cos(by_rad), np.sin(by_rad)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def test_a_silent_pelvis_costs_its_hips_for_so_long_and_they_come_back() -> None:
    made = walk()
    imu = dict(made.session.recordings[-1].imu)
    pelvis = imu[Site.PELVIS]
    imu[Site.PELVIS] = pelvis.select((pelvis.time_s < 7.0) | (pelvis.time_s > 9.0))
    time_s, angle_deg, _, is_provisional = reported(live_walk(made), in_blocks(imu, 0.1))[Joint.LEFT_HIP]
    known_s = time_s[np.isfinite(angle_deg)]
    assert not np.any((known_s > 7.05) & (known_s < 9.0))
    assert is_provisional[(time_s > 9.5) & (time_s < 11.0)].all()  # its orientation has begun again
    late = time_s > 14.0
    assert np.std((angle_deg - true_deg(made, Side.LEFT, time_s))[late]) < 1.0


def test_nothing_is_reported_of_hips_without_a_sensor_on_the_pelvis_or_on_the_thigh() -> None:
    made = walk()
    imu = made.session.recordings[-1].imu
    for worn, expected in (
        ((Site.LEFT_THIGH, Site.RIGHT_THIGH), set()),
        ((Site.PELVIS, Site.LEFT_THIGH), {Joint.LEFT_HIP}),
    ):
        sensors = {site: sensor for site, sensor in live_sensors(made.session).items() if site in worn}
        found = reported(LiveWalk(sensors, {}, true_hips(made)), [{site: imu[site] for site in worn}])
        assert set(found) == expected


def headings(made: SimulatedSession) -> Mapping[Joint, HipHeadingState]:
    motion = LiveFreeMotion(live_sensors(made.session))
    states = [motion.update(block).hips for block in in_blocks(made.session.recordings[1].imu, 0.5)]
    return states[-1]


def test_lunges_show_the_hips_and_leg_circles_do_not() -> None:
    for state in headings(moved(Motion.LUNGES)).values():
        assert state.is_sure
        assert np.rad2deg(state.sd_rad) < 6.0
    for state in headings(moved(Motion.FULL)).values():
        assert not state.is_sure


def test_a_free_motion_of_six_sensors_knows_of_no_hips() -> None:
    made = simulate(WalkerSettings(seed=3, sites=LEG_SITES, recordings=(Standing(), FreeMotion(duration_s=3.0))))
    assert headings(made) == {}


def test_two_sensors_that_share_no_hip_are_not_trusted() -> None:
    sites = (Site.LEFT_THIGH, Site.RIGHT_FOOT, Site.PELVIS)
    made = simulate(WalkerSettings(seed=4, sites=sites, recordings=(Standing(), Walk(strides=9))))
    exchanged = {Site.PELVIS: Site.RIGHT_FOOT, Site.LEFT_THIGH: Site.LEFT_THIGH}
    sensors, imu = live_sensors(made.session), made.session.recordings[-1].imu
    motion = LiveFreeMotion({site: sensors[at] for site, at in exchanged.items()})
    (state,) = motion.update({site: imu[at] for site, at in exchanged.items()}).hips.values()
    assert state.moved_s > 6.0
    assert not state.is_trusted
