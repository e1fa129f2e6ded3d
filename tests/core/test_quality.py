"""Does bad input end in a finding, never in a traceback and never in a silent number? (FORMATS, section 4)"""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Segment, Site
from core.findings import Severity
from core.results import Analysis, Method
from core.samples import FloatArray, ImuBlock, Recording, RecordingKind, Session

if TYPE_CHECKING:
    from tests.core.conftest import Person

S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING
THIGH, SHANK, FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
KNEE = Joint.LEFT_KNEE
Change = Callable[[ImuBlock], ImuBlock]


def changed(session: Session, change: Change, sites: tuple[Site, ...] = tuple(Site), *names: str) -> Session:
    """The session with the blocks of some sites (and of some recordings only) spoiled."""
    recordings = []
    for r in session.recordings:
        imu = {s: change(b) if s in sites and (not names or r.name in names) else b for s, b in r.imu.items()}
        recordings.append(replace(r, imu=imu))
    return replace(session, recordings=tuple(recordings))


def first(n: int) -> Change:
    return lambda b: replace(b, time_s=b.time_s[:n], gyr_rad_s=b.gyr_rad_s[:n], acc_m_s2=b.acc_m_s2[:n])


def scaled(gyr: float = 1.0, acc: float = 1.0) -> Change:
    return lambda b: replace(b, gyr_rad_s=gyr * b.gyr_rad_s, acc_m_s2=acc * b.acc_m_s2)


def storm(share: float) -> Change:
    def lose(b: ImuBlock) -> ImuBlock:
        lost = np.random.default_rng(0).random(len(b)) < share
        return replace(b, gyr_rad_s=np.where(lost[:, None], np.nan, b.gyr_rad_s))

    return lose


def late(by_s: float) -> Change:
    return lambda b: replace(b, time_s=b.time_s + by_s)


def told(found: Analysis) -> set[tuple[str, str]]:
    return {(f.key, f.where) for f in found.findings}


def keys(found: Analysis) -> set[str]:
    return {f.key for f in found.findings}


def everywhere(key: str, *sites: Site) -> set[tuple[str, str]]:
    return {(key, f"{name}, {site}") for name in ("standing", "free motion", "walk") for site in sites}


def assert_no_angle(found: Analysis, joint: Joint = KNEE) -> None:
    """No number and a grave word for it."""
    assert all(joint not in r.joints or not np.isfinite(r.joints[joint].angle_rad).any() for r in found.recordings)
    assert any(f.severity is Severity.GRAVE and (str(joint) in f.where or f.where == "session") for f in found.findings)


def error_deg(person: "Person", found: Analysis, name: str, joint: Joint = KNEE) -> FloatArray:
    (recording,) = (r for r in found.recordings if r.name == name)
    truth = person.truth(recording.kind, joint, recording.time_s - recording.time_s[0])
    return np.rad2deg(recording.joints[joint].angle_rad - truth)


methods = pytest.mark.parametrize("method", list(Method))


@methods
@pytest.mark.parametrize("n", [0, 1, 2, 5, 9, 99])
def test_hardly_any_samples(knee_visit: Session, n: int, method: Method) -> None:
    found = analyse(changed(knee_visit, first(n)), method)
    assert told(found) >= everywhere("too_few_samples", THIGH, SHANK)
    assert_no_angle(found)


@methods
@pytest.mark.parametrize("n", [0, 1, 5])
def test_one_broken_walk_leaves_the_others(person: "Person", knee_visit: Session, n: int, method: Method) -> None:
    found = analyse(changed(knee_visit, first(n), (SHANK,), "walk"), method)
    assert ("too_few_samples", "walk, left_shank") in told(found)
    assert np.abs(error_deg(person, found, "free motion")).max() < 2.0
    (walk,) = (r for r in found.recordings if r.name == "walk")
    assert KNEE not in walk.joints


@methods
@pytest.mark.parametrize("n", [105, 150])
def test_a_second_of_data_identifies_nothing(knee_visit: Session, n: int, method: Method) -> None:
    assert_no_angle(analyse(changed(knee_visit, first(n)), method))


@methods
def test_all_zeros(knee_visit: Session, method: Method) -> None:
    for sites in ((THIGH, SHANK), (SHANK,)):
        found = analyse(changed(knee_visit, scaled(0.0, 0.0), sites), method)
        assert told(found) >= everywhere("all_zero", *sites)
        assert_no_angle(found)


@methods
def test_a_gyroscope_that_never_turns(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(gyr=0.0), (SHANK,)), method)
    assert {("all_zero", "free motion, left_shank"), ("all_zero", "walk, left_shank")} <= told(found)
    assert_no_angle(found)


@methods
@pytest.mark.parametrize("share", [0.97, 0.995, 1.1])
def test_storms_of_nan_that_leave_nothing(knee_visit: Session, share: float, method: Method) -> None:
    found = analyse(changed(knee_visit, storm(share)), method)
    assert keys(found) & {"too_few_samples", "many_gaps"}
    assert_no_angle(found)


@methods
@pytest.mark.parametrize(("share", "key"), [(0.05, "bridged"), (0.5, "many_gaps")])
def test_storms_of_nan_that_leave_enough(
    person: "Person", knee_visit: Session, share: float, key: str, method: Method
) -> None:
    found = analyse(changed(knee_visit, storm(share)), method)
    assert told(found) >= everywhere(key, THIGH, SHANK)
    for name in ("free motion", "walk"):
        error = error_deg(person, found, name)
        assert np.count_nonzero(np.isfinite(error)) > 700
        assert np.nanmax(np.abs(error)) < 2.5


@methods
def test_one_axis_that_is_missing_throughout(knee_visit: Session, method: Method) -> None:
    def without_y(b: ImuBlock) -> ImuBlock:
        return replace(b, acc_m_s2=np.where(np.arange(3) == 1, np.nan, b.acc_m_s2))

    found = analyse(changed(knee_visit, without_y, (SHANK,)), method)
    assert told(found) >= everywhere("too_few_samples", SHANK)
    assert_no_angle(found)


@methods
def test_acceleration_in_g(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(acc=1 / 9.81), (SHANK,)), method)
    assert told(found) >= everywhere("acc_in_g", SHANK)
    assert_no_angle(found)


@methods
def test_acceleration_in_no_unit_known(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(acc=100.0), (SHANK,)), method)
    assert told(found) >= everywhere("acc_implausible", SHANK)
    assert_no_angle(found)


@methods
def test_rates_in_degrees(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(gyr=180 / np.pi), (SHANK,)), method)
    assert {("rate_in_deg_s", "free motion, left_shank"), ("rate_in_deg_s", "walk, left_shank")} <= told(found)
    assert_no_angle(found)


@methods
def test_two_sensors_with_the_same_data(leg_visit: Session, method: Method) -> None:
    twice = [replace(r, imu={**r.imu, FOOT: replace(r.imu[SHANK], sensor="foot")}) for r in leg_visit.recordings]
    found = analyse(replace(leg_visit, recordings=tuple(twice)), method)
    assert told(found) >= {("same_data", f"{r.name}, left_shank, left_foot") for r in leg_visit.recordings}
    assert_no_angle(found, KNEE)
    assert_no_angle(found, Joint.LEFT_ANKLE)


@methods
@pytest.mark.parametrize("by_s", [30.0, -30.0])
def test_a_clock_half_a_minute_off(leg_visit: Session, by_s: float, method: Method) -> None:
    found = analyse(changed(leg_visit, late(by_s), (FOOT,)), method)
    assert told(found) >= everywhere("clock_offset", FOOT)
    assert_no_angle(found, Joint.LEFT_ANKLE)
    (offset,) = {f.numbers["offset_s"] for f in found.findings if f.key == "clock_offset"}
    assert offset == pytest.approx(by_s, abs=0.1)
    assert KNEE in found.recordings[0].joints


@methods
def test_two_clocks_that_disagree(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, late(30.0), (SHANK,)), method)
    assert told(found) >= everywhere("clock_offset", SHANK)
    assert_no_angle(found)


@methods
@pytest.mark.parametrize(
    ("sites", "missing"),
    [
        ((THIGH,), {"left_shank"}),
        ((THIGH, FOOT), {"left_shank"}),
        ((FOOT, Site.RIGHT_FOOT), {"left_shank", "right_shank"}),
        ((THIGH, Site.RIGHT_SHANK), {"left_shank", "right_thigh", "right_foot"}),
    ],
)
def test_sites_that_form_no_joint(person: "Person", sites: tuple[Site, ...], missing: set[str], method: Method) -> None:
    found = analyse(person.visit(sites, duration_s=4.0), method)
    assert {where for key, where in told(found) if key == "missing_site"} == missing
    is_feet_only = all(site.segment is Segment.FOOT for site in sites)
    assert ("feet_only" if is_feet_only else "no_joint", "session") in told(found)
    assert all(not r.joints for r in found.recordings)


@methods
def test_a_missing_site_leaves_the_other_joint(person: "Person", knee_visit: Session, method: Method) -> None:
    found = analyse(knee_visit, method)
    assert ("missing_site", "left_foot") in told(found)
    assert np.abs(error_deg(person, found, "walk")).max() < 1.0


@pytest.mark.endurance
@methods
@pytest.mark.parametrize("kinds", [(F, W), (W,), (F,), (S, W)])
def test_sessions_without_some_recordings(person: "Person", kinds: tuple[RecordingKind, ...], method: Method) -> None:
    found = analyse(person.visit(kinds=kinds), method)
    assert ("no_standing" in keys(found)) is (S not in kinds)
    name = "walk" if W in kinds else "free motion"
    error = error_deg(person, found, name)
    assert np.std(error) < 1.0 or (kinds == (F,) and "clinical_sign_uncertain" in keys(found))
    if method is Method.ROBUST:
        assert ("axis_from_walking" in keys(found)) is (F not in kinds)


@methods
@pytest.mark.parametrize("sites", [(THIGH, SHANK), (FOOT,)])
def test_only_standing(person: "Person", sites: tuple[Site, ...], method: Method) -> None:
    found = analyse(person.visit(sites, kinds=(S,)), method)
    assert ("no_joint", "session") in told(found)
    assert (found.recordings, found.calibrations) == ((), ())


@methods
def test_standing_that_is_called_a_walk(knee_visit: Session, method: Method) -> None:
    standing = knee_visit.recordings[0]
    found = analyse(replace(knee_visit, recordings=(standing, replace(standing, name="walk", kind=W))), method)
    assert ("too_little_motion", "left_knee") in told(found)
    assert_no_angle(found)


@methods
def test_nothing_at_all(knee_visit: Session, method: Method) -> None:
    discarded = tuple(replace(r, is_kept=False) for r in knee_visit.recordings)
    bare = tuple(replace(r, imu={}) for r in knee_visit.recordings)
    for recordings in ((), discarded, bare):
        found = analyse(Session(recordings), method)
        assert ("no_joint", "session") in told(found)


@methods
def test_a_few_infinite_values_are_missing_samples(person: "Person", knee_visit: Session, method: Method) -> None:
    def overflow(b: ImuBlock) -> ImuBlock:
        gyr = b.gyr_rad_s.copy()
        gyr[150:153] = [np.inf, -np.inf, np.nan]
        return replace(b, gyr_rad_s=gyr)

    found = analyse(changed(knee_visit, overflow), method)
    assert np.nanmax(np.abs(error_deg(person, found, "walk"))) < 1.0


@methods
def test_infinite_values_throughout(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, lambda b: replace(b, gyr_rad_s=np.full_like(b.gyr_rad_s, np.inf))), method)
    assert told(found) >= everywhere("too_few_samples", THIGH, SHANK)
    assert_no_angle(found)


@methods
def test_clipped_rates_are_told(knee_visit: Session, method: Method) -> None:
    clipped = changed(knee_visit, lambda b: replace(b, gyr_rad_s=np.clip(b.gyr_rad_s, -2, 2)), (SHANK,), "walk")
    assert ("clipped", "walk, left_shank") in told(analyse(clipped, method))


@methods
def test_walking_instead_of_standing_gives_no_zero(person: "Person", knee_visit: Session, method: Method) -> None:
    walk = knee_visit.recordings[2]
    moved = (replace(walk, name="standing", kind=S), *knee_visit.recordings[1:])
    found = analyse(replace(knee_visit, recordings=moved), method)
    assert {("moved_while_standing", "standing, left_thigh"), ("gyro_bias_unknown", "left_knee")} <= told(found)
    assert np.std(error_deg(person, found, "walk")) < 1.0


@pytest.mark.endurance
@pytest.mark.parametrize("start_s", [-1e9, 1e9, 1.7e9])
def test_stamps_far_from_zero_change_nothing(person: "Person", knee_visit: Session, start_s: float) -> None:
    near, far = analyse(knee_visit), analyse(person.visit(start_s=start_s))
    assert told(near) == told(far)
    for one, other in zip(near.recordings, far.recordings, strict=True):
        difference = one.joints[KNEE].angle_rad - other.joints[KNEE].angle_rad
        assert np.rad2deg(np.abs(difference)).max() < 0.01
        np.testing.assert_allclose(other.time_s - other.time_s[0], one.time_s - one.time_s[0], atol=1e-5)


@methods
def test_gaps_are_gaps_in_the_angle(person: "Person", knee_visit: Session, method: Method) -> None:
    def hole(b: ImuBlock) -> ImuBlock:
        keep = (b.time_s - b.time_s[0] < 4.0) | (b.time_s - b.time_s[0] > 4.6)
        return replace(b, time_s=b.time_s[keep], gyr_rad_s=b.gyr_rad_s[keep], acc_m_s2=b.acc_m_s2[keep])

    found = analyse(changed(knee_visit, hole, (SHANK,), "walk"), method)
    (walk,) = (r for r in found.recordings if r.name == "walk")
    t, angle = walk.time_s - walk.time_s[0], walk.joints[KNEE].angle_rad
    inside = (t > 4.005) & (t < 4.595)
    assert np.isnan(angle[inside]).all()
    assert np.isfinite(angle[(t < 3.995) | (t > 4.605)]).all()
    assert np.isnan(walk.joints[KNEE].sd_rad[inside]).all()
    assert np.nanmax(np.abs(error_deg(person, found, "walk"))) < 2.0
    assert ("gaps", "walk, left_shank") in told(found)


def test_what_raises_in_progress_ends_the_analysis(knee_visit: Session) -> None:
    class StoppedError(Exception):
        pass

    shares: list[float] = []

    def stop(share: float, _: str) -> None:
        shares.append(share)
        if len(shares) == 3:
            raise StoppedError

    with pytest.raises(StoppedError):
        analyse(knee_visit, progress=stop)
    assert shares == sorted(shares)
    assert all(0.0 <= share <= 1.0 for share in shares)


def test_findings_say_each_thing_once(knee_visit: Session) -> None:
    found = analyse(changed(knee_visit, first(5)))
    seen = [(f.key, f.where, tuple(sorted(f.numbers.items()))) for f in found.findings]
    assert len(seen) == len(set(seen))


def test_a_recording_of_other_sites_only_is_left_in_peace(person: "Person", knee_visit: Session) -> None:
    other: Recording = person.recording("arms", F, 3.0, (FOOT,))
    found = analyse(replace(knee_visit, recordings=(*knee_visit.recordings, other)))
    (arms,) = (r for r in found.recordings if r.name == "arms")
    assert not arms.joints
    assert len(arms.time_s) == 300
