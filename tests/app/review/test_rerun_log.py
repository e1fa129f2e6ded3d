"""Tests of the Rerun log: every sample and angle, the same bytes each time, and nobody's name."""

import csv
import os
import subprocess
import sys
import time
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rerun.blueprint as rrb
from rerun.chunk import Chunk, RrdReader
from syrupy.assertion import SnapshotAssertion

from app.exports.gait_csv import write_gait
from app.review import rerun_log
from app.review.data_quality_panel import document, name_of_view
from app.review.rerun_log import write_log
from app.summary.drawn_legs import draw_legs
from app.summary.facts import Facts
from app.summary.headline import headline_of
from app.summary.request import AnalysedVisit
from app.summary.walk_figures import verdict_of
from app.theme.colours import DARK
from app.wording.verdicts import verdict_word
from core.body import LEG_JOINTS, Joint, Side, Site
from core.gait.phases import PHASES
from core.results import Analysis, JointAngle, Method, RecordingAnalysis
from core.samples import FloatArray, ImuBlock
from core.session import Patient, Recording, RecordingKind, Session
from core.verdicts.model import READ, Assessment, GateReason, JointVerdicts, Verdict, Verdicts, assess
from tests.simulated import SHORT_WALK, analysis_of, session_of


def block(n: int, seed: int) -> ImuBlock:
    rng = np.random.default_rng(seed)
    gyr_rad_s = rng.normal(size=(n, 3))
    gyr_rad_s[n // 2] = np.nan
    return ImuBlock(f"serial {seed}", 5 + np.arange(n) / 100, gyr_rad_s, rng.normal(size=(n, 3)))


def visit(n: int = 50) -> tuple[Session, Analysis]:
    thigh, shank = Site.LEFT_THIGH, Site.LEFT_SHANK
    recordings = (
        Recording("Standing of Mr Miller", RecordingKind.STANDING, "miller", {thigh: block(n, 1), shank: block(n, 2)}),
        Recording("walk Miller 1", RecordingKind.WALKING, "w1", {thigh: block(n, 3), shank: block(n, 4)}),
        Recording("walk Miller 2", RecordingKind.WALKING, "w2", {thigh: block(n, 5)}, is_kept=False),
        Recording("walk Miller 3", RecordingKind.WALKING, "w3", {thigh: block(n, 6), shank: block(n, 7)}),
    )
    rng = np.random.default_rng(0)
    analysed = tuple(
        RecordingAnalysis(
            r.name,
            r.folder,
            r.kind,
            r.imu[thigh].time_s,
            {Joint.LEFT_KNEE: JointAngle(rng.normal(size=n), np.full(n, 0.1), rng.normal(size=n), None)},
            verdicts=Verdicts({Joint.LEFT_KNEE: JointVerdicts(READ, READ, READ)}),
        )
        for r in recordings
        if r.kind is RecordingKind.WALKING and r.is_kept
    )
    session = Session(recordings, Patient(code="Miller"), operator="Miller", notes="Miller")
    return session, Analysis(Method.ROBUST, False, (), analysed)


def logged(session: Session, analysis: Analysis, folder: Path) -> Path:
    path = folder / "session.rrd"
    write_log(session, analysis, path)
    return path


@lru_cache(maxsize=10)
def chunks_of(path: Path) -> list[Chunk]:
    """Everything in a log but its layout; read once, as no test writes to a path twice."""
    return list(RrdReader(path).stream())


def look_of(path: Path, entity: str) -> dict[str, Any]:
    """What holds at any time of one entity."""
    (found,) = (c for c in chunks_of(path) if c.is_static and c.entity_path == entity)
    return found.to_record_batch().to_pydict()


def layout_of(path: Path) -> str:
    """The stored layout, as text."""
    reader = RrdReader(path)
    (layout,) = reader.blueprints()
    return "".join(str(c.to_record_batch().to_pydict()) for c in reader.stream(store=layout))


def opaque(colour: str) -> list[list[int]]:
    """A colour of the theme as a log has it."""
    return [[int(colour[1:] + "FF", 16)]]


def curve(path: Path, entity: str, timeline: str) -> tuple[FloatArray, FloatArray]:
    """Read one entity on one timeline: seconds and values (n, k)."""
    chunks = [c for c in chunks_of(path) if c.entity_path == entity and not c.is_static]
    batches = [c.to_record_batch() for c in chunks if timeline in c.timeline_names]
    time_s = [batch.column(timeline).cast("int64").to_numpy() / 1e9 for batch in batches]
    values = [np.array(batch.column("Scalars:scalars").to_pylist(), dtype=float) for batch in batches]
    in_order = np.argsort(np.concatenate(time_s), kind="stable")
    return np.concatenate(time_s)[in_order], np.concatenate(values)[in_order]


def test_every_sample_and_angle_comes_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rerun_log, "ROWS_PER_CHUNK", 20)
    session, analysis = visit()
    path = logged(session, analysis, tmp_path)
    walk, angles = session.recordings[1], analysis.recordings[0]

    time_s, gyr_rad_s = curve(path, "/raw/left_shank/angular_rate", "walking_1")
    np.testing.assert_allclose(time_s, walk.imu[Site.LEFT_SHANK].time_s, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(gyr_rad_s, walk.imu[Site.LEFT_SHANK].gyr_rad_s)

    angle = angles.joints[Joint.LEFT_KNEE]
    time_s, result_deg = curve(path, "/angles/left_knee/result", "walking_1")
    np.testing.assert_allclose(time_s, angles.time_s, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(result_deg[:, 0], np.rad2deg(angle.angle_rad))
    _, band_deg = curve(path, "/angles/left_knee/certainty", "walking_1")
    np.testing.assert_allclose(band_deg[:, 1] - band_deg[:, 0], 4 * np.rad2deg(angle.sd_rad))


GOOD, BAD = READ, assess([GateReason("zero", Verdict.NOT_REPORTED)])
SIGN = assess([GateReason("sign", Verdict.NOT_REPORTED, 0.1, 0.25)])
NOBODYS = {"/angles/left_knee/result", "/angles/left_knee/result_shape", "/withheld/left_knee/result"}


def judged_visit(
    shape: Assessment, height: Assessment, sign: Assessment, slipped_from_s: float = np.inf
) -> tuple[Session, Analysis]:
    """The visit above with other verdicts of its first walk; the second can be read."""
    session, analysis = visit()
    first, second = analysis.recordings
    first = replace(
        first,
        verdicts=Verdicts({Joint.LEFT_KNEE: JointVerdicts(shape, height, sign)}),
        slipped_from_s={Side.LEFT: slipped_from_s},
    )
    return session, replace(analysis, recordings=(first, second))


def lies_at(path: Path, timeline: str) -> set[str]:
    return {
        chunk.entity_path
        for chunk in chunks_of(path)
        if timeline in chunk.timeline_names and chunk.entity_path in NOBODYS
    }


@pytest.mark.parametrize(
    ("stated", "entity", "name"),
    [
        ((GOOD, GOOD, GOOD), "/angles/left_knee/result", "result °"),
        (
            (assess([GateReason("drift", Verdict.CARE, 4.0, 3.0, "deg")]), GOOD, GOOD),
            "/angles/left_knee/result",
            "result °",
        ),
        ((GOOD, BAD, GOOD), "/angles/left_knee/result_shape", "result, shape °"),
        ((GOOD, BAD, SIGN), "/withheld/left_knee/result", "result, withheld °"),
        ((BAD, BAD, GOOD), "/withheld/left_knee/result", "result, withheld °"),
    ],
)
def test_a_curve_lies_where_what_may_be_stated_of_it_lets_it(
    tmp_path: Path, stated: tuple[Assessment, Assessment, Assessment], entity: str, name: str
) -> None:
    session, analysis = judged_visit(*stated)
    path = logged(session, analysis, tmp_path)
    assert lies_at(path, "walking_1") == {entity}
    assert lies_at(path, "walking_2") == {"/angles/left_knee/result"}
    angle_deg = np.rad2deg(analysis.recordings[0].joints[Joint.LEFT_KNEE].angle_rad)
    taken_deg = angle_deg.mean() if "shape" in entity else 0.0
    _, curve_deg = curve(path, entity, "walking_1")
    np.testing.assert_allclose(curve_deg[:, 0], angle_deg - taken_deg, atol=1e-12)
    label = look_of(path, entity)
    assert label["SeriesLines:names"] == [[name]]
    assert (label["SeriesLines:colors"] == opaque(DARK.control)) == entity.startswith("/withheld")
    shown = layout_of(path)
    assert "/withheld" not in shown
    assert "'Data quality'" in shown


def test_once_a_strap_slipped_a_curve_is_not_reported(tmp_path: Path) -> None:
    session, analysis = judged_visit(GOOD, GOOD, GOOD, slipped_from_s=5.2)
    path = logged(session, analysis, tmp_path)
    before_s, _ = curve(path, "/angles/left_knee/result", "walking_1")
    after_s, after_deg = curve(path, "/withheld/left_knee/result", "walking_1")
    time_s = analysis.recordings[0].time_s
    np.testing.assert_allclose(np.concatenate([before_s, after_s]), time_s, atol=1e-9)
    assert (before_s < 5.2).all()
    assert len(after_s) == len(after_deg) == np.count_nonzero(time_s >= 5.2)


def text_of(path: Path, entity: str) -> str:
    return str(look_of(path, entity)["TextDocument:text"][0][0])


def test_the_log_states_what_may_be_read_and_why_not(tmp_path: Path) -> None:
    path = logged(*judged_visit(GOOD, BAD, SIGN), tmp_path)
    first, second = text_of(path, "/may_be_read").split("## walking_2")
    assert "| left knee | shape | read |  |" in first
    assert "| left knee | height | withheld | There is no standing reference" in first
    assert "| left knee | sign | withheld | Flexion and extension could not be distinguished" in first
    assert "| left knee | sign | read |  |" in second
    assert "| right knee | shape | not measured |  |" in first
    assert "| both legs | between | not measured |  |" in first


def test_the_log_states_what_it_is_for(tmp_path: Path) -> None:
    assert "Research use. Not a medical device." in text_of(logged(*visit(), tmp_path), "/may_be_read")


def test_a_recording_is_a_timeline_and_a_discarded_one_is_not_there(tmp_path: Path) -> None:
    chunks = chunks_of(logged(*visit(), tmp_path))
    assert {name for chunk in chunks for name in chunk.timeline_names} == {"standing_1", "walking_1", "walking_2"}
    result = [chunk.timeline_names for chunk in chunks if chunk.entity_path == "/angles/left_knee/result"]
    assert sorted(names[0] for names in result if names) == ["walking_1", "walking_2"]


def test_the_layout_is_in_the_file(tmp_path: Path) -> None:
    path = logged(*visit(), tmp_path)
    reader = RrdReader(path)
    (layout,) = reader.blueprints()
    assert layout.application_id == reader.recordings()[0].application_id == rerun_log.APPLICATION
    text = layout_of(path)
    for part in ("Angles and phases", "Angular rate", "Specific force", "/angles/left_knee", "walking_1"):
        assert f"'{part}'" in text


def test_two_writings_are_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first", "second"):
        write_log(*visit(), tmp_path / name)
        time.sleep(0.002)  # the clock must have moved on for the bytes to differ
    assert (tmp_path / "first").read_bytes() == (tmp_path / "second").read_bytes()


def test_the_layout_is_in_one_order_however_rerun_gives_its_parts(tmp_path: Path) -> None:
    reader = RrdReader(logged(*visit(), tmp_path))
    chunks = list(reader.stream(store=reader.blueprints()[0]))
    assert len({chunk.entity_path for chunk in chunks}) < len(chunks)  # one place has several
    names = [
        [(chunk.entity_path, chunk.to_record_batch().schema.names) for chunk in rerun_log.in_order(given)]
        for given in (chunks, chunks[::-1])
    ]
    assert names[0] == names[1]


def test_no_name_and_no_path_is_inside(tmp_path: Path) -> None:
    path = logged(*visit(), tmp_path)
    reader = RrdReader(path)
    stores = [*reader.recordings(), *reader.blueprints()]
    text = "".join(c.format(width=10_000) for store in stores for c in reader.stream(store=store))
    for hidden in ("iller", "serial", tmp_path.name, "tmp"):
        assert hidden not in text
        assert hidden.encode() not in path.read_bytes()


def test_a_session_without_joints_or_recordings_is_a_log_all_the_same(tmp_path: Path) -> None:
    session, _ = visit()
    nothing = Analysis(Method.ROBUST, False, (), ())
    write_log(session, nothing, tmp_path / "raw.rrd")
    assert len(curve(tmp_path / "raw.rrd", "/raw/left_thigh/specific_force", "walking_1")[0]) == 50
    write_log(replace(session, recordings=()), nothing, tmp_path / "empty.rrd")
    assert len(RrdReader(tmp_path / "empty.rrd").blueprints()) == 1


def test_an_unwritable_file_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="missing"):
        write_log(*visit(), tmp_path / "missing" / "session.rrd")


WALKED = session_of(SHORT_WALK)


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Analysis]:
    """Log and tables of a simulated walk, in one folder."""
    folder = tmp_path_factory.mktemp("walk")
    session, analysis = WALKED, analysis_of(WALKED)
    write_log(session, analysis, folder / "session.rrd")
    write_gait(analysis.recordings[0], folder)
    return folder, analysis


def words(path: Path, entity: str, component: str, timeline: str = "walking_1") -> list[tuple[float, str]]:
    """Read time, seconds, and word of every row of one entity, in order of time."""
    chunks = [c for c in chunks_of(path) if c.entity_path == entity and timeline in c.timeline_names]
    batches = [c.to_record_batch() for c in chunks]
    times = [ns / 1e9 for batch in batches for ns in batch.column(timeline).cast("int64").to_pylist()]
    found = [row[0] for b in batches for row in b.column(component).to_pylist()]
    return sorted(zip(times, found, strict=True), key=lambda row: row[0])


@pytest.mark.parametrize("side", Side)
def test_the_events_are_those_of_the_table(walk: tuple[Path, Analysis], side: Side) -> None:
    folder, _ = walk
    found = words(folder / "session.rrd", f"/events/{side}", "TextLog:text")
    with (folder / "events.csv").open(newline="") as file:
        reported = [(float(row["time_s"]), row["event"]) for row in csv.DictReader(file) if row["side"] == side]
    assert len(reported) > 15
    assert [event for _, event in found] == [event for _, event in reported]
    assert [time_s for time_s, _ in found] == pytest.approx([time_s for time_s, _ in reported], abs=1e-5)


@pytest.mark.parametrize("side", Side)
def test_at_each_sample_the_lane_is_in_the_phase_of_the_walk(walk: tuple[Path, Analysis], side: Side) -> None:
    folder, analysis = walk
    found = words(folder / "session.rrd", f"/phases/{side}", "StateChange:state")
    recording = analysis.recordings[0]
    at = np.searchsorted([time_s for time_s, _ in found], recording.time_s + 1e-9, side="right") - 1
    assert [found[k][1] for k in at] == [str(PHASES[k]) for k in recording.gait[side].phase]
    assert {word for _, word in found} == {str(phase) for phase in PHASES}
    assert found[-1][1] == ""  # the lane ends with the last event


def entities(path: Path, timeline: str) -> set[str]:
    return {chunk.entity_path for chunk in chunks_of(path) if timeline in chunk.timeline_names}


@pytest.mark.parametrize("joint", LEG_JOINTS)
def test_the_phases_lie_in_the_axes_of_each_curve_and_below_it(walk: tuple[Path, Analysis], joint: Joint) -> None:
    path, (recording,) = walk[0] / "session.rrd", walk[1].recordings
    lowest_deg = np.nanmin(np.rad2deg(recording.joints[joint].angle_rad))
    for number, phase in enumerate(PHASES[1:], start=1):
        time_s, height_deg = curve(path, f"/angles/{joint}/phases/{phase}", "walking_1")
        begins_s, ends_s, gaps = time_s[::3], time_s[1::3], height_deg[2::3]
        assert np.isnan(gaps).all()  # so that no line joins two stretches
        assert (height_deg[::3] < lowest_deg - 2).all()
        is_inside = (recording.time_s[:, None] >= begins_s) & (recording.time_s[:, None] < ends_s)
        np.testing.assert_array_equal(is_inside.any(axis=1), recording.gait[joint.side].phase == number)
    column = rerun_log.side_views(walk[1], joint.side)
    assert column is not None
    views = [view for view in column.contents if isinstance(view, rrb.View)]
    assert [view.origin for view in views] == [f"/angles/{joint.side}_knee", f"/angles/{joint.side}_ankle"]
    assert [view.name for view in views] == [f"{joint.side} knee: flexion, °", f"{joint.side} ankle: dorsiflexion, °"]
    for view in views:
        legend = view.properties["PlotLegend"]
        assert isinstance(legend, rrb.PlotLegend)
        assert legend.visible is not None
        assert legend.visible.as_arrow_array().to_pylist() == [False]


def test_phases_and_curves_are_in_the_colours_of_their_side(walk: tuple[Path, Analysis]) -> None:
    path = walk[0] / "session.rrd"
    for side in Side:
        full, pale = getattr(DARK, side), getattr(DARK, f"{side}_soft")
        expected = {"result": full, "phases/loading": full, "phases/foot_flat": pale, "phases/swing": DARK.control}
        for name, colour in expected.items():
            assert look_of(path, f"/angles/{side}_knee/{name}")["SeriesLines:colors"] == opaque(colour)


def test_the_log_opens_at_the_first_contact_of_a_used_stride_and_the_legs_walk(walk: tuple[Path, Analysis]) -> None:
    path, (recording,) = walk[0] / "session.rrd", walk[1].recordings
    used = [gait.strides for gait in recording.gait.values()]
    first_s = min(strides.start_s[strides.is_used].min() for strides in used)
    last_s = max(strides.end_s[strides.is_used].max() for strides in used)
    (layout,) = RrdReader(path).blueprints()
    chunks = [c for c in RrdReader(path).stream(store=layout) if c.entity_path == "/time_panel"]
    stated = {name: value for c in chunks for name, value in c.to_record_batch().to_pydict().items()}
    assert stated["TimePanelBlueprint:timeline"] == [["walking_1_steps"]]
    assert stated["TimePanelBlueprint:play_state"] == [[2]]  # playing
    assert stated["TimePanelBlueprint:loop_mode"] == [[3]]  # all of it, again and again
    times_s = [
        column.cast("int64").to_numpy() / 1e9
        for c in chunks_of(path)
        if "walking_1_steps" in c.timeline_names
        for column in [c.to_record_batch().column("walking_1_steps")]
    ]
    assert min(map(np.min, times_s)) == pytest.approx(first_s, abs=1e-9)
    assert last_s - 0.02 < max(map(np.max, times_s)) <= last_s + 1e-9
    for joint in LEG_JOINTS:
        whole_s, whole_deg = curve(path, f"/angles/{joint}/result", "walking_1")
        time_s, angle_deg = curve(path, f"/angles/{joint}/result", "walking_1_steps")
        is_step = (whole_s >= first_s) & (whole_s <= last_s)
        np.testing.assert_array_equal(time_s, whole_s[is_step])
        np.testing.assert_array_equal(angle_deg, whole_deg[is_step])
    assert {"/legs/left/thigh", "/legs/right/foot"} <= entities(path, "walking_1_steps")


def test_beside_the_first_step_is_the_answer_and_each_leg_has_its_phase(walk: tuple[Path, Analysis]) -> None:
    path, (recording,) = walk[0] / "session.rrd", walk[1].recordings
    first_s = min(gait.strides.start_s[gait.strides.is_used].min() for gait in recording.gait.values())
    ((time_s, text),) = words(path, "/answer", "TextDocument:text", "walking_1_steps")
    assert time_s == pytest.approx(first_s, abs=1e-9)
    assert text == words(path, "/answer", "TextDocument:text")[0][1]
    for side, gait in recording.gait.items():
        rows = words(path, f"/phases/{side}", "StateChange:state", "walking_1_steps")
        assert rows[0][0] == pytest.approx(first_s, abs=0.02)  # and not only once the phase changes
        sample = int(np.searchsorted(recording.time_s, first_s))
        phase = [phase for at_s, phase in rows if at_s <= recording.time_s[sample] + 1e-9][-1]
        assert phase == str(PHASES[gait.phase[sample]])


def test_a_walk_without_a_used_stride_opens_at_its_beginning(tmp_path: Path) -> None:
    chunks = chunks_of(logged(*visit(), tmp_path))
    assert not any("steps" in name for c in chunks for name in c.timeline_names)


def test_certainty_is_a_band_between_its_edges(walk: tuple[Path, Analysis]) -> None:
    path, (recording,) = walk[0] / "session.rrd", walk[1].recordings
    for joint in LEG_JOINTS:
        angle_deg, sd_deg = (np.rad2deg(v) for v in (recording.joints[joint].angle_rad, recording.joints[joint].sd_rad))
        time_s, band_deg = curve(path, f"/angles/{joint}/band", "walking_1")
        np.testing.assert_allclose(time_s, np.repeat(recording.time_s, 2), atol=1e-9)
        np.testing.assert_allclose(band_deg[::2, 0], angle_deg - 2 * sd_deg, atol=1e-9)
        np.testing.assert_allclose(band_deg[1::2, 0], angle_deg + 2 * sd_deg, atol=1e-9)
        look = look_of(path, f"/angles/{joint}/band")
        assert look["SeriesLines:colors"] == opaque(getattr(DARK, f"{joint.side}_soft"))
        assert look["SeriesLines:aggregation_policy"] == [[5]]  # lowest and highest of a pixel: zoomed out it is whole


def test_left_and_right_have_the_same_axis_which_holds_all_that_is_shown(walk: tuple[Path, Analysis]) -> None:
    def axis(view: rrb.View) -> list[float]:
        axis = view.properties["ScalarAxis"]
        assert isinstance(axis, rrb.ScalarAxis)
        assert axis.range is not None
        return [float(end) for end in np.ravel(axis.range.as_arrow_array().to_pylist())]

    columns = [rerun_log.side_views(walk[1], side) for side in Side]
    left, right = ([v for v in c.contents if isinstance(v, rrb.View)] for c in columns if c is not None)
    for one, other, kind in zip(left, right, ("knee", "ankle"), strict=True):
        low, high = axis(one)
        assert axis(other) == [low, high]
        for side in Side:
            for name in ("band", "phases/foot_flat"):
                _, values_deg = curve(walk[0] / "session.rrd", f"/angles/{side}_{kind}/{name}", "walking_1")
                assert low < np.nanmin(values_deg)
                assert np.nanmax(values_deg) < high


def test_no_panel_of_words_is_empty_whatever_recording_is_chosen(walk: tuple[Path, Analysis], tmp_path: Path) -> None:
    ((_, text),) = words(walk[0] / "session.rrd", "/answer", "TextDocument:text", "standing_1")
    assert text == "This recording has no joint angles. Choose a walk below."
    (recording,) = walk[1].recordings
    free = replace(recording, kind=RecordingKind.FREE_MOTION, joints={}, gait={})
    path = logged(WALKED, replace(walk[1], recordings=(free,)), tmp_path)
    texts = [
        c.to_record_batch().to_pydict()["TextDocument:text"][0][0]
        for c in chunks_of(path)
        if c.entity_path == "/answer"
    ]
    assert texts
    assert all(text.strip() for text in texts)
    assert "'/events'" not in layout_of(path)  # there are none
    assert "'/events'" in layout_of(walk[0] / "session.rrd")


def doubtful(analysis: Analysis, joint: Joint = Joint.LEFT_KNEE, **stated: Assessment) -> Analysis:
    """The walk with another verdict of a joint, or of the left leg's timing."""
    (recording,) = analysis.recordings
    verdicts = recording.verdicts
    joints, legs = dict(verdicts.joints), dict(verdicts.legs)
    if "timing" in stated:
        legs[Side.LEFT] = replace(verdicts.leg(Side.LEFT), timing=stated["timing"])
    else:
        joints[joint] = replace(verdicts.joint(joint), **stated)
    return replace(analysis, recordings=(replace(recording, verdicts=replace(verdicts, joints=joints, legs=legs)),))


@pytest.fixture(scope="module")
def doubted(walk: tuple[Path, Analysis], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Logs of the walk with one doubt each, by what is doubted."""
    analysis = walk[1]
    drifts = assess([GateReason("drift", Verdict.CARE, 4.0, 3.0, "deg")])
    few = assess([GateReason("strides", Verdict.NOT_REPORTED, 1, 3)])
    (recording,) = analysis.recordings
    cases = {
        "shape": doubtful(analysis, shape=SIGN),
        "height": doubtful(analysis, height=BAD),
        "sign": doubtful(analysis, sign=SIGN),
        "timing": doubtful(analysis, timing=few),
        "height to be read with care: not grey": doubtful(analysis, height=drifts),
        "an ankle: the foot alone is grey": doubtful(analysis, Joint.RIGHT_ANKLE, height=BAD),
        "a strap slipped": replace(analysis, recordings=(replace(recording, slipped_from_s={Side.RIGHT: 3.25}),)),
    }
    return {case: logged(WALKED, one, tmp_path_factory.mktemp("doubted")) for case, one in cases.items()}


def test_no_lane_where_the_times_or_the_curve_may_not_be_reported(
    walk: tuple[Path, Analysis], doubted: dict[str, Path]
) -> None:
    for path, gone in (
        (walk[0] / "session.rrd", set()),
        (doubted["shape"], {Joint.LEFT_KNEE}),
        (doubted["sign"], {Joint.LEFT_KNEE}),
        (doubted["timing"], {Joint.LEFT_KNEE, Joint.LEFT_ANKLE}),
    ):
        found = entities(path, "walking_1")
        assert {joint for joint in LEG_JOINTS if f"/angles/{joint}/phases/swing" not in found} == gone


def test_beside_the_legs_is_the_answer_with_a_verdict_for_each_joint(walk: tuple[Path, Analysis]) -> None:
    folder, analysis = walk
    ((time_s, text),) = words(folder / "session.rrd", "/answer", "TextDocument:text")
    assert time_s == pytest.approx(WALKED.recordings[-1].imu[Site.LEFT_THIGH].time_s[0])  # there from the beginning
    facts = Facts(AnalysedVisit(WALKED, analysis), analysis.recordings[0])
    headline = headline_of(facts)
    assert text.startswith(f"### {headline.first}\n\n{headline.then}\n")
    for joint in LEG_JOINTS:
        verdict = verdict_word(verdict_of(facts.verdicts.joint(joint)))
        assert f"- **{joint.replace('_', ' ').capitalize()}: {verdict}.**" in text
    assert "grey." not in text
    assert "Strap moved" not in text


def test_the_panel_states_what_is_not_reported_why_and_that_it_is_grey(
    doubted: dict[str, Path], snapshot: SnapshotAssertion
) -> None:
    stated = {}
    for case, path in doubted.items():
        ((_, text),) = words(path, "/answer", "TextDocument:text")
        stated[case] = [line for line in text.splitlines() if line.startswith("- ")]  # of joints and straps
    assert stated == snapshot


def test_from_when_a_strap_slipped_there_is_no_lane(doubted: dict[str, Path]) -> None:
    for joint in (Joint.RIGHT_KNEE, Joint.LEFT_KNEE):
        time_s, _ = curve(doubted["a strap slipped"], f"/angles/{joint}/phases/swing", "walking_1")
        assert (time_s.max() <= 3.26) == (joint is Joint.RIGHT_KNEE)


def test_nobodys_name_is_in_the_panel(walk: tuple[Path, Analysis], tmp_path: Path) -> None:
    called = "walk of Mr Miller"
    *others, last = WALKED.recordings
    session = replace(
        WALKED, recordings=(*others, replace(last, name=called)), patient=Patient(code="Miller"), notes="Miller"
    )
    analysis = replace(walk[1], recordings=(replace(walk[1].recordings[0], name=called),))
    ((_, text),) = words(logged(session, analysis, tmp_path), "/answer", "TextDocument:text")
    assert "iller" not in text


def test_a_view_is_called_not_reported_where_no_walk_shows_its_curve(walk: tuple[Path, Analysis]) -> None:
    not_reported = doubtful(walk[1], shape=BAD)
    free = replace(walk[1].recordings[0], kind=RecordingKind.FREE_MOTION)
    both = replace(not_reported, recordings=(free, *not_reported.recordings))
    assert name_of_view(both, Joint.LEFT_KNEE) == "left knee: not reported"
    assert name_of_view(both, Joint.RIGHT_KNEE) == "right knee: flexion, °"


def ends_of(turns: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Where the far end of a body lies that is drawn upwards and turned by quaternions (x, y, z, w)."""
    x, y, z, w = turns.T
    return lengths[:, None] * np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)


@pytest.mark.parametrize("straight", [(0.0, 0.0, -0.4), (0.0, 0.0, 0.4), (0.3, -0.1, -0.2), (1e-7, 0.0, -0.4)])
def test_a_body_lies_along_its_segment_wherever_that_points(straight: tuple[float, float, float]) -> None:
    ends_m = np.array([[[0.1, 0.2, 0.9], np.add([0.1, 0.2, 0.9], straight)]])
    found = {str(one.component_descriptor()).split(":")[-1]: one for one in rerun_log.bodies(ends_m, 0.05)}
    (turn,) = [one for name, one in found.items() if "quaternions" in name]
    (length,) = [one for name, one in found.items() if "lengths" in name]
    turns, lengths = (np.array(one.as_arrow_array().to_pylist(), dtype=float) for one in (turn, length))
    np.testing.assert_allclose(ends_of(turns.reshape(1, 4), lengths.reshape(1))[0], straight, atol=1e-6)


def test_the_table_of_verdicts_begins_with_the_walk(walk: tuple[Path, Analysis]) -> None:
    free = replace(walk[1].recordings[0], name="free", kind=RecordingKind.FREE_MOTION)
    both = replace(walk[1], recordings=(free, *walk[1].recordings))
    stated = document(both, {"free": "free_motion_1", walk[1].recordings[0].name: "walking_1"})
    assert 0 < stated.index("## walking_1") < stated.index("## free_motion_1")


def test_two_legs_walk_above_the_curves_and_say_that_they_are_drawn(walk: tuple[Path, Analysis]) -> None:
    folder, analysis = walk
    session = WALKED
    legs = draw_legs(session, analysis, analysis.recordings[0])
    path = folder / "session.rrd"
    for side in Side:
        for number, part in enumerate(("thigh", "shank")):
            place = f"/legs/{side}/{part}"
            moving = [c.to_record_batch() for c in chunks_of(path) if c.entity_path == place and not c.is_static]
            in_order = np.argsort(np.concatenate([b.column("walking_1").cast("int64") for b in moving]))
            found = {
                name: np.array([row[0] for b in moving for row in b.column(f"Capsules3D:{name}").to_pylist()])[in_order]
                for name in ("translations", "lengths", "quaternions", "radii")
            }
            np.testing.assert_allclose(found["translations"], legs[side].leg_m[:, number], atol=1e-6)
            ends_m = found["translations"] + ends_of(found["quaternions"], found["lengths"])
            np.testing.assert_allclose(ends_m, legs[side].leg_m[:, number + 1], atol=1e-5)
            assert (found["radii"] > 0.03).all()  # bodies, not sticks
            assert look_of(path, place)["Capsules3D:colors"] == opaque(getattr(DARK, side))
    first = next(iter(rerun_log._blueprint(session, analysis, None).root_container.contents))
    assert isinstance(first, rrb.Vertical)
    above, curves = list(first.contents)
    assert isinstance(above, rrb.Horizontal)
    view, answer = list(above.contents)
    assert isinstance(view, rrb.Spatial3DView)
    assert isinstance(answer, rrb.TextDocumentView)
    assert answer.origin == "/answer"
    assert answer.name == "SIMULATED. Answer"
    assert view.name == "SIMULATED. Legs: drawn, not measured"
    assert isinstance(curves, rrb.Horizontal)
    text = text_of(path, "/about_legs")
    assert "drawn, not measured" in text
    assert "1.70 m, which nobody typed" in text


def test_a_leg_is_grey_where_an_angle_that_bends_it_is_no_pose(walk: tuple[Path, Analysis], tmp_path: Path) -> None:
    doubted = doubtful(doubtful(walk[1], height=BAD), Joint.RIGHT_ANKLE, sign=SIGN)
    path = logged(WALKED, doubted, tmp_path)
    chunks = chunks_of(path)
    drawn = {c.entity_path for c in chunks if "walking_1" in c.timeline_names and c.entity_path.startswith("/legs")}
    assert drawn == {
        *(f"/legs/left/withheld_{part}" for part in ("thigh", "shank", "foot")),
        *("/legs/right/thigh", "/legs/right/shank", "/legs/right/withheld_foot"),
    }
    for name in drawn:
        assert (look_of(path, name)["Capsules3D:colors"] == opaque(DARK.control)) == ("withheld" in name)


@pytest.mark.endurance
def test_rerun_itself_finds_the_file_whole(walk: tuple[Path, Analysis], tmp_path: Path) -> None:
    session, _ = visit()
    write_log(replace(session, recordings=()), Analysis(Method.ROBUST, False, (), ()), tmp_path / "empty.rrd")
    settings = tmp_path / "settings"  # of its own, so that nothing is asked for and nobody reported
    quiet = os.environ | {"XDG_CONFIG_HOME": str(settings), "APPDATA": str(settings), "HOME": str(settings)}
    for arguments in (["analytics", "disable"], ["rrd", "verify", walk[0] / "session.rrd", tmp_path / "empty.rrd"]):
        done = subprocess.run([sys.executable, "-m", "rerun", *arguments], env=quiet, capture_output=True, check=False)
        assert done.returncode == 0, done.stderr.decode()
    assert b"2 files verified without error" in done.stdout + done.stderr
