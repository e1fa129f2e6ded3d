"""Log for looking at a session again, sample by sample. One Rerun log of what was measured and what was computed.

Every recording is a timeline of its own, named by its kind and number (`walking_1`); choosing another timeline shows
another recording in the same views. The steps of a walk are one beside it, where the log opens (`steps_timeline`).
Nothing is left out between samples, and nobody's words are inside. Above the curves two legs walk, which are drawn and
say so, and beside them is the answer with a verdict for each joint (`answer_panel`). Every verdict is in a view of its
own, and what may not be read is not shown until it is looked for (`may_be_read`).

The same session gives the same bytes: Rerun numbers its chunks and rows by the clock and by chance, so they are
numbered here, and `rrd_file` does the rest.
"""

import tempfile
import uuid
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain, count
from pathlib import Path

import numpy as np
import pyarrow as pa
import rerun as rr
import rerun.blueprint as rrb
from rerun import ComponentColumnList
from rerun.chunk import Chunk, RrdReader
from rerun_bindings import PyMemorySinkStorage, new_blueprint, save

from app.review.answer_panel import NOTHING, panel
from app.review.data_quality_panel import Place, document, is_pose, name_of_view, pieces_of, places, shown_deg
from app.review.phase_lane import lanes_of
from app.review.rrd_file import remove_chance
from app.review.same_axes import BAND_SD, range_of
from app.review.steps_timeline import steps_name, steps_of, with_steps
from app.summary.drawn_legs import (
    HALF_WIDTHS_M,
    HIPS,
    SHANK,
    THIGH,
    DrawnLeg,
    draw_legs,
    draw_pelvis,
    height_of,
    how_drawn,
)
from app.summary.events import events_of
from app.theme.colours import DARK
from app.wording.translation import tr
from core.body import Joint, JointKind, Side, Site, ankle_of, knee_of
from core.gait.phases import PHASES, Phase
from core.hip.results import PelvisAngles
from core.results import Analysis, JointAngle, RecordingAnalysis
from core.samples import FloatArray, ImuBlock, IntArray
from core.session import RecordingKind, Session
from core.video.clip import Clip

APPLICATION = "gaitwright"
RECORDING = "session"
BLUEPRINT = b"rec_" + b"0" * 32  # as long as the name that Rerun draws by chance, so it can take its place
FRAMES_PER_CHUNK = 30  # about 2 MB
ROWS_PER_CHUNK = 100_000  # 4 MB of three axes with their times
BAND_PX = 3.0  # of the stroke that goes to and fro between its edges, once a sample
LEGS_HEIGHT, CURVES_HEIGHT = 2, 3  # shares of the layout
LEGS_WIDTH, PANEL_WIDTH = 2, 3
COLOURS = DARK  # the viewer is dark unless its user turns that
SIDE_COLOUR = {Side.LEFT: COLOURS.left, Side.RIGHT: COLOURS.right}
PALE_COLOUR = {Side.LEFT: COLOURS.left_soft, Side.RIGHT: COLOURS.right_soft}
LANE_PX = {Phase.LOADING: 7.0, Phase.FOOT_FLAT: 7.0, Phase.PRE_SWING: 3.0, Phase.SWING: 1.0}  # wide
RADII_M = {part: sum(ends) / 2 for part, ends in zip(("thigh", "shank", "foot"), HALF_WIDTHS_M, strict=True)}
HIP_RADIUS_M = 0.03
DRAWN = "Legs: drawn, not measured"


def write_log(session: Session, analysis: Analysis, path: Path, clips: Sequence[Clip] = ()) -> None:
    """Write raw signals, angles, certainty, phases, events and a layout as a Rerun log; raises OSError.

    Of `clips` those of kept recordings that are synchronised; without any the bytes are what they were.
    """
    path.touch()  # Rerun reports an unwritable file in its own words, and not always
    timelines = _timelines(session)
    steps = {timelines[r.name]: found for r in analysis.recordings if (found := steps_of(r)) is not None}
    first = next(iter(timelines.values()), None)
    clips = [clip for clip in clips if clip.is_synchronised and clip.recording in timelines]
    layout, layout_name = _layout(session, analysis, steps_name(first) if first in steps else first, clips)
    log = rr.RecordingStream(APPLICATION, recording_id=RECORDING, send_properties=False)
    save(str(path), layout, log.to_native())
    waiting_rows = 0
    batches = (
        part
        for chunk in chain(_chunks(session, analysis, timelines), _frame_chunks(clips, timelines))
        for part in with_steps(chunk.entity_path, chunk.to_record_batch(), steps)
    )
    for number, batch in enumerate(batches, start=1):
        rr.send_chunks(_numbered(batch, number), recording=log)
        waiting_rows += batch.num_rows
        if waiting_rows >= ROWS_PER_CHUNK:  # or the chunks would pile up in memory
            log.flush()
            waiting_rows = 0
    log.disconnect()
    remove_chance(path, layout_name, BLUEPRINT)


def _timelines(session: Session) -> dict[str, str]:
    """Name every kept recording's timeline by kind and number, because its own name may be anything."""
    numbers = {kind: count(1) for kind in RecordingKind}
    named = {r.name: f"{r.kind}_{next(numbers[r.kind])}" for r in session.recordings if r.is_kept}
    return dict(sorted(named.items(), key=lambda item: not item[1].startswith(RecordingKind.WALKING)))


def _chunks(session: Session, analysis: Analysis, timelines: dict[str, str]) -> Iterator[Chunk]:
    yield from _labels(session, analysis)
    if analysis.recordings:
        yield _document("/may_be_read", document(analysis, timelines), rr.MediaType.MARKDOWN)
    for recording in session.recordings:
        for site in recording.imu if recording.is_kept else ():
            yield from _raw_chunks(timelines[recording.name], site, recording.imu[site])
    for recording in session.recordings:
        if recording.is_kept and recording.name not in {analysed.name for analysed in analysis.recordings}:
            starts_s = [block.time_s[0] for block in recording.imu.values() if len(block.time_s)]
            yield from _panel_chunk(timelines[recording.name], starts_s, tr(NOTHING))
    for analysed in analysis.recordings:
        legs = draw_legs(session, analysis, analysed)
        text = panel(session, analysis, analysed, legs)
        raw = [block.time_s for r in session.recordings if r.name == analysed.name for block in r.imu.values()]
        starts_s = [time_s[0] for time_s in (analysed.time_s, *raw) if len(time_s)]
        yield from _panel_chunk(timelines[analysed.name], starts_s, text)
        for joint in analysed.measured:
            yield from _angle_chunks(timelines[analysed.name], joint, analysed)
            yield from _lane_chunks(timelines[analysed.name], joint, analysed)
        for side, leg in legs.items():
            yield from _leg_chunks(timelines[analysed.name], side, leg, analysed)
        yield from _pelvis_chunks(timelines[analysed.name], session, analysed)
        for side, gait in analysed.gait.items():
            yield from _phase_chunk(timelines[analysed.name], side, analysed.time_s, gait.phase)
            yield from _event_chunk(timelines[analysed.name], side, analysed)


def _frame_chunks(clips: Sequence[Clip], timelines: Mapping[str, str]) -> Iterator[Chunk]:
    """Yield the frames of each clip as they are stored; one that is damaged is left out."""
    for clip in clips:
        for start in range(0, len(clip.stamped_s), FRAMES_PER_CHUNK):
            jpegs = {}
            for number in range(start, min(start + FRAMES_PER_CHUNK, len(clip.stamped_s))):
                with suppress(OSError):
                    jpegs[number] = clip.pictures.jpeg(number)
            if not jpegs:
                continue
            columns = rr.EncodedImage.columns(blob=list(jpegs.values()), media_type=["image/jpeg"] * len(jpegs))
            index = rr.TimeColumn(timelines[clip.recording], duration=clip.time_s[list(jpegs)])
            yield Chunk.from_columns(_camera(clip.camera), indexes=[index], columns=columns)


def _camera(number: int) -> str:
    return f"/video/camera_{number}"


def _labels(session: Session, analysis: Analysis) -> Iterator[Chunk]:
    for site in _sites(session):
        yield _label(f"/raw/{site}/angular_rate", [f"{axis} rad/s" for axis in "xyz"])
        yield _label(f"/raw/{site}/specific_force", [f"{axis} m/s²" for axis in "xyz"])
    for joint in _joints(analysis):
        looks = {"result": (SIDE_COLOUR[joint.side], 2.5), "published": (COLOURS.ink2, 1.0)}
        for place in places(analysis, joint):
            grey = COLOURS.control if place is Place.NOT_REPORTED else None
            looks |= {"orientation": (COLOURS.control, 1.0)}
            for curve, (colour, width) in list(looks.items())[: 1 if joint.is_hip else None]:
                yield _label(place.entity(joint, curve), [f"{curve}{place} °"], grey or colour, width)
            names = [f"2 sd below{place} °", f"2 sd above{place} °"]
            yield _label(place.entity(joint, "certainty"), names, grey or PALE_COLOUR[joint.side])
            yield _band_label(place.entity(joint, "band"), f"within 2 sd{place} °", grey or PALE_COLOUR[joint.side])
        for phase, width in LANE_PX.items():
            yield _label(_lane(joint, phase), [phase.replace("_", " ")], _phase_colour(joint.side, phase), width)
    if _has_pelvis(analysis):
        for name, sign in {"tilt": "forward", "obliquity": "left up", "rotation": "to the left"}.items():
            yield _label(f"/pelvis/{name}", [f"{name}, {sign} +, °"], width=2.0)
        looks_of = rr.LineStrips3D.columns(colors=[_rgba(COLOURS.ink2)], radii=[HIP_RADIUS_M / 2])
        yield Chunk.from_columns("/legs/pelvis", indexes=[], columns=looks_of)
    words = [str(phase) for phase in PHASES if phase]
    for side in _sides_with_gait(analysis):
        columns = rr.StateConfiguration.columns(
            values=words,
            labels=[word.replace("_", " ") for word in words],
            colors=np.array([_rgba(_phase_colour(side, phase)) for phase in PHASES if phase], dtype=np.uint32),
        )
        yield Chunk.from_columns(f"/phases/{side}", indexes=[], columns=columns.partition([len(words)]))
    if analysis.is_simulated:
        yield _document("/simulated", "SIMULATED: nobody was measured.")
    sides = _sides_with_knee(analysis)
    if sides:
        yield from _leg_labels(session, sides, has_pelvis=_has_pelvis(analysis))


def _label(entity: str, names: list[str], colour: str | None = None, width: float = 1.0) -> Chunk:
    n = len(names)
    columns = rr.SeriesLines.columns(
        names=names,
        colors=None if colour is None else [_rgba(colour)] * n,
        widths=None if colour is None else [width] * n,
    )
    return Chunk.from_columns(entity, indexes=[], columns=columns.partition([n]))


def _band_label(entity: str, name: str, colour: str) -> Chunk:
    """Give the looks of a band: where a pixel is of several samples, it keeps the lowest and the highest."""
    columns = rr.SeriesLines.columns(
        names=[name],
        colors=[_rgba(colour)],
        widths=[BAND_PX],
        aggregation_policy=rr.components.AggregationPolicy.MinMax,
    )
    return Chunk.from_columns(entity, indexes=[], columns=columns)


def _rgba(colour: str) -> int:
    return int(f"{colour.removeprefix('#')}FF", 16)


def _document(entity: str, text: str, media_type: rr.MediaType = rr.MediaType.TEXT) -> Chunk:
    columns = rr.TextDocument.columns(text=[text], media_type=[media_type])
    return Chunk.from_columns(entity, indexes=[], columns=columns)


def _leg_labels(session: Session, sides: list[Side], *, has_pelvis: bool) -> Iterator[Chunk]:
    """Yield the line between the hips, how each leg looks, and how all of it is drawn."""
    height_m = height_of(session)
    aside_m, up_m = HIPS * height_m / 2, (THIGH + SHANK) * height_m
    hips = rr.LineStrips3D.columns(
        strips=np.array([[[0.0, aside_m, up_m], [0.0, -aside_m, up_m]]], dtype=np.float32),
        colors=[_rgba(COLOURS.control)],
        radii=[HIP_RADIUS_M / 2],
    )
    if not has_pelvis:
        yield Chunk.from_columns("/legs/hips", indexes=[], columns=hips)
    for side in sides:
        colours = [_rgba(SIDE_COLOUR[side])]
        for part in RADII_M:
            for name, colour in ((part, colours), (f"withheld_{part}", [_rgba(COLOURS.control)])):
                looks = rr.Capsules3D.columns(colors=colour, fill_mode=[rr.components.FillMode.Solid])
                yield Chunk.from_columns(f"/legs/{side}/{name}", indexes=[], columns=looks)
        hip_m = (0.0, aside_m if side is Side.LEFT else -aside_m, up_m)
        letter = rr.Points3D.columns(
            positions=[hip_m], colors=colours, radii=[HIP_RADIUS_M], labels=[side.letter], show_labels=[True]
        )
        yield Chunk.from_columns(f"/legs/{side}/hip", indexes=[], columns=letter)
    yield _document("/about_legs", how_drawn(session, has_pelvis=has_pelvis))


def _leg_chunks(timeline: str, side: Side, leg: DrawnLeg, recording: RecordingAnalysis) -> Iterator[Chunk]:
    """Yield the bodies of a leg at each frame, grey where it is no pose; nothing is drawn where it is not known."""
    index = rr.TimeColumn(timeline, duration=leg.time_s)
    is_bent = is_pose(recording, knee_of(side), leg.time_s)
    is_lifted = is_bent & is_pose(recording, ankle_of(side), leg.time_s)
    ends_m = {"thigh": leg.leg_m[:, :2], "shank": leg.leg_m[:, 1:], "foot": leg.foot_m}
    for part, points_m in ends_m.items():
        is_reported = is_lifted if part == "foot" else is_bent
        is_known = np.isfinite(points_m).all(axis=(1, 2))
        for name, is_here in ((part, is_known & is_reported), (f"withheld_{part}", is_known & ~is_reported)):
            if is_here.any():
                columns = bodies(points_m[is_here], RADII_M[part])
                yield Chunk.from_columns(
                    f"/legs/{side}/{name}", indexes=[index], columns=columns.partition(is_here.astype(np.int64))
                )


def _pelvis_chunks(timeline: str, session: Session, recording: RecordingAnalysis) -> Iterator[Chunk]:
    """Yield the pelvis between the legs, and its angles, where it may be read; nothing without a sensor on it."""
    if (drawn := draw_pelvis(session, recording)) is not None:
        time_s, points_m = drawn
        strips = rr.LineStrips3D.columns(strips=points_m.astype(np.float32))
        yield Chunk.from_columns("/legs/pelvis", [rr.TimeColumn(timeline, duration=time_s)], columns=strips)
    if recording.pelvis is not None and recording.verdicts.pelvis.is_reported:
        for name, values_rad in _pelvis_angles(recording.pelvis).items():
            yield from _series(f"/pelvis/{name}", timeline, recording.time_s, np.rad2deg(values_rad))


def _pelvis_angles(pelvis: PelvisAngles) -> dict[str, FloatArray]:
    return {"tilt": pelvis.tilt_rad, "obliquity": pelvis.obliquity_rad, "rotation": pelvis.rotation_rad}


def bodies(ends_m: FloatArray, radius_m: float) -> ComponentColumnList:
    """Capsules from the first to the second of two points (n, 2, 3)."""
    along_m = ends_m[:, 1] - ends_m[:, 0]
    length_m = np.linalg.norm(along_m, axis=1)
    x, y, z = (along_m / length_m[:, None]).T
    # the least turn that takes up (0, 0, 1), along which a capsule lies, to the segment; straight down is half a turn
    is_down = z < -1 + 1e-9
    turn = np.stack([np.where(is_down, 1.0, -y), np.where(is_down, 0.0, x), np.zeros_like(x), 1 + z], axis=1)
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return rr.Capsules3D.columns(
        lengths=length_m.astype(np.float32),
        radii=np.full(len(ends_m), radius_m, dtype=np.float32),
        translations=ends_m[:, 0].astype(np.float32),
        quaternions=turn.astype(np.float32),
    )


def _raw_chunks(timeline: str, site: Site, block: ImuBlock) -> Iterator[Chunk]:
    yield from _series(f"/raw/{site}/angular_rate", timeline, block.time_s, block.gyr_rad_s)
    yield from _series(f"/raw/{site}/specific_force", timeline, block.time_s, block.acc_m_s2)


def _angle_chunks(timeline: str, joint: Joint, recording: RecordingAnalysis) -> Iterator[Chunk]:
    """Yield a joint's curves, placed as what may be reported about them allows; a shape has its mean taken away."""
    angle, time_s = recording.measured[joint], recording.time_s
    band_rad = angle.angle_rad[:, None] + BAND_SD * angle.sd_rad[:, None] * np.array([-1.0, 1.0])
    curves: dict[str, FloatArray | None] = {"result": angle.angle_rad}
    if isinstance(angle, JointAngle):
        curves |= {"published": angle.published_rad, "orientation": angle.orientation_rad}
    for curve, values_rad in (curves | {"certainty": band_rad}).items():
        for place, rows in pieces_of(recording, joint):
            if values_rad is not None:
                values_deg = shown_deg(place, values_rad[rows])
                yield from _series(place.entity(joint, curve), timeline, time_s[rows], values_deg)
                if curve == "certainty":  # Rerun fills nothing: a stroke from edge to edge at each sample does
                    to_and_fro = np.repeat(time_s[rows], 2), values_deg.ravel()
                    yield from _series(place.entity(joint, "band"), timeline, *to_and_fro)


def _lane_chunks(timeline: str, joint: Joint, recording: RecordingAnalysis) -> Iterator[Chunk]:
    """Yield the phases as a lane below a joint's curve, in its own axes, so that they cannot come apart."""
    for phase, (time_s, height_deg) in lanes_of(recording, joint).items():
        yield from _series(_lane(joint, phase), timeline, time_s, height_deg)


def _lane(joint: Joint, phase: Phase) -> str:
    return f"/angles/{joint}/phases/{phase}"


def _phase_colour(side: Side, phase: Phase) -> str:
    """As in the lanes of the results page: the heel's loading full, the flat foot pale, swing a base line."""
    if phase is Phase.SWING:
        return COLOURS.control
    return PALE_COLOUR[side] if phase is Phase.FOOT_FLAT else SIDE_COLOUR[side]


def _panel_chunk(timeline: str, starts_s: list[float], text: str) -> Iterator[Chunk]:
    """Yield the answer to a recording from its first sample on, raw or computed."""
    if starts_s:
        columns = rr.TextDocument.columns(text=[text], media_type=[rr.MediaType.MARKDOWN])
        index = rr.TimeColumn(timeline, duration=[min(starts_s)])
        yield Chunk.from_columns("/answer", indexes=[index], columns=columns)


def _phase_chunk(timeline: str, side: Side, time_s: FloatArray, phase: IntArray) -> Iterator[Chunk]:
    """Yield each phase at the sample it begins with, as in angles.csv; an empty word ends the lane until the next."""
    begins = np.flatnonzero(np.diff(phase, prepend=-1))
    if len(begins):
        yield Chunk.from_columns(
            f"/phases/{side}",
            indexes=[rr.TimeColumn(timeline, duration=time_s[begins])],
            columns=rr.StateChange.columns(state=[str(PHASES[k]) for k in phase[begins]]),
        )


def _event_chunk(timeline: str, side: Side, recording: RecordingAnalysis) -> Iterator[Chunk]:
    """Yield the events of events.csv; choosing one in the viewer goes to its time."""
    found = [(time_s, event) for time_s, its_side, event in events_of(recording) if its_side is side]
    if found:
        yield Chunk.from_columns(
            f"/events/{side}",
            indexes=[rr.TimeColumn(timeline, duration=[time_s for time_s, _ in found])],
            columns=rr.TextLog.columns(text=[event for _, event in found]),
        )


def _series(entity: str, timeline: str, time_s: FloatArray, values: FloatArray) -> Iterator[Chunk]:
    """Yield values (n,) or (n, k) over time in chunks; a gap stays NaN, at which a line breaks."""
    for start in range(0, len(time_s), ROWS_PER_CHUNK):
        rows = slice(start, start + ROWS_PER_CHUNK)
        yield Chunk.from_columns(
            entity,
            indexes=[rr.TimeColumn(timeline, duration=time_s[rows])],
            columns=rr.Scalars.columns(scalars=values[rows]),
        )


def _sites(session: Session) -> list[Site]:
    return [site for site in Site if any(r.is_kept and site in r.imu for r in session.recordings)]


def _joints(analysis: Analysis) -> list[Joint]:
    return [joint for joint in Joint if any(joint in recording.measured for recording in analysis.recordings)]


def _has_pelvis(analysis: Analysis) -> bool:
    return any(r.pelvis is not None and r.verdicts.pelvis.is_reported for r in analysis.recordings)


def _sides_with_gait(analysis: Analysis) -> list[Side]:
    return [side for side in Side if any(side in recording.gait for recording in analysis.recordings)]


def _sides_with_knee(analysis: Analysis) -> list[Side]:
    return [side for side in Side if any(knee_of(side) in r.joints for r in analysis.recordings)]


def _blueprint(session: Session, analysis: Analysis, timeline: str | None, clips: Sequence[Clip] = ()) -> rrb.Blueprint:
    columns = [column for side in Side if (column := side_views(analysis, side)) is not None]
    simulated, tabs = "SIMULATED. " if analysis.is_simulated else "", list[rrb.Container | rrb.View]()
    if columns:
        name, curves = "Angles and phases", rrb.Horizontal(*columns)
        top: rrb.Container | rrb.View = rrb.TextDocumentView(origin="/answer", name=f"{simulated}Answer")
        cameras = sorted({clip.camera for clip in clips})
        videos = [rrb.Spatial2DView(origin=_camera(number), name=f"Video, camera {number}") for number in cameras]
        legs = [_leg_view(session, analysis)] if _sides_with_knee(analysis) else []
        if videos or legs:
            shares = [LEGS_WIDTH] * len((*legs, *videos)) + [PANEL_WIDTH]
            top = rrb.Horizontal(*legs, *videos, top, column_shares=shares)
        tabs += [rrb.Vertical(top, curves, row_shares=[LEGS_HEIGHT, CURVES_HEIGHT], name=name)]
    if analysis.recordings:
        tabs += [rrb.TextDocumentView(origin="/may_be_read", name="Data quality")]
    if sides := _sides_with_gait(analysis):
        axis = rrb.archetypes.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
        lanes: list[rrb.View] = [
            rrb.StateTimelineView(origin=f"/phases/{s}", name=f"{s} phases", time_view=axis) for s in sides
        ]
        if any(events_of(recording) for recording in analysis.recordings):
            lanes += [rrb.TextLogView(origin="/events", name="events")]
        tabs += [rrb.Vertical(*lanes, name="Phases and events")]
    if _has_pelvis(analysis):
        tabs += [rrb.TimeSeriesView(origin="/pelvis", name="Pelvis: tilt, obliquity, rotation, °")]
    for signal in ("angular_rate", "specific_force"):
        views = [rrb.TimeSeriesView(origin=f"/raw/{s}/{signal}", name=s.replace("_", " ")) for s in _sites(session)]
        tabs += [rrb.Grid(*views, name=signal.replace("_", " ").capitalize(), grid_columns=2)]
    if _sides_with_knee(analysis):
        tabs += [rrb.TextDocumentView(origin="/about_legs", name="How the legs are drawn")]
    layout = rrb.Tabs(*tabs)
    for number, part in enumerate(_parts(layout)):
        part.id = uuid.UUID(int=number + 1)
    # the legs walk as soon as it is open, and again when the last step is done
    time = rrb.TimePanel(timeline=timeline, state="collapsed", play_state="Playing", loop_mode="All")
    return rrb.Blueprint(layout, time, collapse_panels=True)


def _leg_view(session: Session, analysis: Analysis) -> rrb.Spatial3DView:
    """Look at the legs from the patient's right, a little from the front."""
    height_m = height_of(session)
    middle_m = (THIGH + SHANK) * height_m / 2
    return rrb.Spatial3DView(
        origin="/legs",
        name=f"SIMULATED. {DRAWN}" if analysis.is_simulated else DRAWN,
        background=[int(COLOURS.ground[k : k + 2], 16) for k in (1, 3, 5)],
        eye_controls=rrb.EyeControls3D(
            position=(0.37 * height_m, -0.68 * height_m, 0.37 * height_m),
            look_target=(0.0, 0.0, middle_m),
            eye_up=(0.0, 0.0, 1.0),
        ),
    )


def side_views(analysis: Analysis, side: Side) -> rrb.Vertical | None:
    """Stack a side's joints, each with its phases; the answer's panel explains the lines, not a legend."""
    axis = rrb.archetypes.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
    views = [
        rrb.TimeSeriesView(
            origin=f"/angles/{joint}",
            name=name_of_view(analysis, joint),
            axis_x=axis,
            axis_y=rrb.ScalarAxis(range=range_of(analysis, joint.kind)),
            plot_legend=rrb.PlotLegend(visible=False),
        )
        for joint in (kind.of(side) for kind in JointKind)
        if joint in _joints(analysis)
    ]
    return rrb.Vertical(*views, name=str(side)) if views else None


def _parts(part: rrb.Container | rrb.View) -> Iterator[rrb.Container | rrb.View]:
    yield part
    for inner in part.contents if isinstance(part, rrb.Container) else ():
        yield from _parts(inner)


def _layout(
    session: Session, analysis: Analysis, timeline: str | None, clips: Sequence[Clip]
) -> tuple[PyMemorySinkStorage, bytes]:
    """Give the layout as messages that `save` puts before the log, and the name by which they call their store."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "layout.rbl"
        _blueprint(session, analysis, timeline, clips).save(APPLICATION, file)
        reader = RrdReader(file)
        chunks = in_order(reader.stream(store=reader.blueprints()[0]))
    stream = rr.RecordingStream._from_native(new_blueprint(APPLICATION, make_default=False, make_thread_default=False))
    messages = rr.memory_recording(stream)
    rr.send_chunks(
        [_numbered(chunk.to_record_batch(), number) for number, chunk in enumerate(chunks, start=1)], recording=stream
    )
    return messages.storage, str(stream.get_recording_id()).encode()


def in_order(chunks: Iterable[Chunk]) -> list[Chunk]:
    """Sort chunks by their places, and those of one place, which come as chance has it, by their columns."""
    return sorted(chunks, key=lambda chunk: (chunk.entity_path, sorted(chunk.to_record_batch().schema.names)))


def _numbered(batch: pa.RecordBatch, number: int) -> Chunk:
    """Give rows as a chunk with its name and its rows' names made from `number`, and without the time of writing."""
    kept = [i for i, name in enumerate(batch.schema.names) if name not in ("log_time", "log_tick")]
    fields, columns = [batch.schema.field(i) for i in kept], [batch.column(i) for i in kept]
    rows = np.empty((batch.num_rows, 2), dtype=">u8")
    rows[:, 0], rows[:, 1] = number, np.arange(batch.num_rows)
    columns[0] = pa.Array.from_buffers(fields[0].type, batch.num_rows, [None, pa.py_buffer(rows)])
    metadata = dict(batch.schema.metadata) | {b"rerun:id": f"chunk_{number:032X}".encode()}
    same = pa.RecordBatch.from_arrays(columns, schema=pa.schema(fields, metadata))
    return Chunk.from_record_batch(same)[0]
