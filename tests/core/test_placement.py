"""Tests that the motion shows which sensor is where, with and against labels."""

import time
from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.wording.findings import sentence
from core.analysis import analyse
from core.body import LEG_JOINTS, LEG_SITES, Side, Site
from core.findings import Severity
from core.placement.chains import Chains, find_chains
from core.placement.labels import doubted_labels, exchanged_sites
from core.placement.links import link
from core.placement.smoothed_tracks import Tracks, smoothed_in_steps
from core.placement.steps import at_once
from core.samples import FloatArray, ImuBlock
from core.session import Recording, RecordingKind, Session
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
from tests.benchmarks.placement import (
    arranged,
    doubted,
    is_right,
    session_of,
    swapped,
    tracks_of,
    unlabelled,
)
from tests.core.recorded_joints import TestData, jumping_person, mechanism, session_of_mechanism, walking_person

pytestmark = pytest.mark.endurance  # minutes in all: the default run has three

T, S, F = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
RT, RS, RF = Site.RIGHT_THIGH, Site.RIGHT_SHANK, Site.RIGHT_FOOT
EXCHANGES = [(T, S), (S, F), (T, F), (T, RT), (S, RS), (F, RF), (S, RT)]


@pytest.fixture(scope="module")
def jumping(test_data: TestData) -> Tracks:
    return unlabelled(tracks_of(jumping_person(test_data)))[0]


@pytest.fixture(scope="module")
def walking(test_data: TestData) -> Tracks:
    return unlabelled(tracks_of(walking_person(test_data)))[0]


def walked(*recordings: Standing | FreeMotion | Walk, seed: int = 4, tissue: Tissue = Tissue.SOFT) -> SimulatedSession:
    return simulate(WalkerSettings(seed=seed, recordings=recordings, tissue=tissue))


@pytest.fixture(scope="module")
def circling() -> Session:
    return walked(Standing(), FreeMotion(duration_s=6.0)).session


def exchange(tracks: Tracks, *sites: Site) -> Tracks:
    """The same samples, every site's stated to be the next one's."""
    return {**tracks, **{other: tracks[one] for one, other in zip(sites, [*sites[1:], sites[0]], strict=True)}}


def at(tracks: Tracks, sites: tuple[Site, ...]) -> Tracks:
    return {site: tracks[site] for site in sites}


def groups(tracks: Tracks, standing: Mapping[str, FloatArray] | None = None) -> set[frozenset[Site]]:
    return {frozenset(group) for group in exchanged_sites(tracks, standing or {})}


def chains_of(session: Session, sites: tuple[Site, ...] = LEG_SITES) -> Chains:
    tracks, standing = unlabelled(tracks_of(session))
    found = find_chains({site: tracks[site] for site in sites}, standing)
    assert found is not None
    return found


def worn_at(session: Session, *sites: Site) -> Session:
    """Only these sites."""
    return replace(session, recordings=tuple(replace(r, imu={s: r.imu[s] for s in sites}) for r in session.recordings))


def test_of_all_ways_to_arrange_a_jumping_person_s_sensors_the_right_one_is_best(jumping: Tracks) -> None:
    found = find_chains(jumping)
    assert found is not None
    assert is_right(found)
    assert found.is_certain
    assert found.margin > 2.5
    assert min(leg.stature.height_m for leg in found.legs) > 0.4


def test_a_real_walk_shows_the_chains_too(walking: Tracks) -> None:
    found = find_chains(walking)
    assert found is not None
    assert is_right(found)
    assert found.is_certain
    assert found.margin > 4.0


@pytest.mark.parametrize("person", ["jumping", "walking"])
@pytest.mark.parametrize("exchanged", EXCHANGES)
def test_exchanged_labels_of_a_real_person_are_named(
    person: str, exchanged: tuple[Site, Site], request: pytest.FixtureRequest
) -> None:
    tracks: Tracks = request.getfixturevalue(person)
    assert groups(exchange(tracks, *exchanged)) == {frozenset(exchanged)}


@pytest.mark.parametrize("person", ["jumping", "walking"])
@pytest.mark.parametrize("sites", [(T, S), (S, F), (T, S, RT, RS), (T, S, F, RS, RF)])
def test_right_labels_of_a_real_person_are_not_doubted_whatever_is_worn(
    person: str, sites: tuple[Site, ...], request: pytest.FixtureRequest
) -> None:
    tracks = at(request.getfixturevalue(person), sites)
    assert groups(tracks) == set()
    assert groups(exchange(tracks, *sites[:2])) == {frozenset(sites[:2])}


@pytest.mark.parametrize("person", ["jumping", "walking"])
def test_whole_legs_cannot_be_reported_apart(person: str, request: pytest.FixtureRequest) -> None:
    tracks: Tracks = request.getfixturevalue(person)
    assert groups(tracks) == set()
    assert groups(exchange(exchange(exchange(tracks, T, RT), S, RS), F, RF)) == set()


@pytest.mark.parametrize("name", ["1D_02", "1D_03", "2D_02", "3D_02"])
def test_a_hinge_turned_by_hand_has_no_upper_end(test_data: TestData, name: str) -> None:
    worn = session_of_mechanism(mechanism(test_data, name))
    for session in (worn, swapped(worn, T, S)):
        assert doubted(session) == set()
        assert not chains_of(session, (T, S)).is_certain


def test_two_feet_share_no_joint_to_be_doubted(test_data: TestData) -> None:
    with np.load(test_data("feet_mocap_events/healthy_feet.npz"), allow_pickle=True) as data:
        time_s = np.arange(len(data["left_foot_acc"])) / float(data["fs"])
        imu = {
            site: ImuBlock("", time_s, *(data[f"{site}_{signal}"].astype(float) for signal in ("gyr", "acc")))
            for site in (F, RF)
        }
    assert doubted(Session((Recording("walk 1", RecordingKind.WALKING, "walk_1", imu),))) == set()


@pytest.mark.parametrize("condition", ["rigid", "soft", "real", "soft, 3 s", "soft walk"])
def test_chains_are_right_and_labels_not_doubted_with_late_and_biased_sensors(condition: str) -> None:
    session = session_of(condition, 1000)
    for sites in (LEG_SITES, (T, S, F), (T, S, RT, RS)):
        found = chains_of(session, sites)
        assert is_right(found)
        assert found.is_certain
    assert doubted(session) == set()


@pytest.mark.endurance
@pytest.mark.parametrize("condition", ["rigid", "soft", "soft, 3 s", "soft walk"])
def test_forty_patients_have_no_wrong_chain_and_no_doubted_label(condition: str) -> None:
    for seed in range(2000, 2040):
        session = session_of(condition, seed)
        assert arranged(*unlabelled(tracks_of(session))).is_right, seed
        assert doubted(session) == set(), seed


@pytest.mark.parametrize("sites", [(T, S), (T, S, F), (T, S, RT, RS), (T, S, F, RT, RS), LEG_SITES])
def test_two_to_six_sensors_are_arranged(circling: Session, sites: tuple[Site, ...]) -> None:
    found = chains_of(circling, sites)
    assert is_right(found)
    assert found.is_certain
    assert sorted(found.sites(Side.LEFT)) == sorted(sites)
    has_rival = len(sites) > 2
    assert np.isfinite(found.margin) == has_rival
    margins = [m for leg in found.legs for m in (leg.knee_margin, leg.ankle_margin) if m is not None]
    assert min(margins) == pytest.approx(found.margin)  # a rival parts one joint at least
    for leg in found.legs:
        assert (leg.foot is None) == (leg.ankle_margin is None)
        assert leg.stature.height_m == pytest.approx(0.6 if leg.foot else 0.4, abs=0.2)


@pytest.mark.parametrize("seed", range(3))
def test_names_order_and_mounting_of_the_sensors_change_nothing(circling: Session, seed: int) -> None:
    rng = np.random.default_rng(seed)
    order = [LEG_SITES[k] for k in rng.permutation(6)]
    plain = chains_of(circling)
    turns = Rotation.random(6, rng=rng)
    names = {site: f"sensor {k}" for k, site in enumerate(order)}
    recordings = []
    for r in circling.recordings:
        imu = {}
        for k, site in enumerate(order):
            b = r.imu[site]
            imu[site] = replace(b, gyr_rad_s=turns[k].apply(b.gyr_rad_s), acc_m_s2=turns[k].apply(b.acc_m_s2))
        recordings.append(replace(r, imu=imu))
    tracks, standing = unlabelled(tracks_of(replace(circling, recordings=tuple(recordings))))
    found = find_chains({names[s]: tracks[s] for s in order}, {names[s]: standing[s] for s in order})
    assert found is not None
    assert {(leg.thigh, leg.shank, leg.foot) for leg in found.legs} == {
        tuple(names[Site(str(sensor))] for sensor in (leg.thigh, leg.shank, leg.foot)) for leg in plain.legs
    }
    # a lag is taken off one clock of two, and which one, the order states
    assert found.margin == pytest.approx(plain.margin, rel=0.2)


@pytest.mark.parametrize("first", list(Side))
@pytest.mark.parametrize("sites", [LEG_SITES, LEG_SITES[::-1]], ids=["in order", "the other way round"])
def test_the_leg_that_moved_first_names_both(first: Side, sites: tuple[Site, ...]) -> None:
    session = walked(Standing(), FreeMotion(duration_s=5.0, is_in_turn=True)).session
    found = chains_of(session, sites)
    assert found.is_first_certain
    assert found.lead_s == pytest.approx(5.0, abs=0.5)
    reported = found.sites(first)
    is_left_first = first is Side.LEFT  # the patient's left leg is the first to move
    assert all((Site(sensor).side is site.side) == is_left_first for sensor, site in reported.items())
    assert set(reported.values()) == set(LEG_SITES)


def test_legs_that_move_together_do_not_show_which_was_first(circling: Session) -> None:
    assert not chains_of(circling).is_first_certain


def test_one_leg_has_no_second_to_lead(circling: Session) -> None:
    assert chains_of(circling, (T, S, F)).lead_s is None


def test_while_one_leg_still_rests_nothing_is_named_with_certainty() -> None:
    """The sensors of the other leg agree with everything."""
    session = walked(Standing(), FreeMotion(duration_s=4.0, is_in_turn=True), seed=8).session
    tracks, standing = unlabelled(tracks_of(session))
    early = find_chains(cut(tracks, 0.0, 4.0), standing)
    assert early is not None
    assert all(leg.is_direction_certain for leg in early.legs)
    assert not early.is_certain
    assert early.lead_s is None
    later = find_chains(tracks, standing)
    assert later is not None
    assert later.is_certain


def test_shanks_that_only_swing_about_resting_knees_are_not_named_with_certainty() -> None:
    """Every sensor then has a resting point at a knee, so any two may share a joint there."""
    session = walked(Standing(), FreeMotion(motion=Motion.KNEE_ONLY)).session
    assert not chains_of(session).is_certain
    assert doubted(session) == set()


def test_lying_without_standing_does_not_show_which_end_is_up() -> None:
    lying = walked(Standing(), FreeMotion(motion=Motion.SIDE_LYING)).session
    assert is_right(chains_of(lying))
    assert chains_of(lying).is_certain
    without = replace(lying, recordings=lying.recordings[1:])
    assert not chains_of(without).is_certain
    assert doubted(without) == set()
    assert doubted(swapped(without, T, F)) == set()


def test_any_two_exchanged_labels_are_named(circling: Session) -> None:
    tracks, standing = unlabelled(tracks_of(circling))
    for one, other in combinations(LEG_SITES, 2):
        stood = {**standing, one: standing[other], other: standing[one]}
        assert groups(exchange(tracks, one, other), stood) == {frozenset((one, other))}


def test_two_exchanges_are_two_findings_and_three_sensors_in_a_circle_one(circling: Session) -> None:
    assert doubted(swapped(swapped(circling, T, S), RS, RF)) == {frozenset((T, S)), frozenset((RS, RF))}
    (finding,) = doubted_labels(tracks_of(swapped(swapped(circling, T, S), S, F))).findings
    assert (finding.key, finding.where) == ("labels_look_mixed", "free motion, left_thigh, left_shank, left_foot")


@pytest.mark.parametrize("sites", [(T, S), (S, F), (T, S, F)])
def test_with_few_sensors_gravity_shows_a_leg_put_on_upside_down(circling: Session, sites: tuple[Site, ...]) -> None:
    session = worn_at(circling, *sites)
    assert doubted(session) == set()
    ends = sites[0], sites[-1]
    assert doubted(swapped(session, *ends)) == {frozenset(ends)}


def test_the_analysis_names_swapped_labels_in_words(circling: Session) -> None:
    leg = worn_at(circling, T, S, F)
    found = analyse(swapped(leg, T, S))
    (finding,) = (f for f in found.findings if f.key == "labels_look_swapped")
    assert finding.severity is Severity.WARNING
    assert sentence(finding).startswith("L thigh and L shank, free motion: These sensors look swapped")
    assert not [f for f in analyse(leg).findings if f.key.startswith("labels")]


def test_a_walk_serves_where_there_is_no_free_motion() -> None:
    walk = walked(Standing(), Walk(strides=4)).session
    (finding,) = doubted_labels(tracks_of(swapped(walk, S, RS))).findings
    assert finding.where == "walk 1, left_shank, right_shank"
    assert doubted_labels(tracks_of(walk)).groups == ()


def test_a_recording_without_two_adjacent_states_nothing_of_labels(circling: Session) -> None:
    assert doubted_labels(tracks_of(worn_at(circling, T, F))).groups == ()
    assert doubted_labels(tracks_of(replace(circling, recordings=circling.recordings[:1]))).groups == ()


def test_a_joint_lies_where_its_two_sensors_say() -> None:
    made = walked(Standing(), FreeMotion(), tissue=Tissue.RIGID)
    tracks, _ = unlabelled(tracks_of(made.session))
    together = at_once(smoothed_in_steps(tracks))
    assert together is not None
    for joint in LEG_JOINTS:
        one, two = (together.sensors[site] for site in (joint.proximal, joint.distal))
        found = link(one, two, together.index, together.window)
        truth = made.truth.recordings["free motion"].joints[joint]
        assert found is not None
        for centre, true, axis in (
            (found.centre_1_m, truth.centre_proximal_m, truth.axis_proximal),
            (found.centre_2_m, truth.centre_distal_m, truth.axis_distal),
        ):
            off = centre - true
            assert np.linalg.norm(off - axis * (axis @ off)) < 0.025


@pytest.mark.parametrize("late_s", [-0.06, -0.03, 0.03, 0.06])
def test_a_late_sensor_still_shares_its_joint(late_s: float) -> None:
    settings = WalkerSettings(
        seed=4, recordings=(FreeMotion(duration_s=6.0),), sites=(T, S, F), clock_late_s={S: late_s}
    )
    tracks, _ = unlabelled(tracks_of(simulate(settings).session))
    together = at_once(smoothed_in_steps(tracks))
    assert together is not None

    def cost(one: Site, two: Site) -> float:
        found = link(together.sensors[one], together.sensors[two], together.index, together.window)
        assert found is not None
        return found.cost

    assert max(cost(T, S), cost(S, F)) < 0.1 * cost(T, F)


def cut(tracks: Tracks, from_s: float, to_s: float) -> Tracks:
    """Only what was sampled between two instants."""
    shortened = {}
    for name, stretches in tracks.items():
        parts = []
        for one in stretches:
            keep = (one.track.time_s >= from_s) & (one.track.time_s < to_s)
            signals = {k: getattr(one.track, k)[keep] for k in ("gyr_rad_s", "acc_m_s2", "is_measured")}
            track = replace(one.track, start_s=float(one.track.time_s[keep][0]), **signals)
            parts.append(replace(one, track=track, q_earth_from_sensor=one.q_earth_from_sensor[keep]))
        shortened[name] = parts
    return shortened


def test_sensors_that_were_never_received_together_give_nothing(circling: Session) -> None:
    tracks, _ = unlabelled(tracks_of(worn_at(circling, T, S)))
    early, late = cut(tracks, 0.0, 2.5), cut(tracks, 3.0, 6.0)
    assert find_chains({T: early[T], S: late[S]}) is None
    assert find_chains({T: early[T], S: []}) is None
    assert find_chains(cut(tracks, 0.0, 1.2)) is None


@pytest.mark.parametrize("count", [1, 8])
def test_one_sensor_or_eight_are_refused(circling: Session, count: int) -> None:
    tracks, _ = unlabelled(tracks_of(circling))
    some = list(tracks.values())
    with pytest.raises(ValueError, match=f"{count} sensors, expected 2 to 7"):
        find_chains({str(k): some[k % 6] for k in range(count)})


def test_a_recording_with_gaps_is_arranged(circling: Session) -> None:
    """Stretches of different sensors begin and end anywhere."""
    rng = np.random.default_rng(3)
    recordings = []
    for r in circling.recordings:
        imu = {}
        for site, b in r.imu.items():
            keep = np.ones(len(b), dtype=bool)
            at = int(rng.integers(len(b) // 3, len(b) // 2))
            keep[at : at + 30] = False
            imu[site] = b.select(keep)
        recordings.append(replace(r, imu=imu))
    assert is_right(chains_of(replace(circling, recordings=tuple(recordings))))


def test_a_minute_of_six_sensors_is_arranged_within_two_seconds_of_a_core(jumping: Tracks) -> None:
    start_s = time.process_time()
    find_chains(jumping)
    assert time.process_time() - start_s < 2.0


def test_a_long_recording_is_reported_by_its_liveliest_minute(circling: Session) -> None:
    """Two minutes of standing before and after change no more than the windows of the headings."""
    standing, free = circling.recordings
    step_s = 0.01
    rest = int(120.0 / step_s)

    def among_rest(site: Site) -> ImuBlock:
        still, moving = standing.imu[site], free.imu[site]

        def row(name: str) -> FloatArray:
            values = getattr(still, name)
            repeated = np.concatenate([values] * (rest // len(values) + 1))[:rest]
            return np.concatenate([repeated, getattr(moving, name), repeated])

        gyr, acc = row("gyr_rad_s"), row("acc_m_s2")
        return ImuBlock(moving.sensor, step_s * np.arange(len(gyr)), gyr, acc)

    long = replace(free, imu={site: among_rest(site) for site in free.imu})
    found = chains_of(replace(circling, recordings=(standing, long)))
    assert is_right(found)
    assert found.is_certain
