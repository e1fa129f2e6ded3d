"""Tests that each walk is compared with its own trial, and that the figures are those of the truth."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.exports.c3d_angles import write_c3d
from app.exports.opensim_motion import Model, write_motion
from app.reports.agreement.pictures import FIGURES, pictures_of
from app.reports.agreement.printed import printed
from app.reports.agreement.study import AgreementStudy, AngleKind, study_of
from app.reports.agreement.tables import agreement_table, curve_table, summary_of
from core.body import LEG_JOINTS, Joint, JointKind, Side
from core.results import Analysis, RecordingAnalysis, ZeroKind
from core.session import Patient, Session
from core.verdicts.model import Assessment, JointVerdicts, Verdict
from devices.files.references.reading import read_reference
from devices.files.references.trial import EVENTS, ReferenceFile, ReferenceTrial
from devices.files.refusal import FileRefusedError
from devices.simulation.walker import SessionTruth
from tests.app.changed_analysis import recalibrated
from tests.app.reports.agreement.agreement_material import PPM, made, rows_of, write_reference
from tests.simulated import analysis_of

TURNED = (Joint.RIGHT_KNEE,)


@pytest.fixture(scope="module")
def truth() -> SessionTruth:
    return made()[1]


@pytest.fixture(scope="module")
def analysis() -> Analysis:
    session, _ = made()
    assert isinstance(session, Session)
    return analysis_of(session)


@pytest.fixture(scope="module")
def study(truth: SessionTruth, analysis: Analysis, tmp_path_factory: pytest.TempPathFactory) -> AgreementStudy:
    rows = [f"{walk},{row}" for walk in ("walk 1", "walk 2") for row in rows_of(truth, walk, turned=TURNED)]
    path = write_reference(tmp_path_factory.mktemp("agree") / "ref.csv", rows, first="recording,")
    return study_of(analysis, [("ref.csv", read_reference(path))])


def test_the_figures_are_those_of_the_truth(study: AgreementStudy, truth: SessionTruth, analysis: Analysis) -> None:
    for walk in study.walks:
        (own,) = [one for one in analysis.recordings if one.name == walk.recording.name]
        for joint in LEG_JOINTS:
            reported = truth.recordings[walk.recording.name].joints[joint]
            inside = (own.time_s > reported.time_s[0] + 0.21) & (own.time_s < reported.time_s[-1] - 0.21)
            error = own.joints[joint].angle_rad - np.interp(own.time_s, reported.time_s, reported.angle_rad)
            error = np.where(inside, error, np.nan)
            found = walk.figures[joint, AngleKind.RESULT]
            # half a millisecond of clock is 0.2 degrees where a knee swings
            assert np.rad2deg(found.z_rad) == pytest.approx(np.rad2deg(np.sqrt(np.nanmean(error**2))), abs=0.05)
            assert np.rad2deg(found.m_rad) == pytest.approx(np.rad2deg(np.nanstd(error)), abs=0.1)
            assert np.rad2deg(found.bias_rad) == pytest.approx(np.rad2deg(np.nanmean(error)), abs=0.03)
            assert np.rad2deg(found.m_rad) < 0.6
            assert found.ranges >= 3


def test_clock_rate_and_sign_are_those_it_was_made_with(study: AgreementStudy) -> None:
    for walk in study.walks:
        assert walk.alignment is not None
        clock = walk.alignment.clock
        assert 1e6 * clock.rate == pytest.approx(1e6 * PPM, abs=40)
        assert clock.offset_s == pytest.approx(7.3 + PPM * clock.at_s, abs=0.001)
        assert {joint for joint, sign in walk.alignment.sign.items() if sign < 0} == set(TURNED)


def trials(rows: list[str], tmp_path: Path, name: str) -> tuple[str, ReferenceFile]:
    return name, read_reference(write_reference(tmp_path / name, rows))


def test_files_without_names_find_their_walks_by_the_motion(
    truth: SessionTruth, analysis: Analysis, tmp_path: Path
) -> None:
    files = [trials(rows_of(truth, f"walk {k}", later_s=50.0 * k), tmp_path, f"trial{5 - k}.csv") for k in (1, 2)]
    found = study_of(analysis, files)
    assert {w.recording.name: w.reference.file for w in found.walks if w.reference} == {
        "walk 1": "trial4.csv",
        "walk 2": "trial3.csv",
    }
    assert found.left_over == ()
    alone = study_of(analysis, files[:1])
    assert [walk.recording.name for walk in alone.walks] == ["walk 1"]
    assert alone.left_over == ("walk 2",)


def test_one_long_trial_holds_both_walks(truth: SessionTruth, analysis: Analysis, tmp_path: Path) -> None:
    rows = [*rows_of(truth, "walk 2", later_s=5.0), *rows_of(truth, "walk 1", later_s=60.0)]
    found = study_of(analysis, [trials(rows, tmp_path, "all.csv")])
    offsets = {w.recording.name: w.alignment.clock.offset_s for w in found.walks if w.alignment}
    assert offsets["walk 1"] == pytest.approx(60.0, abs=0.002)
    assert offsets["walk 2"] == pytest.approx(5.0, abs=0.002)


def test_a_walk_of_another_name_is_not_compared(truth: SessionTruth, analysis: Analysis, tmp_path: Path) -> None:
    """Its name states which walk it is, so a better fit elsewhere is no reason to take it for another."""
    path = write_reference(
        tmp_path / "ref.csv", [f"walk 1,{row}" for row in rows_of(truth, "walk 1")], first="recording,"
    )
    found = study_of(analysis, [("ref.csv", read_reference(path))])
    assert [walk.recording.name for walk in found.walks] == ["walk 1"]


@pytest.mark.parametrize(
    ("what", "stated"),
    [
        ("standing", "the joints hardly move in it"),
        ("short", "both systems recorded less than two seconds of the same motion without gaps"),
        ("other", "its angles match no walk of the session"),
        ("none", "it contains no joint and the session contains left_ankle, left_knee"),
    ],
)
def test_what_cannot_be_compared_is_refused_with_its_reason(analysis: Analysis, what: str, stated: str) -> None:
    time_s = np.arange(0.0, 1.2 if what == "short" else 12.0, 0.01)
    rng = np.random.default_rng(1)
    smooth = np.convolve(rng.normal(0, 3.0, len(time_s)), np.ones(40) / 40, "same")
    angle = np.deg2rad({"standing": 0.2, "other": 60.0}.get(what, 20.0)) * smooth
    angles = {} if what == "none" else {Joint.LEFT_KNEE: (time_s, angle)}
    reference = ReferenceFile("csv", "angles", (ReferenceTrial(angles=angles),))
    with pytest.raises(FileRefusedError, match=stated) as refused:
        study_of(analysis, [("ref.csv", reference)])
    assert str(refused.value).startswith("ref.csv: ")


def test_without_a_zero_there_is_no_z(analysis: Analysis, study: AgreementStudy) -> None:
    bare = recalibrated(analysis, zero=ZeroKind.NONE)
    (walk, _) = study.walks
    assert walk.reference is not None
    reference = ReferenceFile("csv", "angles", (walk.reference.trial,))
    found = study_of(bare, [("ref.csv", reference)]).walks[0].figures[Joint.LEFT_KNEE, AngleKind.RESULT]
    assert np.isnan(found.z_rad)
    assert found.m_rad == pytest.approx(walk.figures[Joint.LEFT_KNEE, AngleKind.RESULT].m_rad, rel=0.05)


def test_left_and_right_exchanged_is_stated_and_where_they_are_not_it_is_not(
    analysis: Analysis, study: AgreementStudy
) -> None:
    assert not any(walk.is_exchanged for walk in study.walks)
    assert study.walks[0].reference is not None
    trial = study.walks[0].reference.trial
    other = {Joint(joint.replace(joint.side, joint.side.other)): curve for joint, curve in trial.angles.items()}
    found = study_of(analysis, [("ref.csv", ReferenceFile("csv", "angles", (replace(trial, angles=other),)))])
    assert [walk.is_exchanged for walk in found.walks] == [True]
    assert "- Left and right look swapped in the reference of walk 1: swapping them gives a better fit." in list(
        printed(found, Patient())
    )


def write_for_gait2392(walk: RecordingAnalysis, is_simulated: bool, path: Path) -> str:
    """For the model whose knee may be straighter than straight, and has the other sign."""
    return write_motion(walk, is_simulated, path, Model.GAIT2392)


@pytest.mark.parametrize("write", [write_c3d, write_for_gait2392])
def test_our_own_exports_agree_with_us(
    analysis: Analysis,
    write: Callable[[RecordingAnalysis, bool, Path], str],
    tmp_path: Path,
) -> None:
    (walk,) = [one for one in analysis.recordings if one.name == "walk 2"]
    path = tmp_path / "export.c3d"  # the name that its library insists on; it gives nothing to the reader
    write(walk, True, path)
    (found,) = study_of(analysis, [("export", read_reference(path))]).walks
    assert found.recording is walk
    for joint in LEG_JOINTS:
        assert np.rad2deg(found.figures[joint, AngleKind.RESULT].z_rad) < 0.02
    if write is write_c3d:
        assert {event for _, event in found.events} == set(EVENTS)
        for events in found.events.values():
            assert (events.found, events.more) == (events.count, 0)
            assert np.abs(events.late_s).max() < 0.001


def test_events_of_the_reference_are_found_and_strides_are_as_long(
    truth: SessionTruth,
    analysis: Analysis,
) -> None:
    feet = truth.recordings["walk 1"].feet
    events = {
        side: {"initial_contact": foot.events.initial_contact_s + 20.0, "toe_off": foot.events.toe_off_s + 20.0}
        for side, foot in feet.items()
    }
    strides = {}
    for side, foot in feet.items():
        contact_s = foot.events.initial_contact_s + 20.0
        strides[side] = np.stack([contact_s[:-1], contact_s[1:], foot.stride_lengths_m[1 : len(contact_s)]], axis=1)
    reference = ReferenceFile("csv", "events", (ReferenceTrial("", {}, events, strides),))
    (walk,) = study_of(analysis, [("events.csv", reference)]).walks
    assert walk.recording.name == "walk 1"  # of two, though nothing names it
    assert walk.events_later_s == pytest.approx(20.0, abs=0.05)
    for (side, event), found in walk.events.items():
        assert found.found == found.count == len(events[side][event])
        assert found.sd_s < 0.03
    for side in Side:
        pairs = walk.lengths_m[side]
        assert len(pairs) >= 3
        assert np.abs(pairs[:, 0] - pairs[:, 1]).max() < 0.05


def test_the_table_has_a_row_for_each_walk_joint_and_angle_and_one_over_walks(study: AgreementStudy) -> None:
    header, rows = agreement_table(study)
    table = [dict(zip(header, row, strict=True)) for row in rows]
    assert len(table) == 2 * 4 * 3  # no magnetometer, so no third angle
    (over,) = [r for r in table if (r["recording"], r["joint"], r["angle"]) == ("over walks", "left_knee", "result")]
    each = [float(r["m_rmse_deg"]) for r in table if r["joint"] == "left_knee" and r["angle"] == "result"][:2]
    assert float(over["m_rmse_deg"]) == pytest.approx(np.mean(each), abs=1e-5)
    assert float(over["m_rmse_sd_deg"]) == pytest.approx(np.std(each, ddof=1), abs=1e-5)
    reported = summary_of(study)
    agreement = reported["agreement"]
    assert isinstance(agreement, list)
    assert [row["m_rmse_deg"] for row in agreement][:3] == [*each, float(over["m_rmse_deg"])]


def test_the_curves_are_what_the_figures_are_of(study: AgreementStudy) -> None:
    walk = study.walks[0]
    header, rows = curve_table(walk)
    table = [dict(zip(header, row, strict=True)) for row in rows]
    error = np.array([float(row["left_knee_error_deg"]) for row in table if row["left_knee_error_deg"]])
    found = walk.figures[Joint.LEFT_KNEE, AngleKind.RESULT]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(np.rad2deg(found.z_rad), abs=1e-4)
    assert {row["left_phase"] for row in table} >= {"loading", "foot_flat", "pre_swing", "swing"}
    assert table[0]["left_knee_reference_deg"] == ""  # before the reference begins


def test_table_1_is_printed_with_the_prosthesis_first(study: AgreementStudy) -> None:
    lines = list(printed(study, Patient(prosthetic_side="right")))
    assert lines[0] == "SIMULATED."
    at = next(k for k, line in enumerate(lines) if line.startswith("M: "))
    assert [line.split()[:2] for line in lines[at + 2 : at + 6]] == [
        ["knee", "prosthesis"],
        ["knee", "contralateral"],
        ["ankle", "prosthesis"],
        ["ankle", "contralateral"],
    ]
    over = study.over_walks(Joint.RIGHT_KNEE)
    assert over is not None
    assert lines[at + 2].split()[-1] == f"{np.rad2deg(over.whole.m_rad):.2f}"
    assert any("Different optical models applied to one walk differ by 2 to 4° at the knee" in line for line in lines)
    published = study.over_walks(Joint.LEFT_KNEE, AngleKind.PUBLISHED)
    assert published is not None
    (stated,) = [line for line in lines if "Published fusion" in line]
    assert f"left knee {np.rad2deg(published.whole.m_rad):.2f}°" in stated
    assert not any("eq 10" in line for line in lines)  # no magnetometer was there
    plain = list(printed(study, Patient()))
    assert not any("prosthesis" in line for line in plain)


def test_a_joint_that_is_not_reported_is_named_and_another_is_not(study: AgreementStudy) -> None:
    assert not any("not reported" in line for line in printed(study, Patient()))
    not_reported = JointVerdicts(
        Assessment(Verdict.NOT_REPORTED), Assessment(Verdict.NOT_REPORTED), Assessment(Verdict.READ)
    )
    walks = [
        replace(
            walk,
            recording=replace(
                walk.recording,
                verdicts=replace(
                    walk.recording.verdicts, joints={**walk.recording.verdicts.joints, joint: not_reported}
                ),
            ),
        )
        for walk, joint in zip(study.walks, (Joint.LEFT_KNEE, Joint.LEFT_ANKLE), strict=True)
    ]
    lines = [line for line in printed(replace(study, walks=tuple(walks)), Patient()) if "not reported" in line]
    assert lines == [
        "- Left knee: not reported in walk 1. Its values are shown here for checking only.",
        "- Left ankle: not reported in walk 2. Its values are shown here for checking only.",
    ]


def test_both_figures_are_drawn_with_the_phases_and_say_what_they_are(study: AgreementStudy) -> None:
    drawn = pictures_of(study, Patient())
    assert set(drawn) == {FIGURES[JointKind.KNEE], FIGURES[JointKind.ANKLE]}
    assert "Knee flexion, left" in drawn[FIGURES[JointKind.KNEE]].alt
    assert "SIMULATED" in drawn[FIGURES[JointKind.KNEE]].svg
    assert drawn[FIGURES[JointKind.KNEE]].svg.count("<path") == 2 * 4  # per side ours, published, reference and error
    assert drawn[FIGURES[JointKind.KNEE]].svg.count("<rect") > 20  # phases of some strides


def passes(rows: list[str], *parts: tuple[float, float]) -> list[list[str]]:
    """What a volume sees of a walk: the rows of some shares of its time."""
    return [rows[round(first * len(rows)) : round(last * len(rows))] for first, last in parts]


def test_every_pass_of_a_walk_is_compared_and_the_samples_used_are_stated(
    truth: SessionTruth, analysis: Analysis, tmp_path: Path
) -> None:
    rows = rows_of(truth, "walk 1")
    parts = passes(rows, (0.05, 0.45), (0.6, 0.95))
    found = study_of(analysis, [trials(part, tmp_path, f"pass{k}.csv") for k, part in enumerate(parts)])
    (walk,) = found.walks
    assert {trial.file for trial, _ in walk.trials} == {"pass0.csv", "pass1.csv"}
    assert found.left_over == ("walk 2",)
    hz = 1.0 / float(np.median(np.diff(walk.recording.time_s)))
    for joint in LEG_JOINTS:
        used = walk.used[joint]
        assert used.used == walk.figures[joint, AngleKind.RESULT].samples
        assert used.used == pytest.approx(sum(map(len, parts)) / 120.0 * hz, abs=4)
        assert used.used + used.outside + used.in_gaps + used.after_slip == used.recorded == len(walk.recording.time_s)
        assert np.rad2deg(walk.figures[joint, AngleKind.RESULT].m_rad) < 0.6
    used = walk.used[Joint.LEFT_KNEE]
    stated = list(printed(found, Patient()))
    line = f"  Left knee: {used.used} of {used.recorded} samples are used; {used.outside} outside the reference"
    assert any(one.startswith(line) for one in stated)
    header, table = agreement_table(found)
    row = dict(zip(header, next(table), strict=True))
    assert [int(row[name]) for name in ("samples", "recorded", "outside_reference", "in_gaps", "after_slip")] == [
        *(used.used, used.recorded, used.outside, used.in_gaps, used.after_slip)
    ]


def test_a_reference_of_markers_is_named_as_such_and_one_of_angles_is_not(
    truth: SessionTruth, analysis: Analysis, study: AgreementStudy, tmp_path: Path
) -> None:
    name, file = trials(rows_of(truth, "walk 1"), tmp_path, "walk.c3d")
    of_markers = study_of(analysis, [(name, replace(file, source="markers"))])
    sentence = "walk.c3d holds markers and no joint angles. Its angles were computed from the markers"
    assert any(sentence in line for line in printed(of_markers, Patient()))
    assert not any("markers" in line for line in printed(study, Patient()))
    for found, source in ((of_markers, "markers"), (study, "angles")):
        header, rows = agreement_table(found)
        assert {row[header.index("reference_source")] for row in rows} == {source}


def test_a_trial_of_times_that_another_shows_is_left_over(
    truth: SessionTruth, analysis: Analysis, tmp_path: Path
) -> None:
    rows = rows_of(truth, "walk 1")
    parts = passes(rows, (0.05, 0.95), (0.4, 0.8))
    names = ("walk 1.csv", "walk_1.csv")  # its name and its folder's, so that no other walk is tried
    found = study_of(analysis, [trials(part, tmp_path, name) for name, part in zip(names, parts, strict=True)])
    (walk,) = found.walks
    assert [trial.file for trial, _ in walk.trials] == ["walk 1.csv"]
    assert found.left_over == ("walk_1.csv", "walk 2")


def test_gaps_of_the_reference_are_counted_and_a_strap_that_slipped_is(
    truth: SessionTruth, analysis: Analysis, tmp_path: Path
) -> None:
    rows = rows_of(truth, "walk 1")
    (walk, *_) = study_of(analysis, [trials([*rows[:400], *rows[460:]], tmp_path, "gap.csv")]).walks
    used = walk.used[Joint.LEFT_KNEE]
    assert used.in_gaps == pytest.approx(60 / 120.0 / float(np.median(np.diff(walk.recording.time_s))), abs=3)
    from_s = float(walk.recording.time_s[-200])
    slipped = replace(
        analysis, recordings=tuple(replace(one, slipped_from_s={Side.LEFT: from_s}) for one in analysis.recordings)
    )
    (walk, *_) = study_of(slipped, [trials(rows, tmp_path, "whole.csv")]).walks
    left, right = walk.used[Joint.LEFT_KNEE], walk.used[Joint.RIGHT_KNEE]
    assert 0 < left.after_slip == right.used - left.used <= 200
    assert right.after_slip == 0


def test_a_reference_of_twenty_samples_a_second_is_used_throughout(
    truth: SessionTruth, analysis: Analysis, tmp_path: Path
) -> None:
    (walk, *_) = study_of(analysis, [trials(rows_of(truth, "walk 1", hz=20.0), tmp_path, "slow.csv")]).walks
    for joint in LEG_JOINTS:
        assert walk.used[joint].in_gaps == 0
        assert walk.used[joint].used > 0.9 * walk.used[joint].recorded


def test_both_parts_of_our_own_motion_file_are_compared(analysis: Analysis, tmp_path: Path) -> None:
    (walk,) = [one for one in analysis.recordings if one.name == "walk 2"]
    n = len(walk.time_s)
    holes = {
        joint: replace(angle, angle_rad=np.where(np.abs(np.arange(n) - n // 2) < 15, np.nan, angle.angle_rad))
        for joint, angle in walk.joints.items()
    }
    write_motion(replace(walk, joints=holes), True, tmp_path / "angles.mot")
    files = [(path.name, read_reference(path)) for path in sorted(tmp_path.glob("*.mot"))]
    assert len(files) == 2
    (found,) = study_of(analysis, files).walks
    assert found.recording is walk
    assert len(found.trials) == 2
    assert all(found.used[joint].used >= n - 29 - 6 for joint in LEG_JOINTS)  # less an edge here and there
