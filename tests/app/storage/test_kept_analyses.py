"""An analysis that is kept is the one that would be computed, to the last bit, and never another's."""

from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from pathlib import Path
from typing import Any
from uuid import UUID

import numpy as np
import pytest

from app.storage import kept_analyses
from app.storage.analysis_content import DamagedContentError, packed, unpacked
from app.storage.kept_analyses import bare, find_analysis, inputs_of, is_same_question, keep_analysis
from app.storage.library import DEMONSTRATOR, Library
from app.storage.results import key_of
from app.storage.stored import ResultKind
from core.alignment import AlignmentChange, PartChange, ProsthesisPart
from core.body import Joint, Side, Site
from core.findings import Finding, Severity
from core.prosthesis import AmputationLevel, FootKind, KneeKind, Prosthesis
from core.results import Analysis
from core.samples import ImuBlock, RateKind, SensorInfo
from core.session import Patient, Recording, Session
from core.timed.protocols import PlannedTest, TimedProtocol
from tests.simulated import WALK_OF_ONE_LEG, analysis_of, session_of

SHANK = Site.LEFT_SHANK


@pytest.fixture(scope="module")
def session() -> Session:
    """A walk of one leg: short, for every bit of it is compared."""
    simulated = session_of(WALK_OF_ONE_LEG)
    return replace(
        simulated,
        patient=Patient(code="DEMO-1", affected_side="left"),
        sensors={SHANK: SensorInfo(serial="S1", rate_hz=100.0, rate_kind=RateKind.INSTANTANEOUS)},
        zero_rad={Joint.LEFT_KNEE: 0.1},
        findings=(Finding("unknown_key", Severity.INFO, "session.toml", {"name": "mood", "share": np.float64(1 / 3)}),),
    )


@pytest.fixture(scope="module")
def analysis(session: Session) -> Analysis:
    return analysis_of(bare(session))


@pytest.fixture
def library(tmp_path: Path) -> Iterator[Library]:
    """Of no operator's own: what is kept does not depend on the database."""
    with Library.create(tmp_path / "library", None, DEMONSTRATOR) as library:
        yield library


@pytest.fixture
def visit_id(library: Library) -> UUID:
    return library.sessions.create(library.patients.create(Patient(code="P-1")).id, Session(())).id


def with_block(session: Session, change: Callable[[ImuBlock], ImuBlock]) -> Session:
    """The session, with one sensor's samples of the walk changed."""
    return with_walk(session, lambda walk: replace(walk, imu={**walk.imu, SHANK: change(walk.imu[SHANK])}))


def with_walk(session: Session, change: Callable[[Recording], Recording]) -> Session:
    return replace(session, recordings=(session.recordings[0], change(session.recordings[1])))


def nudged(values: Any) -> Any:
    """The same values, but for the last bit of one."""
    other = values.copy()
    other.flat[7] = np.nextafter(other.flat[7], np.inf)
    return other


def test_what_is_kept_is_what_would_be_computed_to_the_last_bit(
    library: Library, visit_id: UUID, session: Session, analysis: Analysis
) -> None:
    """Arrays, figures, order in memory: `packed` holds all of it, and is the same for the same only."""
    keep_analysis(library.results, visit_id, session, analysis)
    kept = find_analysis(library.results, visit_id, session)
    assert kept is not None
    assert packed(kept) == packed(analysis_of(session))
    knee, again = (a.recordings[0].joints[Joint.LEFT_KNEE].angle_rad for a in (analysis, kept))
    assert knee.tobytes() == again.tobytes()
    assert kept.findings == analysis.findings
    assert kept.calibrations[0].joints.keys() == analysis.calibrations[0].joints.keys()
    nudged_walk = replace(analysis.recordings[0], time_s=nudged(analysis.recordings[0].time_s))
    assert packed(replace(analysis, recordings=(nudged_walk,))) != packed(analysis)


def test_anything_that_an_analysis_is_given_makes_it_another_one(session: Session) -> None:
    """And what it is not given, the words between people, does not."""
    changed: list[Session] = [
        with_block(session, lambda block: replace(block, gyr_rad_s=nudged(block.gyr_rad_s))),
        with_block(session, lambda block: replace(block, acc_m_s2=nudged(block.acc_m_s2))),
        with_block(session, lambda block: replace(block, time_s=nudged(block.time_s))),
        with_block(session, lambda block: replace(block, mag=np.ones((len(block), 3)))),
        with_block(session, lambda block: replace(block, q_earth_from_sensor=np.ones((len(block), 4)))),
        with_block(session, lambda block: replace(block, is_rate_derived=True)),
        with_walk(session, lambda walk: replace(walk, name="walk 9")),
        with_walk(session, lambda walk: replace(walk, folder="walk_9")),
        with_walk(session, lambda walk: replace(walk, is_kept=False)),
        with_walk(session, lambda walk: replace(walk, is_restrapped_before=True)),
        with_walk(session, lambda walk: replace(walk, imu={Site.RIGHT_SHANK: walk.imu[SHANK]})),
        replace(session, recordings=session.recordings[1:]),
        replace(session, recordings=session.recordings[::-1]),
        replace(session, patient=replace(session.patient, affected_side="right")),
        replace(session, patient=replace(session.patient, prosthetic_side="left")),
        *(
            replace(session, patient=replace(session.patient, prosthetic_side="left", prostheses={Side.LEFT: one}))
            for one in (
                Prosthesis(AmputationLevel.TRANSTIBIAL),
                Prosthesis(AmputationLevel.TRANSFEMORAL),
                Prosthesis(AmputationLevel.TRANSFEMORAL, KneeKind.POLYCENTRIC),
                Prosthesis(AmputationLevel.TRANSTIBIAL, foot=FootKind.SACH),
            )
        ),
        replace(session, sensors={}),
        replace(session, sensors={SHANK: SensorInfo(rate_hz=100.0, rate_kind=RateKind.AVERAGED)}),
        replace(session, sensors={SHANK: SensorInfo(rate_hz=101.0, rate_kind=RateKind.INSTANTANEOUS)}),
        replace(session, zero_rad={Joint.LEFT_KNEE: np.nextafter(0.1, 1.0)}),
        replace(session, turned_sign={Joint.LEFT_KNEE: -1}),
        replace(session, is_simulated=False),
        replace(session, findings=()),
        with_walk(session, lambda walk: replace(walk, test=PlannedTest(TimedProtocol.TEN_METRES))),
        with_walk(session, lambda walk: replace(walk, test=PlannedTest(TimedProtocol.TEN_METRES, end_key_s=9.0))),
    ]
    keys = [key_of(inputs_of(one)) for one in (session, *changed)]
    assert len(set(keys)) == len(keys)
    words = replace(session, notes="tired", operator="hk", surface="lawn", started="2026-11-22", software="x")
    not_worn = {Side.RIGHT: Prosthesis(AmputationLevel.TRANSTIBIAL)}
    reported = replace(session.patient, code="P-2", height_m=1.8, device="knee", prostheses=not_worn)
    same = [
        replace(words, patient=reported, unknown={"mood": "good"}),
        with_walk(session, lambda walk: replace(walk, condition="AFO", note="n", started="s", unknown={"a": 1})),
        with_block(session, lambda block: replace(block, sensor="other", unknown={"t": np.ones(len(block))})),
    ]
    same.append(with_walk(session, lambda walk: replace(walk, left_out_s={Side.LEFT: (2.0,)})))
    changed_part = AlignmentChange("AFO", (PartChange(ProsthesisPart.PYLON, height_mm=3.0),))
    same.append(with_walk(session, lambda walk: replace(walk, alignment=changed_part)))
    assert {key_of(inputs_of(one)) for one in same} == {keys[0]}
    are_same = [is_same_question(session, one) for one in same]
    assert are_same == [True, True, False, True, True]  # other blocks may be others
    assert not any(is_same_question(session, one) for one in changed)
    assert all(str(bare(one).recordings[1].imu[SHANK]) == str(bare(session).recordings[1].imu[SHANK]) for one in same)
    assert all(bare(one).patient == Patient(affected_side="left") for one in same)


def test_every_field_is_either_in_the_key_or_kept_from_the_analysis(session: Session) -> None:
    """Whoever adds a field has to say which: an analysis that reads what the key does not hold would be a wrong one."""
    in_key = {
        Session: {"recordings", "patient", "sensors", "zero_rad", "turned_sign", "is_simulated", "findings"},
        Recording: {"name", "kind", "folder", "imu", "is_kept", "is_restrapped_before"},
        Patient: {"affected_side", "prosthetic_side", "prostheses"},
        SensorInfo: {"rate_hz", "rate_kind"},
    }
    given = bare(session)
    reported = {
        Session: given,
        Recording: given.recordings[1],
        Patient: given.patient,
        SensorInfo: given.sensors[SHANK],
    }
    for kind, names in in_key.items():
        for field in fields(kind):
            if field.name not in names:
                empty: Any = kind() if kind in (Patient, SensorInfo) else None
                value = getattr(reported[kind], field.name)
                assert value in ("", None, (), {}) or value == getattr(empty, field.name, None), (kind, field.name)


def test_another_version_of_the_algorithm_is_never_answered_with_what_an_earlier_one_found(
    library: Library,
    visit_id: UUID,
    session: Session,
    analysis: Analysis,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """A line of the core that changes makes another version of it, whatever number the release has."""
    keep_analysis(library.results, visit_id, session, analysis)
    kept_analyses.algorithm.cache_clear()
    (tmp_path / "angle.py").write_text("TAU_S = 5.0\n")
    with monkeypatch.context() as patched:
        patched.setattr(kept_analyses, "CODE", tmp_path)
        first = kept_analyses.algorithm()
        assert find_analysis(library.results, visit_id, session) is None
        kept_analyses.algorithm.cache_clear()
        (tmp_path / "angle.py").write_text("TAU_S = 5.1\n")
        assert kept_analyses.algorithm() != first
    kept_analyses.algorithm.cache_clear()
    assert find_analysis(library.results, visit_id, session) is not None
    turned = replace(session, turned_sign={Joint.LEFT_KNEE: -1})
    assert find_analysis(library.results, visit_id, turned) is None


def test_a_damaged_analysis_is_computed_again_and_replaced(
    library: Library, visit_id: UUID, session: Session, analysis: Analysis
) -> None:
    """No byte of it may be another one; what is cut off, empty or of another program is nothing, and no trouble."""
    good = packed(analysis)
    rng = np.random.default_rng(7)
    damaged = [good[:-1], good[:40], good[:10], b"", b"\0" * 64, good + b"\0"]
    for at in rng.integers(0, len(good), 30):
        damaged.append(good[:at] + bytes([good[at] ^ 1 << int(rng.integers(8))]) + good[at + 1 :])
    for content in damaged:
        with pytest.raises(DamagedContentError):
            unpacked(content)
    inputs = inputs_of(session)
    for content_format, content in (("gaitwright-kept-analysis/1", damaged[0]), ("another/2", good)):
        library.results.keep(visit_id, ResultKind.ANALYSIS, inputs, content_format, content)
        assert find_analysis(library.results, visit_id, session) is None
        keep_analysis(library.results, visit_id, session, analysis)
        kept = find_analysis(library.results, visit_id, session)
        assert kept is not None
        assert packed(kept) == good
