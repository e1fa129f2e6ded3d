"""Figures 8 and 9 of an agreement: our angle, the published one and the reference over a few seconds, with gait phases.

Of the walks the one of median error is drawn, neither the best nor the worst. The strip over each panel holds the
phases of the foot: black loading, dark foot flat, light pre-swing, empty swing.
"""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from app.charts.drawing import COLOURS, MM, Drawing, Picture
from app.reports.agreement.printed import side_role
from app.reports.agreement.study import AgreementStudy, AngleKind, ComparedWalk
from app.theme.colours import PAPER
from app.wording.numbers import MINUS
from app.wording.translation import capitalised, later, tr
from core.body import Joint, JointKind
from core.gait.phases import PHASES, Phase
from core.samples import BoolArray, FloatArray, IntArray
from core.session import Patient

WIDTH, PLOT, ERROR = 175 * MM, 96.0, 34.0
LEFT, RIGHT, TITLE, STRIP, GAP, FOOT = 28.0, 6.0, 12.0, 6.0, 8.0, 16.0
LONGEST_S = 6.0  # some five strides, as in the paper's figures
STEP_DEG, ERROR_STEP_DEG, LEAST_ERROR_DEG = 20.0, 5.0, 5.0
FILLS = {
    Phase.LOADING: PAPER.ink,
    Phase.FOOT_FLAT: PAPER.band_1sd_edge,
    Phase.PRE_SWING: PAPER.band_2sd,
    Phase.SWING: PAPER.paper,
}
FIGURES = {  # by the names of their files; the first two as the paper numbers them
    JointKind.KNEE: "figure_8_knee",
    JointKind.ANKLE: "figure_9_ankle",
    JointKind.HIP: "figure_hip",
}
ANGLES = {
    JointKind.KNEE: later("Knee flexion"),
    JointKind.ANKLE: later("Ankle dorsiflexion"),
    JointKind.HIP: later("Hip flexion"),
}
OURS, PUBLISHED, REFERENCE = 1.3, 0.8, 1.1
PUBLISHED_DASH, REFERENCE_DASH = "1.2 1.4", "4.5 2"


Scale = Callable[[FloatArray | float], FloatArray]


def pictures_of(study: AgreementStudy, patient: Patient) -> dict[str, Picture]:
    """Give the figures by the names of their files; none of a kind of joint that was not compared."""
    drawn = {}
    for kind, name in FIGURES.items():
        walk = shown_walk(study, kind)
        if walk is not None:
            drawn[name] = _figure(walk, patient, kind, is_simulated=study.is_simulated)
    return drawn


def shown_walk(study: AgreementStudy, kind: JointKind) -> ComparedWalk | None:
    """Give the walk whose error of these joints is in the middle."""

    def error(walk: ComparedWalk) -> float:
        return float(np.mean([walk.figures[joint, AngleKind.RESULT].m_rad for joint in _joints(walk, kind)]))

    walks = sorted((walk for walk in study.with_angles if _joints(walk, kind)), key=error)
    return walks[(len(walks) - 1) // 2] if walks else None


def _joints(walk: ComparedWalk, kind: JointKind) -> list[Joint]:
    return [joint for joint in Joint if joint.kind is kind and (joint, AngleKind.RESULT) in walk.figures]


def _figure(walk: ComparedWalk, patient: Patient, kind: JointKind, *, is_simulated: bool) -> Picture:
    joints = _joints(walk, kind)
    shown = _seconds(walk, joints)
    draw, top, alts = Drawing(), 0.0, []
    for joint in joints:
        m_deg = math.degrees(walk.figures[joint, AngleKind.RESULT].m_rad)
        title = tr("{joint}, {side}: {m:.2f}° RMSE, mean removed").format(
            joint=tr(ANGLES[kind]),
            side=side_role(joint.side, patient),
            m=m_deg,
        )
        draw.text(0, top + 8, (tr("SIMULATED. ") if is_simulated else "") + title, 7.6, weight=600)
        _draw_panel(draw, walk, joint, shown, top + TITLE)
        top += TITLE + STRIP + PLOT + GAP + ERROR + FOOT
        alts.append(title)
    return draw.picture(WIDTH, top, ". ".join([*alts, walk.recording.name]) + ".")


def _seconds(walk: ComparedWalk, joints: Sequence[Joint]) -> BoolArray:
    """The instants drawn: the middle of what both systems saw."""
    both = np.any([np.isfinite(walk.reference_rad[joint]) for joint in joints], axis=0)
    time_s = walk.recording.time_s
    first_s, last_s = time_s[both][0], time_s[both][-1]
    middle_s = 0.5 * (first_s + last_s)
    return np.asarray(
        (time_s >= max(first_s, middle_s - LONGEST_S / 2)) & (time_s <= min(last_s, middle_s + LONGEST_S / 2))
    )


def _draw_panel(draw: Drawing, walk: ComparedWalk, joint: Joint, shown: BoolArray, top: float) -> None:
    time_s = walk.recording.time_s[shown]
    ours = np.rad2deg(walk.recording.measured[joint].angle_rad[shown])
    reference = np.rad2deg(walk.reference_rad[joint][shown])
    start_s, last_s = float(time_s[0]), float(time_s[-1])

    def x(at_s: FloatArray | float) -> FloatArray:
        return LEFT + (WIDTH - LEFT - RIGHT) * (np.asarray(at_s) - start_s) / (last_s - start_s)

    if joint.side in walk.recording.gait:
        _draw_strip(draw, time_s, walk.recording.gait[joint.side].phase[shown], x, top)
    _draw_axis(draw, top + STRIP, PLOT, _limits([ours, reference], STEP_DEG), STEP_DEG)
    y = _scale(top + STRIP, PLOT, _limits([ours, reference], STEP_DEG))
    if joint in walk.recording.joints:  # a hip has none
        published = np.rad2deg(walk.recording.joints[joint].published_rad[shown])
        draw.curve(x(time_s), y(published), PAPER.note, PUBLISHED, PUBLISHED_DASH)
    draw.curve(x(time_s), y(ours), COLOURS[joint.side], OURS)
    draw.curve(x(time_s), y(reference), PAPER.ink, REFERENCE, REFERENCE_DASH)
    error = ours - reference - np.nanmean(ours - reference)
    under = top + STRIP + PLOT + GAP
    low, high = _limits([error, np.array([-LEAST_ERROR_DEG, LEAST_ERROR_DEG])], ERROR_STEP_DEG)
    _draw_axis(draw, under, ERROR, (low, high), max(ERROR_STEP_DEG, high - low))
    draw.curve(x(time_s), _scale(under, ERROR, (low, high))(error), COLOURS[joint.side], OURS)
    for at_s in np.arange(math.ceil(start_s), last_s + 1e-9):
        draw.text(float(x(at_s)), under + ERROR + 9, f"{at_s:.0f}", 6.6, anchor="middle")
    draw.text(WIDTH - RIGHT, under + ERROR + 9, tr("s"), 6.6)


def _draw_strip(draw: Drawing, time_s: FloatArray, phase: IntArray, x: Scale, top: float) -> None:
    edges = np.concatenate([[0], np.nonzero(np.diff(phase))[0] + 1, [len(phase) - 1]])
    for first, last in pairwise(edges.tolist()):
        kind = PHASES[int(phase[first])]
        left, right = float(x(time_s[first])), float(x(time_s[last]))
        if kind in FILLS:
            draw.box(left, top, right - left, STRIP - 1.5, FILLS[kind], PAPER.ink, 0.3)
        if first:
            draw.line(left, top, left, top + STRIP + PLOT + GAP + ERROR, PAPER.grid, 0.4)


def _limits(curves: Sequence[FloatArray], step: float) -> tuple[float, float]:
    known = np.concatenate([values[np.isfinite(values)] for values in curves])
    return step * math.floor(known.min() / step), step * math.ceil(known.max() / step)


def _scale(top: float, height: float, limits: tuple[float, float]) -> Scale:
    """Degrees to points, y downwards."""
    low, high = limits
    return lambda angle_deg: np.asarray(top + height * (high - np.asarray(angle_deg)) / (high - low))


def _draw_axis(draw: Drawing, top: float, height: float, limits: tuple[float, float], step: float) -> None:
    y = _scale(top, height, limits)
    for value in np.arange(limits[0], limits[1] + step / 2, step):
        draw.line(LEFT, float(y(value)), WIDTH - RIGHT, float(y(value)), PAPER.grid, 0.4)
        draw.text(LEFT - 4, float(y(value)) + 2.4, f"{value:.0f}°".replace("-", MINUS), 6.6, anchor="end")


def caption(study: AgreementStudy, kind: JointKind) -> str:
    """What the curves of a figure are."""
    walk = shown_walk(study, kind)
    name = "" if walk is None else walk.recording.name
    if kind is JointKind.HIP:
        return tr(
            "{walk}, the walk with the median error. Coloured line: angle from this program. Long dashes: "
            "reference, matched in time and sign. Below: program minus reference, mean removed. Strip of "
            "gait phases: loading (black), foot flat, pre-swing, swing (white)."
        ).format(walk=capitalised(name))
    return tr(
        "{walk}, the walk with the median error. Coloured line: angle from this program. Long dashes: "
        "reference, matched in time and sign. Dots: published fusion (eq 15), same axes. Below: "
        "program minus reference, mean removed. Strip of gait phases: loading (black), foot flat, "
        "pre-swing, swing (white)."
    ).format(walk=capitalised(name))
