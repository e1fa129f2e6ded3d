"""What screen and paper draw alike of a chart of the stride: its axes, and what is read on its curves."""

import numpy as np

from app.charts.axes import angle_in_words
from app.charts.canvas import Anchor, Canvas, Tone
from app.charts.frame import Frame
from app.charts.marks import Deviation, HiddenCurve, Point
from app.charts.places import Box, Layout, MarkPlace, lines_of_hidden
from app.charts.stride_chart import Axis

TICK_PERCENT = 20


def draw_axes(canvas: Canvas, frame: Frame, axis: Axis) -> None:
    """The line of zero, both axes, and their ticks with labels."""
    size = canvas.lengths
    zero = float(frame.y(0))
    canvas.stroke((frame.left, zero), (frame.right, zero), Tone.AXIS, size.zero)
    canvas.stroke((frame.left, frame.top), (frame.left, frame.bottom), Tone.AXIS, size.axis)
    canvas.stroke((frame.left, frame.bottom), (frame.right, frame.bottom), Tone.AXIS, size.axis)
    first = np.ceil(axis.low / axis.label_every) * axis.label_every
    for degrees in np.arange(first, axis.high + 1, axis.label_every):
        y = float(frame.y(degrees))
        canvas.stroke((frame.left - size.tick, y), (frame.left, y), Tone.AXIS, size.axis)
        canvas.label(frame.left - size.label_apart, y, angle_in_words(float(degrees)), "end")
    for percent in range(0, 101, TICK_PERCENT):
        x = float(frame.x(percent))
        canvas.stroke((x, frame.bottom), (x, frame.bottom + size.tick), Tone.AXIS, size.axis)
        stated = f"{percent}" if percent < 100 else "100 %"
        canvas.label(x, frame.bottom + size.percents_below, stated, "middle")


def draw_marks(canvas: Canvas, frame: Frame, layout: Layout) -> None:
    """Boxes of hidden curves, brackets, and values at peaks, which are read over all dots."""
    for hidden, room in layout.hidden:
        _draw_hidden(canvas, hidden, room)
    for bracket, place in layout.brackets:
        _draw_bracket(canvas, frame, bracket, place)
    for label, _ in layout.labels:
        _draw_dot(canvas, frame, label.point)
    for label, found in layout.labels:
        if found is not None:
            x, y = (found.left + found.right) / 2, (found.top + found.bottom) / 2
            canvas.words(x, y, label.text, "middle", label.side, is_first=True)


def _draw_hidden(canvas: Canvas, hidden: HiddenCurve, room: Box) -> None:
    size, middle, lines = canvas.lengths, (room.top + room.bottom) / 2, lines_of_hidden(hidden)
    canvas.hatched_box(room.left, room.top, room.right - room.left, size.hidden_height)
    canvas.chip(room.left + size.hidden_padding, middle, hidden.side)
    left, first = room.left + 2 * size.hidden_padding + size.chip, middle - size.line * (len(lines) - 1) / 2
    for row, words in enumerate(lines):
        canvas.words(left, first + row * size.line, words, "start", Tone.INK, is_first=row == 0)


def _draw_bracket(canvas: Canvas, frame: Frame, bracket: Deviation, place: MarkPlace) -> None:
    """Lines from both points to the bar between their heights, dots on them, and the words beside the bar."""
    size, tone = canvas.lengths, Tone.INK if bracket.is_larger_than_error else Tone.INSIDE_ERROR
    for point in bracket.points:
        y = float(frame.y(point.angle_deg))
        canvas.stroke((float(frame.x(point.percent)), y), (place.bar_x, y), tone, size.leader)
    canvas.stroke((place.bar_x, place.top), (place.bar_x, place.bottom), tone, size.bar)
    for point in bracket.points:
        _draw_dot(canvas, frame, point)
    if (box := place.words) is None:
        return
    anchor: Anchor = "start" if place.are_words_at_right else "end"
    x = box.left if place.are_words_at_right else box.right
    for row, (words, tone) in enumerate(((bracket.words, Tone.INK), (bracket.more, Tone.NOTE))[: place.lines]):
        canvas.words(x, box.top + (row + 0.5) * size.line, words, anchor, tone, is_first=row == 0)


def _draw_dot(canvas: Canvas, frame: Frame, point: Point) -> None:
    canvas.dot(float(frame.x(point.percent)), float(frame.y(point.angle_deg)), point.joint.side)
