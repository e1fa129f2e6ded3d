"""Tests that each joint rests on the recordings that FORMATS section 1 states, sentence by sentence."""

import numpy as np
import pytest

from core.analysis import analyse
from core.body import Joint, Site
from core.calibration.validity import Basis, basis_of, in_force, spans_of_validity
from core.results import AxisSource, ZeroKind
from core.samples import ImuBlock
from core.session import Recording, RecordingKind, Session
from tests.core.hinges import PERSON, Person

S, F, W = RecordingKind.STANDING, RecordingKind.FREE_MOTION, RecordingKind.WALKING
KNEE = (Site.LEFT_THIGH, Site.LEFT_SHANK)
LEG = (*KNEE, Site.LEFT_FOOT)
EMPTY = ImuBlock("none", np.empty(0), np.empty((0, 3)), np.empty((0, 3)))


def recording(
    name: str, kind: RecordingKind, sites: tuple[Site, ...] = LEG, is_kept: bool = True, is_restrapped: bool = False
) -> Recording:
    imu = dict.fromkeys(sites, EMPTY)
    return Recording(name, kind, name, imu, is_kept=is_kept, is_restrapped_before=is_restrapped)


def basis(session: Session, name: str, joint: Joint = Joint.LEFT_KNEE) -> Basis:
    for span in spans_of_validity(session):
        for one in span:
            if one.name == name:
                return basis_of(span, one, joint)
    raise AssertionError(f"no kept recording {name}")


def session(*recordings: Recording) -> Session:
    return Session(recordings)


def test_the_latest_standing_and_free_motion_before_the_walk_count() -> None:
    visit = session(*(recording(n, k) for n, k in [("s1", S), ("f1", F), ("s2", S), ("f2", F), ("w1", W), ("s3", S)]))
    found = basis(visit, "w1")
    assert (found.standing, found.free_motion, found.is_from_after) == ("s2", "f2", False)


def test_each_walk_has_its_own_latest() -> None:
    visit = session(*(recording(n, k) for n, k in [("s1", S), ("f1", F), ("w1", W), ("f2", F), ("w2", W), ("s2", S)]))
    assert basis(visit, "w1").free_motion == "f1"
    assert basis(visit, "w2").free_motion == "f2"
    assert basis(visit, "w1").standing == basis(visit, "w2").standing == "s1"


def test_without_any_before_the_first_after_counts_and_that_is_reported() -> None:
    visit = session(*(recording(n, k) for n, k in [("w1", W), ("s1", S), ("s2", S), ("f1", F), ("f2", F)]))
    found = basis(visit, "w1")
    assert (found.standing, found.free_motion, found.is_from_after) == ("s1", "f1", True)


def test_one_from_before_and_one_from_after_is_from_after() -> None:
    visit = session(recording("f1", F), recording("w1", W), recording("s1", S))
    found = basis(visit, "w1")
    assert (found.standing, found.free_motion, found.is_from_after) == ("s1", "f1", True)


def test_a_discarded_recording_calibrates_nothing() -> None:
    visit = session(
        recording("s1", S),
        recording("s2", S, is_kept=False),
        recording("f1", F, is_kept=False),
        recording("w0", W, is_kept=False),
        recording("w1", W),
    )
    found = basis(visit, "w1")
    assert (found.standing, found.free_motion, found.walks) == ("s1", None, ("w1",))


def test_only_recordings_that_hold_both_sites_count() -> None:
    visit = session(
        recording("s1", S, LEG),
        recording("f1", F, LEG),
        recording("s2", S, KNEE),
        recording("f2", F, (Site.LEFT_SHANK, Site.LEFT_FOOT)),
        recording("w1", W, LEG),
    )
    knee, ankle = basis(visit, "w1"), basis(visit, "w1", Joint.LEFT_ANKLE)
    assert (knee.standing, knee.free_motion) == ("s2", "f1")
    assert (ankle.standing, ankle.free_motion) == ("s1", "f2")


def test_nothing_reaches_across_a_restrapping_in_either_direction() -> None:
    visit = session(
        recording("s1", S),
        recording("f1", F),
        recording("w1", W),
        recording("w2", W, is_restrapped=True),
        recording("s2", S),
        recording("w3", W, is_restrapped=True),
    )
    assert basis(visit, "w1").standing == "s1"
    second = basis(visit, "w2")
    assert (second.standing, second.free_motion, second.is_from_after, second.walks) == ("s2", None, True, ("w2",))
    third = basis(visit, "w3")
    assert (third.standing, third.free_motion, third.walks) == (None, None, ("w3",))


def test_a_restrapping_before_a_discarded_recording_was_a_restrapping_too() -> None:
    visit = session(recording("s1", S), recording("w1", W, is_kept=False, is_restrapped=True), recording("w2", W))
    assert basis(visit, "w2").standing is None


def test_a_restrapping_before_the_first_recording_begins_no_empty_span() -> None:
    visit = session(recording("s1", S, is_restrapped=True), recording("w1", W))
    assert [[r.name for r in span] for span in spans_of_validity(visit)] == [["s1", "w1"]]


def test_the_walks_of_one_span_are_pooled_and_of_another_not() -> None:
    visit = session(
        recording("f1", F),
        recording("w1", W),
        recording("w2", W, KNEE),
        recording("w3", W),
        recording("w4", W, is_restrapped=True),
    )
    assert basis(visit, "w1", Joint.LEFT_ANKLE).walks == ("w1", "w3")
    assert basis(visit, "w1").walks == ("w1", "w2", "w3")
    assert basis(visit, "w4").walks == ("w4",)


def test_no_recordings_have_no_span() -> None:
    assert spans_of_validity(Session(())) == []
    assert spans_of_validity(session(recording("w", W, is_kept=False))) == []


def test_a_free_motion_calibrates_itself() -> None:
    visit = session(recording("f1", F), recording("f2", F), recording("w1", W))
    assert basis(visit, "f1").free_motion == "f1"
    assert basis(visit, "f2").free_motion == "f2"
    (span,) = spans_of_validity(visit)
    assert in_force(span, span[0], S, KNEE, Recording.holds) is None


def visit_of(person: Person, *plan: tuple[str, RecordingKind, bool, bool], sites: tuple[Site, ...] = KNEE) -> Session:
    recordings, start_s = [], 0.0
    for name, kind, is_kept, is_restrapped in plan:
        lasts_s = 3.0 if kind is S else 6.0
        recordings.append(
            person.recording(
                name, kind, lasts_s, sites, start_s=start_s, is_kept=is_kept, is_restrapped_before=is_restrapped
            )
        )
        start_s += 30.0
    return Session(tuple(recordings))


@pytest.mark.endurance
def test_every_joint_states_from_which_recordings() -> None:
    plan = [("s1", S), ("f1", F), ("s2", S), ("f2", F), ("w1", W), ("w2", W)]
    visit = visit_of(PERSON, *((n, k, n != "f2", False) for n, k in plan), sites=LEG)
    (calibration,) = analyse(visit).calibrations
    assert calibration.walks == ("w1", "w2")
    knee, ankle = calibration.joints[Joint.LEFT_KNEE], calibration.joints[Joint.LEFT_ANKLE]
    assert (knee.standing_from, knee.free_motion_from, knee.walks_from) == ("s2", "f1", ())
    assert (ankle.standing_from, ankle.free_motion_from, ankle.walks_from) == ("s2", "f1", ("w1", "w2"))
    assert {f.key for f in analyse(visit).findings} >= {"recording_discarded"}


def test_two_free_motions_give_two_calibrations() -> None:
    plan = [("s1", S), ("f1", F), ("w1", W), ("f2", F), ("w2", W)]
    first, second = analyse(visit_of(PERSON, *((n, k, True, False) for n, k in plan))).calibrations
    assert (first.walks, second.walks) == (("w1",), ("w2",))
    assert first.joints[Joint.LEFT_KNEE].free_motion_from == "f1"
    assert second.joints[Joint.LEFT_KNEE].free_motion_from == "f2"


def test_standing_after_the_walk_gives_the_zero_and_is_reported() -> None:
    found = analyse(visit_of(PERSON, ("w", W, True, False), ("s", S, True, False)))
    (knee,) = found.calibrations[0].joints.values()
    assert (knee.zero, knee.standing_from) == (ZeroKind.STANDING, "s")
    assert knee.axis_source in (AxisSource.WALKING, AxisSource.HINGE)
    assert "calibration_after_walk" in {f.key for f in found.findings}


def test_new_straps_need_a_calibration_of_their_own() -> None:
    before, after = Person(seed=1), Person(seed=2)
    first = visit_of(before, ("s1", S, True, False), ("f1", F, True, False), ("w1", W, True, False))
    second = visit_of(after, ("f2", F, True, True), ("w2", W, True, False))
    found = analyse(Session((*first.recordings, *second.recordings)))
    one, two = (c.joints[Joint.LEFT_KNEE] for c in found.calibrations)
    assert [c.walks for c in found.calibrations] == [("w1",), ("w2",)]
    assert (one.zero, one.standing_from, one.free_motion_from) == (ZeroKind.STANDING, "s1", "f1")
    assert (two.zero, two.standing_from, two.free_motion_from) == (ZeroKind.NONE, None, "f2")
    for person, knee in ((before, one), (after, two)):
        truth = person.axis(Site.LEFT_SHANK, Joint.LEFT_KNEE)
        assert knee.clinical_sign * knee.axis_distal @ truth == pytest.approx(1.0, abs=1e-4)
    assert ("restrapped", "f2") in {(f.key, f.where) for f in found.findings}


def test_a_discarded_walk_has_no_angles() -> None:
    found = analyse(visit_of(PERSON, ("s", S, True, False), ("w1", W, True, False), ("w2", W, False, False)))
    assert [r.name for r in found.recordings] == ["w1"]
