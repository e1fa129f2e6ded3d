"""What the sensors delivered reaches the verdicts it touches, and no other.

Every limit is written out here, as TRUTH has it, never taken from the gates.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Side, Site
from core.results import Analysis, RecordingAnalysis
from core.samples import BoolArray, FloatArray, ImuBlock
from core.session import Session
from core.signal.reception import Reception
from core.verdicts.gates import verdicts_of
from core.verdicts.model import Verdict
from core.verdicts.quantities import side_mean
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.core.verdicts.built_walk import calibrations, leg, not_read, walk, with_gaps
from tests.simulated import simulation_of

FOOT, SHANK, THIGH = Site.LEFT_FOOT, Site.LEFT_SHANK, Site.LEFT_THIGH
KNEE, ANKLE = Joint.LEFT_KNEE, Joint.LEFT_ANKLE
Found = dict[str, tuple[str, tuple[str, ...]]]


def found_of(received: dict[Site, Reception], recording: RecordingAnalysis | None = None) -> Found:
    return not_read(verdicts_of(replace(recording or walk(), received=received), calibrations(), ()))


def hits(verdict: str, gate: str, *quantities: str) -> Found:
    return dict.fromkeys(quantities, (verdict, (gate,))) if verdict else {}


def of_joints(*joints: str) -> tuple[str, ...]:
    return tuple(f"left_{joint} {part}" for joint in joints for part in ("shape", "height"))


@pytest.mark.parametrize(("percent", "verdict"), [(0.9, ""), (1.1, "care"), (4.9, "care"), (5.1, "withheld")])
def test_gaps_in_the_strides_used_hit_the_joints_of_their_sensor_and_a_foots_distances(
    percent: float, verdict: str
) -> None:
    assert found_of({SHANK: with_gaps(percent), FOOT: with_gaps(0.5)}) == hits(
        verdict, "loss", *of_joints("knee", "ankle")
    )
    assert found_of({FOOT: with_gaps(percent)}) == hits(verdict, "loss", *of_joints("ankle"), "left distance")


def test_gaps_beside_the_strides_used_count_for_nothing() -> None:
    strides = leg(Side.LEFT, 14, left_out=4)
    last_s = float(strides.strides.end_s[9])
    beside = Reception(gaps_s=np.array([[8.0, 9.9], [last_s, last_s + 1.9]]))
    assert found_of({FOOT: beside, SHANK: beside, THIGH: beside}, walk(left=strides)) == {}


def test_a_gap_in_which_whole_strides_are_missing_leaves_the_others_as_they_are() -> None:
    assert found_of({THIGH: Reception(gaps_s=np.array([[12.0, 18.0]]))}) == {}
    assert found_of({THIGH: Reception(gaps_s=np.array([[12.0, 13.9]]))}) == hits("withheld", "loss", *of_joints("knee"))


@pytest.mark.parametrize(("strides", "verdict"), [(0, ""), (1, "care"), (2, "care"), (3, "withheld"), (12, "withheld")])
def test_strides_that_exceed_a_sensors_range_hit_what_rests_on_it(strides: int, verdict: str) -> None:
    at_s = 10.0 + 1.1 * np.arange(strides) + 0.5
    rates, forces = Reception(clipped_rates_s=at_s), Reception(clipped_forces_s=at_s)
    assert found_of({THIGH: rates}) == hits(verdict, "clipping", *of_joints("knee"))
    assert found_of({SHANK: rates}) == hits(verdict, "clipping", *of_joints("knee", "ankle"))
    assert found_of({FOOT: rates}) == hits(verdict, "clipping", *of_joints("ankle"), "left distance")
    assert found_of({FOOT: forces}) == hits(verdict, "clipping", "left distance")
    assert found_of({THIGH: forces, SHANK: forces}) == {}


def test_a_range_exceeded_beside_the_strides_used_counts_for_nothing() -> None:
    strides = leg(Side.LEFT, 14, left_out=4)
    beside_s = np.array([5.0, float(strides.strides.end_s[9]) + 0.3])
    beside = Reception(clipped_rates_s=beside_s, clipped_forces_s=beside_s)
    assert found_of({FOOT: beside, SHANK: beside}, walk(left=strides)) == {}


@pytest.mark.parametrize(
    ("percent", "verdict", "gate", "limit"),
    [
        (98.1, "", "", 0.0),
        (97.9, "care", "rate", 98.0),
        (102.1, "care", "rate", 102.0),
        (90.1, "care", "rate", 98.0),
        (89.9, "withheld", "rate", 90.0),
        (110.1, "withheld", "rate", 110.0),
        (50.0, "withheld", "every_second", 90.0),
        (33.3, "withheld", "rate", 90.0),
        (None, "", "", 0.0),
    ],
)
def test_another_rate_than_the_one_set_hits_the_joints_of_its_sensor(
    percent: float | None, verdict: str, gate: str, limit: float
) -> None:
    received = {THIGH: Reception(rate_percent=percent), SHANK: Reception(rate_percent=100.4)}
    assert found_of(received) == hits(verdict, gate, *of_joints("knee"))
    if verdict:
        found = verdicts_of(walk(received=received), calibrations(), ()).joint(KNEE).shape
        assert [(reason.value, reason.limit, reason.unit) for reason in found.reasons] == [(percent, limit, "%")]


# the same from samples


@cache
def walked() -> Session:
    sites = (THIGH, SHANK, FOOT)
    made = simulation_of(WalkerSettings(3, (Standing(), FreeMotion(), Walk(strides=14)), sites, tissue=Tissue.SOFT))
    return made.session


def changed(**of_sites: "Spoiler") -> Session:
    """The walk with some sensors' samples spoiled."""
    *others, last = walked().recordings
    imu = {site: of_sites[site](block) if site in of_sites else block for site, block in last.imu.items()}
    return replace(walked(), recordings=(*others, replace(last, imu=imu)))


class Spoiler:
    """What becomes of a block: rows that are kept, and the range that signals are cut off at."""

    def __init__(self, keeps: BoolArray | None = None, rad_s: float = np.inf, m_s2: float = np.inf) -> None:
        self._keeps, self._rad_s, self._m_s2 = keeps, rad_s, m_s2

    def __call__(self, block: ImuBlock) -> ImuBlock:
        gyr, acc = (
            np.clip(values, -end, end) for values, end in ((block.gyr_rad_s, self._rad_s), (block.acc_m_s2, self._m_s2))
        )
        whole = replace(block, gyr_rad_s=gyr, acc_m_s2=acc)
        return whole if self._keeps is None else whole.select(self._keeps)


@cache
def of_walked() -> Analysis:
    return analyse(walked())


def walk_in(session: Session) -> RecordingAnalysis:
    return analyse(session).recordings[-1]


def mean_of(found: RecordingAnalysis, name: str) -> float:
    return side_mean(found, Side.LEFT, name).found.mean


def times_s() -> FloatArray:
    return walked().recordings[-1].imu[FOOT].time_s


def test_a_foot_at_2_g_has_no_distance_and_keeps_its_angles() -> None:
    found = walk_in(changed(left_foot=Spoiler(m_s2=19.6))).verdicts
    assert [
        reason.gate for reason in found.leg(Side.LEFT).distance.reasons if reason.verdict is Verdict.NOT_REPORTED
    ] == ["clipping"]
    assert found.joint(ANKLE).shape.verdict is not Verdict.NOT_REPORTED
    assert found.leg(Side.LEFT).timing.verdict is not Verdict.NOT_REPORTED


def test_a_gyroscope_that_is_cut_off_has_no_angles_and_a_sound_one_has() -> None:
    found = walk_in(changed(left_thigh=Spoiler(rad_s=1.8))).verdicts
    assert "clipping" in [reason.gate for reason in found.joint(KNEE).shape.reasons]
    assert found.joint(KNEE).shape.verdict is Verdict.NOT_REPORTED
    assert found.joint(ANKLE).shape.verdict is Verdict.READ
    assert found.leg(Side.LEFT).distance.verdict is Verdict.READ


def test_of_samples_lost_one_by_one_every_fifth_may_be_missing() -> None:
    kept = np.random.default_rng(0).random(len(times_s())) >= 0.2
    lossy = walk_in(changed(left_shank=Spoiler(kept)))
    assert lossy.lost_percent[SHANK] == pytest.approx(20.0, abs=2.0)
    assert lossy.verdicts.joint(KNEE).shape.verdict in (Verdict.READ, Verdict.CARE)
    ranges = [mean_of(found, "knee_range_deg") for found in (lossy, of_walked().recordings[-1])]
    assert ranges[0] == pytest.approx(ranges[1], abs=0.5)


def test_a_pause_of_all_sensors_takes_nothing_else() -> None:
    out = np.abs(times_s() - np.mean(times_s())) > 1.6
    analysis = analyse(changed(**{str(site): Spoiler(out) for site in (THIGH, SHANK, FOOT)}))
    paused, found = analysis.recordings[-1], analysis.findings
    assert {gate for _, gates in not_read(paused.verdicts).values() for gate in gates} <= {"strides"}
    (pause,) = (one for one in found if one.key == "pause")
    assert pause.numbers["length_s"] == pytest.approx(3.2, abs=0.05)
    assert {"gaps", "many_gaps", "bridged"}.isdisjoint(one.key for one in found)
    assert max(paused.lost_percent.values()) == 0.0


def test_a_sensor_at_half_its_rate_is_reported_though_its_stamps_show_no_gap() -> None:
    halved = changed(left_shank=Spoiler(np.arange(len(times_s())) % 2 == 0))
    found = analyse(halved)
    (lost,) = (one for one in found.findings if one.key == "every_second_lost")
    assert lost.where == "walk 1, left_shank"
    assert lost.numbers == {"rate_hz": 50.0, "nominal_hz": 100.0, "lost_percent": 50.0}
    knee = found.recordings[-1].verdicts.joint(KNEE).shape
    assert (knee.verdict, [reason.gate for reason in knee.reasons]) == (Verdict.NOT_REPORTED, ["every_second"])
    assert found.recordings[-1].lost_percent[SHANK] == pytest.approx(50.0)
    assert {"every_second_lost", "rate_off"}.isdisjoint(one.key for one in of_walked().findings)
