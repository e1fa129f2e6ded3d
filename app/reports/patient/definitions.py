"""What is measured where: each movement of the table as a bracket on a schematic curve."""

from dataclasses import dataclass

import numpy as np

from app.charts.cycles import PERCENT
from app.charts.drawing import MM, Drawing, Picture
from app.summary.panels import excursion_name
from app.summary.reference_bands import reference_curves
from app.theme.colours import PAPER
from app.wording.translation import tr
from core.parameters import ANKLE_RANGE, KNEE_RANGE
from core.samples import FloatArray
from core.verdicts.quantities import EXCURSIONS_BY_COLUMN

WIDTH, HEIGHT, TOP, FOOT = 85.5 * MM, 35 * MM, 16.0, 14.0
CAP = 2.2
TOE_OFF_PERCENT = 61  # of the schematic walk


@dataclass(frozen=True, slots=True)
class _Place:
    """Where in the picture a bracket is, percent of its width, and its words beside it."""

    percent: float
    anchor: str
    up: float = 0.0  # points, from the middle of the bracket


PLACES = {
    "knee_while_loading_deg": _Place(3, "start", 17),
    "knee_straightening_deg": _Place(28, "middle", -19),
    "knee_stance_to_swing_deg": _Place(52, "end"),
    KNEE_RANGE: _Place(104, "start"),
    "ankle_heel_rocker_deg": _Place(3, "start", -21),
    "ankle_rocker_deg": _Place(28, "start", 2),
    "ankle_push_off_deg": _Place(54, "end", -22),
    "ankle_toes_lifted_deg": _Place(76, "start", -4),
    ANKLE_RANGE: _Place(104, "start"),
}


def definitions(kind: str) -> Picture:
    """The movements of a joint on the mean curve of the cited group, without axes: only where each is."""
    group = reference_curves()
    angle_deg, _ = group.mean_and_sd_deg(kind)
    low, high = float(angle_deg.min()), float(angle_deg.max())

    def x(percent: float) -> float:
        return 6 + (WIDTH - 44) * percent / 100

    def y(value: float) -> float:
        return HEIGHT - FOOT - (HEIGHT - FOOT - TOP) * (value - low) / (high - low)

    across = np.array([x(float(percent)) for percent in PERCENT])
    up = np.array([y(float(value)) for value in angle_deg])
    draw = Drawing()
    draw.text(0, 8, tr("Knee") if kind == "knee" else tr("Ankle"), 7.6, weight=600)
    draw.line(x(TOE_OFF_PERCENT), TOP - 4, x(TOE_OFF_PERCENT), HEIGHT - FOOT + 4, PAPER.note, 0.5, "2 2")
    draw.text(x(TOE_OFF_PERCENT), HEIGHT - 2, tr("toe\u2011off"), 6.6, anchor="middle", fill=PAPER.note)
    draw.curve(across, up, PAPER.note, 1.8)
    names = []
    for column, place in PLACES.items():
        if column.startswith(kind):
            name = _label(column)
            names.append(name)
            ends = [(x(percent), y(value)) for percent, value in _ends(column, angle_deg)]
            _draw_bracket(draw, x(place.percent), ends, name, place)
    alt = tr("Schematic curve over 100 % of the gait cycle with brackets: {names}.").format(names=", ".join(names))
    return draw.picture(WIDTH, HEIGHT, alt)


def _label(column: str) -> str:
    """The movement in a word or two, for there is little room: at the ankle, when it is."""
    short = {
        "ankle_heel_rocker_deg": tr("loading"),
        "ankle_rocker_deg": tr("stance"),
        "ankle_push_off_deg": tr("push\u2011off"),
        "ankle_toes_lifted_deg": tr("swing"),
        KNEE_RANGE: tr("ROM"),
        ANKLE_RANGE: tr("ROM"),
    }
    return short.get(column) or excursion_name(column)


def _ends(column: str, angle_deg: FloatArray) -> list[tuple[float, float]]:
    """Percent and angle of the highest and of the lowest point that a movement goes between."""
    if column not in EXCURSIONS_BY_COLUMN:
        return [(float(at), float(angle_deg[at])) for at in (int(np.argmax(angle_deg)), int(np.argmin(angle_deg)))]
    excursion, found = EXCURSIONS_BY_COLUMN[column], []
    for window, pick in ((excursion.high, np.argmax), (excursion.low, np.argmin)):
        first, last = (window.first, window.last) if window is not None else (0, 0)  # at initial contact
        at = first + int(pick(angle_deg[first : last + 1]))
        found.append((float(at), float(angle_deg[at])))
    return found


def _draw_bracket(draw: Drawing, at: float, ends: list[tuple[float, float]], name: str, place: _Place) -> None:
    for px, py in ends:
        draw.line(px, py, at, py, PAPER.ink, 0.5, "0.8 1.6")
    top, bottom = sorted(py for _, py in ends)
    draw.line(at, top, at, bottom, PAPER.ink, 1.2)
    for end in (top, bottom):
        draw.line(at - CAP, end, at + CAP, end, PAPER.ink, 1.2)
    beside = {"start": 5.0, "end": -5.0, "middle": 0.0}[place.anchor]
    draw.text(at + beside, (top + bottom) / 2 + 2.4 - place.up, name, 6.8, anchor=place.anchor)
