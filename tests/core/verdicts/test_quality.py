"""Bad input ends in a finding, never in a traceback and never in a silent number (FORMATS, section 4)."""

from dataclasses import replace

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Segment, Side, Site
from core.findings import Severity
from core.results import Analysis, Method
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from core.signal.reception import lost_percent
from core.verdicts.quality import look_at
from devices.simulation.walker import (
    COARSE,
    VERY_COARSE,
    FreeMotion,
    Manner,
    SensorErrors,
    Standing,
    Tissue,
    Walk,
    WalkerSettings,
)
from tests.core.cut_blocks import Change, changed, first
from tests.core.hinges import PERSON
from tests.simulated import session_of, simulation_of

S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING
THIGH, SHANK, FOOT = Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT
KNEE = Joint.LEFT_KNEE


def scaled(gyr: float = 1.0, acc: float = 1.0) -> Change:
    return lambda b: replace(b, gyr_rad_s=gyr * b.gyr_rad_s, acc_m_s2=acc * b.acc_m_s2)


def storm(share: float) -> Change:
    def lose(b: ImuBlock) -> ImuBlock:
        lost = np.random.default_rng(0).random(len(b)) < share
        return replace(b, gyr_rad_s=np.where(lost[:, None], np.nan, b.gyr_rad_s))

    return lose


def late(by_s: float) -> Change:
    return lambda b: replace(b, time_s=b.time_s + by_s)


def without_y(b: ImuBlock) -> ImuBlock:
    return replace(b, acc_m_s2=np.where(np.arange(3) == 1, np.nan, b.acc_m_s2))


def infinite(b: ImuBlock) -> ImuBlock:
    return replace(b, gyr_rad_s=np.full_like(b.gyr_rad_s, np.inf))


def reported(found: Analysis) -> set[tuple[str, str]]:
    return {(f.key, f.where) for f in found.findings}


def keys(found: Analysis) -> set[str]:
    return {f.key for f in found.findings}


def everywhere(key: str, *sites: Site) -> set[tuple[str, str]]:
    return {(key, f"{name}, {site}") for name in ("standing", "free motion", "walk") for site in sites}


def assert_no_angle(found: Analysis, joint: Joint = KNEE) -> None:
    """No number and a grave word for it."""
    assert all(joint not in r.joints or not np.isfinite(r.joints[joint].angle_rad).any() for r in found.recordings)
    assert any(f.severity is Severity.GRAVE and (str(joint) in f.where or f.where == "session") for f in found.findings)


methods = pytest.mark.parametrize(
    "method", [Method.ROBUST, pytest.param(Method.PUBLISHED, marks=pytest.mark.endurance)]
)


UNUSABLE: dict[str, tuple[Change, tuple[Site, ...], str]] = {
    **{f"hardly any samples: {n}": (first(n), (THIGH, SHANK), "too_few_samples") for n in (0, 1, 2, 5, 9, 99)},
    "one axis that is missing throughout": (without_y, (SHANK,), "too_few_samples"),
    "infinite values throughout": (infinite, (THIGH, SHANK), "too_few_samples"),
    "acceleration in no unit known": (scaled(acc=100.0), (SHANK,), "acc_implausible"),
    "two clocks that disagree": (late(30.0), (SHANK,), "clock_offset"),
}


@methods
@pytest.mark.parametrize("case", UNUSABLE)
def test_what_cannot_be_used_is_reported_everywhere_and_gives_no_angle(
    knee_visit: Session, case: str, method: Method
) -> None:
    change, sites, key = UNUSABLE[case]
    found = analyse(changed(knee_visit, change, sites), method)
    assert reported(found) >= everywhere(key, *sites)
    assert_no_angle(found)


@methods
@pytest.mark.parametrize("n", [0, 1, 5])
def test_one_broken_walk_leaves_the_others(knee_visit: Session, n: int, method: Method) -> None:
    found = analyse(changed(knee_visit, first(n), (SHANK,), "walk"), method)
    assert ("too_few_samples", "walk, left_shank") in reported(found)
    assert np.abs(PERSON.error_deg(found, "free motion")).max() < 2.0
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
        assert reported(found) >= everywhere("all_zero", *sites)
        assert_no_angle(found)


@methods
def test_a_gyroscope_that_never_turns(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(gyr=0.0), (SHANK,)), method)
    assert {("all_zero", "free motion, left_shank"), ("all_zero", "walk, left_shank")} <= reported(found)
    assert_no_angle(found)


@methods
@pytest.mark.parametrize("share", [0.97, 0.995, 1.1])
def test_storms_of_nan_that_leave_nothing(knee_visit: Session, share: float, method: Method) -> None:
    found = analyse(changed(knee_visit, storm(share)), method)
    assert keys(found) & {"too_few_samples", "many_gaps"}
    assert_no_angle(found)


@methods
@pytest.mark.parametrize(("share", "key"), [(0.05, "bridged"), (0.5, "gaps")])
def test_storms_of_nan_that_leave_enough(knee_visit: Session, share: float, key: str, method: Method) -> None:
    found = analyse(changed(knee_visit, storm(share)), method)
    assert reported(found) >= everywhere(key, THIGH, SHANK)
    for name in ("free motion", "walk"):
        error = PERSON.error_deg(found, name)
        assert np.count_nonzero(np.isfinite(error)) > 700
        assert np.nanmax(np.abs(error)) < 2.5


@methods
def test_acceleration_in_g(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(acc=1 / 9.81), (SHANK,)), method)
    assert reported(found) >= everywhere("acc_in_g", SHANK)
    assert_no_angle(found)


@methods
def test_rates_in_degrees(knee_visit: Session, method: Method) -> None:
    found = analyse(changed(knee_visit, scaled(gyr=180 / np.pi), (SHANK,)), method)
    assert {("rate_in_deg_s", "free motion, left_shank"), ("rate_in_deg_s", "walk, left_shank")} <= reported(found)
    assert_no_angle(found)


@methods
def test_two_sensors_with_the_same_data(leg_visit: Session, method: Method) -> None:
    twice = [replace(r, imu={**r.imu, FOOT: replace(r.imu[SHANK], sensor="foot")}) for r in leg_visit.recordings]
    found = analyse(replace(leg_visit, recordings=tuple(twice)), method)
    assert reported(found) >= {("same_data", f"{r.name}, left_shank, left_foot") for r in leg_visit.recordings}
    assert_no_angle(found, KNEE)
    assert_no_angle(found, Joint.LEFT_ANKLE)


@methods
@pytest.mark.parametrize("by_s", [30.0, -30.0])
def test_a_clock_half_a_minute_off(leg_visit: Session, by_s: float, method: Method) -> None:
    found = analyse(changed(leg_visit, late(by_s), (FOOT,)), method)
    assert reported(found) >= everywhere("clock_offset", FOOT)
    assert_no_angle(found, Joint.LEFT_ANKLE)
    (offset,) = {f.numbers["offset_s"] for f in found.findings if f.key == "clock_offset"}
    assert offset == pytest.approx(by_s, abs=0.1)
    assert KNEE in found.recordings[0].joints


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
def test_sites_that_form_no_joint(sites: tuple[Site, ...], missing: set[str], method: Method) -> None:
    found = analyse(PERSON.visit(sites, duration_s=4.0), method)
    assert {where for key, where in reported(found) if key == "missing_site"} == missing
    is_feet_only = all(site.segment is Segment.FOOT for site in sites)
    assert ("feet_only" if is_feet_only else "no_joint", "session") in reported(found)
    assert all(not r.joints for r in found.recordings)


@methods
def test_a_missing_site_leaves_the_other_joint(knee_visit: Session, method: Method) -> None:
    found = analyse(knee_visit, method)
    assert ("missing_site", "left_foot") in reported(found)
    assert np.abs(PERSON.error_deg(found, "walk")).max() < 1.0


@pytest.mark.endurance
@methods
@pytest.mark.parametrize("kinds", [(F, W), (W,), (F,), (S, W)])
def test_sessions_without_some_recordings(kinds: tuple[RecordingKind, ...], method: Method) -> None:
    found = analyse(PERSON.visit(kinds=kinds), method)
    assert ("no_standing" in keys(found)) is (S not in kinds)
    name = "walk" if W in kinds else "free motion"
    error = PERSON.error_deg(found, name)
    assert np.std(error) < 1.0 or (kinds == (F,) and "clinical_sign_uncertain" in keys(found))
    if method is Method.ROBUST:
        assert ("axis_from_walking" in keys(found)) is (F not in kinds)


@methods
@pytest.mark.parametrize("sites", [(THIGH, SHANK), (FOOT,)])
def test_only_standing(sites: tuple[Site, ...], method: Method) -> None:
    found = analyse(PERSON.visit(sites, kinds=(S,)), method)
    assert ("no_joint", "session") in reported(found)
    assert (found.recordings, found.calibrations) == ((), ())


@methods
def test_standing_that_is_called_a_walk(knee_visit: Session, method: Method) -> None:
    standing = knee_visit.recordings[0]
    found = analyse(replace(knee_visit, recordings=(standing, replace(standing, name="walk", kind=W))), method)
    assert ("too_little_motion", "left_knee") in reported(found)
    assert_no_angle(found)


@methods
def test_nothing_at_all(knee_visit: Session, method: Method) -> None:
    discarded = tuple(replace(r, is_kept=False) for r in knee_visit.recordings)
    bare = tuple(replace(r, imu={}) for r in knee_visit.recordings)
    for recordings in ((), discarded, bare):
        found = analyse(Session(recordings), method)
        assert ("no_joint", "session") in reported(found)


@methods
def test_a_few_infinite_values_are_missing_samples(knee_visit: Session, method: Method) -> None:
    def overflow(b: ImuBlock) -> ImuBlock:
        gyr = b.gyr_rad_s.copy()
        gyr[150:153] = [np.inf, -np.inf, np.nan]
        return replace(b, gyr_rad_s=gyr)

    found = analyse(changed(knee_visit, overflow), method)
    assert np.nanmax(np.abs(PERSON.error_deg(found, "walk"))) < 1.0


@methods
def test_clipped_rates_are_reported(knee_visit: Session, method: Method) -> None:
    clipped = changed(knee_visit, lambda b: replace(b, gyr_rad_s=np.clip(b.gyr_rad_s, -2, 2)), (SHANK,), "walk")
    assert ("clipped", "walk, left_shank") in reported(analyse(clipped, method))


@methods
def test_walking_instead_of_standing_gives_no_zero(knee_visit: Session, method: Method) -> None:
    walk = knee_visit.recordings[2]
    moved = (replace(walk, name="standing", kind=S), *knee_visit.recordings[1:])
    found = analyse(replace(knee_visit, recordings=moved), method)
    assert {("moved_while_standing", "standing, left_thigh"), ("gyro_bias_unknown", "left_knee")} <= reported(found)
    assert np.std(PERSON.error_deg(found, "walk")) < 1.0


def coarse(gyr_step: float, acc_step: float) -> Change:
    return lambda b: replace(
        b,
        gyr_rad_s=gyr_step * np.round(b.gyr_rad_s / gyr_step),
        acc_m_s2=acc_step * np.round(b.acc_m_s2 / acc_step),
    )


def test_a_clipped_accelerometer_is_reported(knee_visit: Session) -> None:
    def clip(b: ImuBlock) -> ImuBlock:
        shock = 40.0 * np.sin(2 * np.pi * 5.0 * b.time_s) * (b.time_s % 1.0 < 0.2)
        return replace(b, acc_m_s2=np.clip(b.acc_m_s2 + shock[:, None], -19.6, 19.6))

    (found,) = (f for f in look_at(changed(knee_visit, clip, (SHANK,), "walk")).findings if f.key == "clipped")
    assert found.where == "walk, left_shank"


@pytest.mark.parametrize("errors", [COARSE, VERY_COARSE])
def test_a_coarse_sensor_is_not_clipped_nor_stuck_nor_a_copy(errors: SensorErrors) -> None:
    recordings = (Standing(), Walk(standing_before_s=2.0, standing_after_s=2.0))
    for seed in range(2):
        rate_hz = 50.0 * (1 + seed)
        settings = WalkerSettings(
            seed, recordings, (THIGH, SHANK, FOOT), errors=errors, prosthetic_side=Side.LEFT, rate_hz=rate_hz
        )
        assert not look_at(session_of(settings)).findings


def test_a_slow_peak_of_a_coarse_sensor_is_not_its_range() -> None:
    def hold(b: ImuBlock) -> ImuBlock:
        slow = 5.0 * np.sin(2 * np.pi * 0.5 * (b.time_s - b.time_s[0]))
        return replace(b, gyr_rad_s=np.round(np.stack([slow, slow, slow], axis=-1), 1))

    reported_of = look_at(changed(PERSON.visit((SHANK,), duration_s=8.0), hold)).findings
    assert "clipped" not in {f.key for f in reported_of}


def test_a_coarse_sensor_in_free_motion_has_a_range_wider_than_that() -> None:
    motion = (FreeMotion(duration_s=8.0),)
    for seed, errors in ((14, VERY_COARSE), (18, VERY_COARSE), (117, COARSE)):
        made = simulation_of(WalkerSettings(seed, motion, errors=errors, rate_hz=200.0))
        assert not look_at(made.session).findings


@pytest.mark.parametrize("rate_hz", [100.0, 200.0])
def test_stamps_that_jitter_lack_no_samples(rate_hz: float) -> None:
    for seed in range(3):
        walk = (Standing(), Walk(strides=5))
        settings = WalkerSettings(seed, walk, (THIGH, SHANK, FOOT), rate_hz=rate_hz, stamp_jitter_s=0.001)
        assert not look_at(session_of(settings)).findings


@pytest.mark.endurance
@pytest.mark.parametrize("loss", [0.01, 0.1, 0.3])
def test_lost_samples_are_counted_with_and_without_jitter(loss: float) -> None:
    still = (Standing(duration_s=30.0),)
    for jitter_s in (0.0, 0.001):
        settings = WalkerSettings(1, still, loss_fraction=loss, stamp_jitter_s=jitter_s)
        for block in session_of(settings).recordings[0].imu.values():
            really = 100.0 * (1.0 - len(block) / 3001)
            assert lost_percent(block.time_s, block.time_s) == pytest.approx(really, abs=0.4 + 0.15 * really)


def test_coarse_sensors_at_rest_on_a_table_are_no_copies() -> None:
    rng = np.random.default_rng(0)

    def still(name: str) -> ImuBlock:
        gyr, acc = rng.normal(0.0, 0.0004, (1000, 3)), np.array([0.0, 0.0, 9.81]) + rng.normal(0.0, 0.01, (1000, 3))
        block = ImuBlock(name, np.arange(1000) / 100.0, gyr, acc)
        return coarse(0.00122, 0.0392)(block)

    at_rest = Recording("standing", S, "standing", {site: still(str(site)) for site in (THIGH, SHANK)})
    assert "same_data" not in {f.key for f in look_at(Session((at_rest,))).findings}


def test_a_copy_of_a_coarse_sensor_is_found_by_what_moves(leg_visit: Session) -> None:
    visit = changed(leg_visit, coarse(0.01, 0.05))
    walk = visit.recordings[-1]
    twice = replace(walk, imu={**walk.imu, FOOT: replace(walk.imu[SHANK], sensor="foot")})
    found = look_at(replace(visit, recordings=(twice,))).findings
    assert ("same_data", "walk, left_shank, left_foot") in {(f.key, f.where) for f in found}


@pytest.mark.parametrize(("factor", "unit"), [(1e3, "ms"), (1e6, "µs")])
def test_times_in_milliseconds_are_reported_and_nothing_is_computed(
    knee_visit: Session, factor: float, unit: str
) -> None:
    found = analyse(changed(knee_visit, lambda b: replace(b, time_s=factor * (b.time_s - b.time_s[0])), (SHANK,)))
    assert reported(found) >= everywhere("time_in_ms", SHANK)
    assert {f.numbers["unit"] for f in found.findings if f.key == "time_in_ms"} == {unit}
    assert_no_angle(found)


def test_a_slow_sensor_does_not_show_milliseconds() -> None:
    keys_reported = {
        f.key
        for f in look_at(changed(PERSON.visit(duration_s=20.0), lambda b: b.select(slice(None, None, 20)))).findings
    }
    assert "time_in_ms" not in keys_reported
    assert "low_rate" in keys_reported


REVERSED = scaled(acc=-1.0)
TURNING = WalkerSettings(tissue=Tissue.SOFT, recordings=(Standing(), Walk(turn_rad=np.pi)))


@pytest.mark.parametrize("site", [Site.LEFT_THIGH, Site.RIGHT_SHANK, Site.LEFT_FOOT])
def test_one_reversed_sensor_is_reported_and_left_out(site: Site) -> None:
    looked = look_at(changed(session_of(TURNING), REVERSED, (site,)))
    assert [(f.key, f.where) for f in looked.findings] == [("acc_reversed", f"walk 1, {site}")]
    assert looked.unusable == {("standing", site), ("walk 1", site)}


def test_of_two_sensors_that_disagree_neither_is_used() -> None:
    two = replace(TURNING, sites=(THIGH, SHANK))
    looked = look_at(changed(session_of(two), REVERSED, (SHANK,)))
    assert ("acc_reversed", "walk 1, left_thigh, left_shank") in {(f.key, f.where) for f in looked.findings}
    assert {("walk 1", THIGH), ("walk 1", SHANK)} <= looked.unusable


def test_gyroscopes_off_by_degrees_are_not_taken_for_reversed_accelerometers() -> None:
    errors = SensorErrors(gyro_bias_sd_rad_s=np.deg2rad(1.5), acc_bias_sd_m_s2=0.1)
    session = session_of(WalkerSettings(seed=2000, errors=errors))
    assert "acc_reversed" not in {found.key for found in look_at(session).findings}


def test_all_accelerometers_reversed_change_no_angle_and_need_no_word() -> None:
    recordings = (Standing(), FreeMotion(duration_s=5.0), Walk(strides=4))
    session = session_of(replace(TURNING, recordings=recordings, sites=(THIGH, SHANK, FOOT)))
    plain, mirrored = analyse(session), analyse(changed(session, REVERSED))
    assert reported(plain) == reported(mirrored)
    for one, other in zip(plain.recordings, mirrored.recordings, strict=True):
        for joint, angle in one.joints.items():
            difference = np.rad2deg(angle.angle_rad - other.joints[joint].angle_rad)
            assert np.nanmax(np.abs(difference)) < 0.3


@pytest.mark.endurance
@pytest.mark.parametrize("manner", [Manner.ORDINARY, Manner.FLAT, Manner.DRAGGING])
def test_sensors_of_a_straight_walk_are_not_called_reversed(manner: Manner) -> None:
    walk = Walk(speed_m_s=0.6, manner=manner, strides=6)
    settings = WalkerSettings(recordings=(walk, FreeMotion(duration_s=6.0)), tissue=Tissue.REAL)
    assert "acc_reversed" not in {f.key for f in look_at(session_of(settings)).findings}


def test_sensors_switched_on_one_after_the_other_have_one_clock(leg_visit: Session) -> None:
    """The foot's was started and stopped six seconds after the others: its stamps are right."""
    walk = leg_visit.recordings[-1]
    whole = session_of(WalkerSettings(sites=(THIGH, SHANK, FOOT), recordings=(Walk(strides=20),))).recordings[0]
    end_s = float(whole.imu[FOOT].time_s[-1])

    def part(b: ImuBlock, from_s: float, to_s: float) -> ImuBlock:
        return b.select((b.time_s >= from_s) & (b.time_s <= to_s))

    imu = {site: part(b, 6.0, end_s) if site is FOOT else part(b, 0.0, end_s - 6.0) for site, b in whole.imu.items()}
    late_start = replace(walk, imu=imu)
    assert "clock_offset" not in {f.key for f in look_at(Session((late_start,))).findings}
    off = replace(late_start, imu={**imu, FOOT: late(6.0)(part(whole.imu[FOOT], 0.0, end_s - 6.0))})
    assert "clock_offset" in {f.key for f in look_at(Session((off,))).findings}


def test_a_gyroscope_that_holds_one_value_is_stuck(knee_visit: Session) -> None:
    frozen = changed(knee_visit, lambda b: replace(b, gyr_rad_s=np.full_like(b.gyr_rad_s, 0.02)), (SHANK,))
    reported_of = {(f.key, f.where) for f in look_at(frozen).findings}
    assert {("stuck_throughout", "free motion, left_shank"), ("stuck_throughout", "walk, left_shank")} <= reported_of


@pytest.mark.parametrize(("tremor_rad_s", "is_reported"), [(0.04, False), (1.0, True)])
def test_a_trembling_stance_is_rest_and_a_shaking_one_is_reported(
    knee_visit: Session, tremor_rad_s: float, is_reported: bool
) -> None:
    def tremble(b: ImuBlock) -> ImuBlock:
        shake = tremor_rad_s * np.sin(2 * np.pi * 5.0 * b.time_s)
        return replace(b, gyr_rad_s=b.gyr_rad_s + shake[:, None] * [1.0, 0.0, 0.0])

    found = look_at(changed(knee_visit, tremble, (SHANK,), "standing")).findings
    assert ("moved_while_standing" in {f.key for f in found}) is is_reported


@pytest.mark.endurance
@pytest.mark.parametrize("start_s", [-1e9, 1e9, 1.7e9])
def test_stamps_far_from_zero_change_nothing(knee_visit: Session, start_s: float) -> None:
    near, far = analyse(knee_visit), analyse(PERSON.visit(start_s=start_s))
    assert reported(near) == reported(far)
    for one, other in zip(near.recordings, far.recordings, strict=True):
        difference = one.joints[KNEE].angle_rad - other.joints[KNEE].angle_rad
        assert np.rad2deg(np.abs(difference)).max() < 0.01
        np.testing.assert_allclose(other.time_s - other.time_s[0], one.time_s - one.time_s[0], atol=1e-5)


@methods
def test_gaps_are_gaps_in_the_angle(knee_visit: Session, method: Method) -> None:
    def hole(b: ImuBlock) -> ImuBlock:
        return b.select((b.time_s - b.time_s[0] < 4.0) | (b.time_s - b.time_s[0] > 4.6))

    found = analyse(changed(knee_visit, hole, (SHANK,), "walk"), method)
    (walk,) = (r for r in found.recordings if r.name == "walk")
    t, angle = walk.time_s - walk.time_s[0], walk.joints[KNEE].angle_rad
    inside = (t > 4.005) & (t < 4.595)
    assert np.isnan(angle[inside]).all()
    assert np.isfinite(angle[(t < 3.995) | (t > 4.605)]).all()
    assert np.isnan(walk.joints[KNEE].sd_rad[inside]).all()
    assert np.nanmax(np.abs(PERSON.error_deg(found, "walk"))) < 2.0
    assert ("gaps", "walk, left_shank") in reported(found)


def test_what_raises_in_progress_ends_the_analysis(knee_visit: Session) -> None:
    class HaltedError(Exception):
        pass

    shares: list[float] = []

    def stop(share: float, _: str) -> None:
        shares.append(share)
        if len(shares) == 3:
            raise HaltedError

    with pytest.raises(HaltedError):
        analyse(knee_visit, progress=stop)
    assert shares == sorted(shares)
    assert all(0.0 <= share <= 1.0 for share in shares)


def test_findings_say_each_thing_once(knee_visit: Session) -> None:
    found = analyse(changed(knee_visit, first(5)))
    seen = [(f.key, f.where, tuple(sorted(f.numbers.items()))) for f in found.findings]
    assert len(seen) == len(set(seen))


def test_a_recording_of_other_sites_only_is_left_in_peace(knee_visit: Session) -> None:
    other: Recording = PERSON.recording("arms", F, 3.0, (FOOT,))
    found = analyse(replace(knee_visit, recordings=(*knee_visit.recordings, other)))
    (arms,) = (r for r in found.recordings if r.name == "arms")
    assert not arms.joints
    assert len(arms.time_s) == 300
