"""Key frames of the walk: a row of pictures for each leg, with the moment, its percent and the angles beneath."""

import base64
from collections.abc import Sequence

from app.charts.axes import angle_in_words
from app.charts.drawing import COLOURS, MM, Drawing, Picture
from app.reports.blocks import Block, figures, heading, note
from app.theme.colours import PAPER
from app.wording.body import side_name
from app.wording.translation import later, tr
from core.body import Side
from core.video.key_frames import KeyFrame, KeyMoment

WIDTH = 42 * MM  # four beside each other
LINE = 3.8 * MM
SIZE, SMALL = 8.5, 7.8  # pt
MOMENT_WORDS = {
    KeyMoment.INITIAL_CONTACT: later("Initial contact"),
    KeyMoment.MID_STANCE: later("Mid-stance"),
    KeyMoment.TOE_OFF: later("Toe-off"),
    KeyMoment.MID_SWING: later("Mid-swing"),
}


def key_frames_page(frames: Sequence[KeyFrame]) -> list[Block]:
    """Nothing without frames."""
    if not frames:
        return []
    stated = tr(
        "Of each leg the stride nearest to its mean curve. Mid-stance is halfway from contact to toe-off, mid-swing "
        "halfway from toe-off to contact. Faces can be recognised."
    )
    blocks = [heading(tr("Key frames of the video")), note(stated)]
    for side in Side:
        if shown := [one for one in frames if one.side is side]:
            blocks += [heading(tr("Left") if side is Side.LEFT else tr("Right"), level=2)]
            blocks += [figures([_picture(one) for one in shown], columns=len(KeyMoment))]
    return blocks


def _picture(frame: KeyFrame) -> Picture:
    height = WIDTH * frame.height / frame.width
    moment = tr(MOMENT_WORDS[frame.moment])
    angles = _angles(frame)
    draw = Drawing()
    jpeg = base64.b64encode(frame.jpeg).decode("ascii")
    draw.parts.append(
        f'<image x="0" y="0" width="{WIDTH:.2f}" height="{height:.2f}" href="data:image/jpeg;base64,{jpeg}"/>'
    )
    draw.line(0, height, WIDTH, height, COLOURS[frame.side], 1.6)
    draw.text(0, height + LINE, moment, SIZE, weight=600)
    percent = tr("{percent:.0f} %").format(percent=frame.percent)
    draw.text(WIDTH, height + LINE, percent, SMALL, anchor="end", fill=PAPER.note)
    draw.text(0, height + 2 * LINE, angles, SMALL)
    alt = tr("Video, {side} leg, {moment}: {angles}.").format(side=side_name(frame.side), moment=moment, angles=angles)
    return draw.picture(WIDTH, height + 2.4 * LINE, alt)


def _angles(frame: KeyFrame) -> str:
    stated = [
        words.format(angle=f"{angle_in_words(value)}°")
        for words, value in ((tr("knee {angle}"), frame.knee_deg), (tr("ankle {angle}"), frame.ankle_deg))
        if value is not None
    ]
    return ", ".join(stated) or tr("not reported")
