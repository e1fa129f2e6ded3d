"""Pictures of the patient letter: a leg that swings through, a way walked in a second, a goal bar."""

import math
from dataclasses import dataclass

from app.charts.drawing import COLOURS, MM, Drawing, Picture
from app.theme.colours import PAPER
from core.body import Side

WIDTH, HEIGHT = 162 * MM, 84 * MM
BAR_HEIGHT, BAR_AT, BAR = 20 * MM, 6 * MM, 3.2 * MM
HIP, FLOOR = (59 * MM, 7 * MM), 80 * MM
THIGH, SHANK, FOOT, HEEL = 32.0 * MM, 30.0 * MM, 15.0 * MM, 3.0 * MM
HALF = {"thigh": (6.2 * MM, 4.0 * MM), "shank": (3.9 * MM, 2.7 * MM), "foot": (2.9 * MM, 1.8 * MM)}
LEAN_DEG = 21.0  # of the thigh, forward, when the leg swings through
FILLED = {Side.LEFT: PAPER.left_soft, Side.RIGHT: PAPER.paper}
LARGE, SMALL, WORD = 36.0, 24.0, 13.5
APART = 18 * MM  # labels of the bar nearer than this share no line


@dataclass(frozen=True, slots=True)
class LetterValue:
    """A value as it is printed, and when it was measured: "53°", "Today"."""

    value: float
    printed: str
    when: str


def leg_picture(side: Side, now: LetterValue, before: LetterValue | None, alt: str) -> Picture:
    """The knee bent by `now` degrees, over the one of an earlier visit, which is dotted."""
    draw = Drawing()
    draw.line(13 * MM, FLOOR, 149 * MM, FLOOR, PAPER.note, 1.2)
    knee = _from(HIP, THIGH, LEAN_DEG)
    if before is not None:
        _draw_shank(draw, knee, before.value, PAPER.earlier, PAPER.note, "2.5 2")
    dash = "4.6 2.2" if side is Side.RIGHT else ""
    _draw_segment(draw, HIP, knee, HALF["thigh"], FILLED[side], COLOURS[side], dash)
    _draw_shank(draw, knee, now.value, FILLED[side], COLOURS[side], dash)
    end = _from(knee, 34 * MM, LEAN_DEG)
    draw.line(*knee, *end, PAPER.ink, 1.2, "4 3")
    _draw_arc(draw, knee, 20 * MM, now.value, 2.2, PAPER.ink)
    if before is not None:
        _draw_arc(draw, knee, 14 * MM, before.value, 1.4, PAPER.note)
        draw.text(100 * MM, 59 * MM, before.printed, SMALL, weight=600, fill=PAPER.note)
        draw.text(100 * MM, 65 * MM, before.when, WORD, fill=PAPER.note)
        draw.line(*_from(knee, 14 * MM, LEAN_DEG - before.value / 2), 98 * MM, 58 * MM, PAPER.note, 0.8)
    draw.circle(*knee, 6, PAPER.paper, PAPER.ink, 2)
    behind = min(knee[0] - 14 * MM, _from(knee, SHANK, LEAN_DEG - now.value)[0] - 9 * MM)
    draw.text(behind, 54 * MM, now.printed, LARGE, anchor="end", weight=600)
    draw.text(behind, 61.5 * MM, now.when, WORD, anchor="end", weight=500)
    return draw.picture(WIDTH, HEIGHT, alt)


def speed_picture(now: LetterValue, before: LetterValue | None, alt: str) -> Picture:
    """How far the patient comes in a second, over how far it was at an earlier visit."""
    longest = max(now.value, before.value if before is not None else 0.0)
    left, most = 13 * MM, 108 * MM
    draw = Drawing()
    draw.line(left, FLOOR, 149 * MM, FLOOR, PAPER.note, 1.2)
    rows = ([(before, 22 * MM)] if before is not None else []) + [(now, 52 * MM)]
    for shown, y in rows:
        is_now = shown is now
        colour, end = PAPER.ink if is_now else PAPER.note, left + most * shown.value / longest
        draw.line(left, y, end, y, colour, 3.0 if is_now else 1.6, "" if is_now else "2.5 2")
        draw.line(left, y - 3 * MM, left, y + 3 * MM, colour, 1.6)
        draw.parts.append(f'<path d="M{end - 8:.2f} {y - 6:.2f}L{end:.2f} {y:.2f}L{end - 8:.2f} {y + 6:.2f}" '
                     f'fill="none" stroke="{colour}" stroke-width="{3.0 if is_now else 1.6}"/>')  # fmt: skip
        draw.text(left, y - 5 * MM, shown.printed, LARGE if is_now else SMALL, weight=600, fill=colour)
        draw.text(left, y + 7.5 * MM, shown.when, WORD, fill=colour)
    return draw.picture(WIDTH, HEIGHT, alt)


def goal_bar(
    now: LetterValue, before: LetterValue | None, goal: LetterValue | None, step: float, side: Side | None, alt: str
) -> Picture:
    """Values on a track, with a tick at the goal where there is one; `step` is what its ends are rounded to."""
    values = [one.value for one in (now, before, goal) if one is not None]
    low = max(0.0, step * math.floor((min(values) - step) / step))
    high = step * math.ceil((max(values) + step / 5) / step)

    def at(value: float) -> float:
        return WIDTH * (value - low) / (high - low)

    middle, colour = BAR_AT + BAR / 2, PAPER.ink if side is None else COLOURS[side]
    draw = Drawing()
    _draw_bar(draw, 0.0, WIDTH, PAPER.track)
    if before is not None:
        ends = sorted((at(before.value), at(now.value)))
        _draw_bar(draw, ends[0], ends[1], PAPER.way if side is not Side.LEFT else FILLED[Side.LEFT])
        _draw_dot(draw, at(before.value), middle, 6.0, PAPER.paper, PAPER.note)
    _draw_dot(draw, at(now.value), middle, 7.5, colour if side is not Side.RIGHT else PAPER.paper, colour)
    if goal is not None:
        draw.line(at(goal.value), middle - 5.5 * MM, at(goal.value), middle + 5.5 * MM, PAPER.ink, 2.4)
    shown = sorted((one for one in (before, now, goal) if one is not None), key=lambda one: one.value)
    rows: list[float] = []
    for one in shown:
        anchor, x = "middle", at(one.value)
        if goal is not None and one is not before and abs(at(goal.value) - at(now.value)) < APART:
            is_left = (one.value, one is goal) < ((now if one is goal else goal).value, one is not goal)
            anchor, x = ("end", x - 2) if is_left else ("start", x + (2 if one is now else 0))
        row = sum(abs(x - other) < APART and anchor == "middle" for other in rows)
        rows.append(x)
        words = f"{one.when} {one.printed.removesuffix('°')}"
        fill = PAPER.note if one is before else PAPER.ink
        x = min(max(x, 12 * MM if anchor == "middle" else 0.0), WIDTH - (12 * MM if anchor == "middle" else 0.0))
        y = middle + 9.5 * MM + row * 5 * MM
        draw.text(x, y, words, 12.5, anchor=anchor, weight=400 if one is before else 500, fill=fill)
    return draw.picture(WIDTH, BAR_HEIGHT, alt)


def _draw_bar(draw: Drawing, start: float, end: float, fill: str) -> None:
    place = f'x="{start:.2f}" y="{BAR_AT:.2f}" width="{end - start:.2f}" height="{BAR:.2f}" rx="{BAR / 2:.2f}"'
    draw.parts.append(f'<rect {place} fill="{fill}"/>')


def _draw_dot(draw: Drawing, x: float, y: float, radius: float, fill: str, edge: str) -> None:
    halo = f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{radius + 1.6:.2f}" fill="{PAPER.paper}"/>'
    draw.parts.append(halo)
    draw.circle(x, y, radius, fill, edge, 2)


def _draw_shank(draw: Drawing, knee: tuple[float, float], knee_deg: float, fill: str, edge: str, dash: str) -> None:
    tilt = LEAN_DEG - knee_deg
    ankle = _from(knee, SHANK, tilt)
    heel, toes = _from(ankle, -HEEL, tilt + 82), _from(ankle, FOOT, tilt + 82)
    _draw_segment(draw, heel, toes, HALF["foot"], fill, edge, dash)
    _draw_segment(draw, knee, ankle, HALF["shank"], fill, edge, dash)


def _draw_segment(
    draw: Drawing,
    start: tuple[float, float],
    end: tuple[float, float],
    half: tuple[float, float],
    fill: str,
    edge: str,
    dash: str,
) -> None:
    """A limb that grows thinner: two half circles and the lines between them."""
    length = math.hypot(end[0] - start[0], end[1] - start[1])
    along = (end[0] - start[0]) / length, (end[1] - start[1]) / length
    across = -along[1], along[0]
    corners = [
        (at[0] + sign * radius * across[0], at[1] + sign * radius * across[1])
        for at, radius, sign in ((start, half[0], 1), (end, half[1], 1), (end, half[1], -1), (start, half[0], -1))
    ]
    ((ax, ay), (bx, by), (cx, cy), (dx, dy)), (r0, r1) = corners, half
    path = (
        f"M{ax:.2f} {ay:.2f}L{bx:.2f} {by:.2f}A{r1:.2f} {r1:.2f} 0 0 0 {cx:.2f} {cy:.2f}"
        f"L{dx:.2f} {dy:.2f}A{r0:.2f} {r0:.2f} 0 0 0 {ax:.2f} {ay:.2f}Z"
    )
    dashed = f' stroke-dasharray="{dash}"' if dash else ""
    draw.parts.append(f'<path d="{path}" fill="{fill}" stroke="{edge}" stroke-width="2"{dashed}/>')


def _draw_arc(
    draw: Drawing, knee: tuple[float, float], radius: float, knee_deg: float, width: float, colour: str
) -> None:
    start, end = _from(knee, radius, LEAN_DEG), _from(knee, radius, LEAN_DEG - knee_deg)
    path = f"M{start[0]:.2f} {start[1]:.2f}A{radius:.2f} {radius:.2f} 0 0 1 {end[0]:.2f} {end[1]:.2f}"
    draw.parts.append(f'<path d="{path}" fill="none" stroke="{colour}" stroke-width="{width}"/>')


def _from(point: tuple[float, float], length: float, forward_deg: float) -> tuple[float, float]:
    """The other end of a segment that hangs down, tilted forward by so much; forward is to the right, y downwards."""
    tilt = math.radians(forward_deg)
    return point[0] + length * math.sin(tilt), point[1] + length * math.cos(tilt)
