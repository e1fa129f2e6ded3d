"""Page of free motion:

how well the joints show so far, and which motion comes next. Four gauges are drawn round both legs.

With a sensor on the pelvis both hips stand above them, on slim cards: nothing waits for them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from PySide6.QtCore import QPointF, Signal
from PySide6.QtGui import QPaintEvent, QPolygonF
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.theme.current import current_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import Icon
from app.widgets.action_bar import BarAction
from app.widgets.body_figure import BodyFigure, SensorMark
from app.widgets.button import Button, ButtonKind
from app.widgets.gauge import Gauge, GaugeFace
from app.widgets.hint import Hint, HintBand
from app.widgets.hip_gauge import HipFace, HipGauge
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.painted import smooth_painter
from app.wizard.free_motion.swap_banner import SwapBanner
from core.body import LEG_JOINTS, Joint, Side, Site, hip_of

USUAL_S = 10.0
FACING = (Joint.RIGHT_KNEE, Joint.LEFT_KNEE, Joint.RIGHT_ANKLE, Joint.LEFT_ANKLE)  # the patient faces you
FIGURE_WIDTH = 216


@dataclass(frozen=True, slots=True)
class Swapped:
    """Which places look swapped, what that costs, and the two ways on."""

    what: str
    then: str
    use: BarAction
    check: BarAction


@dataclass(frozen=True, slots=True)
class FreeMotionFace:
    """What the motion looks like now. `emphasised` is the limb to move; `elapsed_s` None before it is recorded.

    `hips` is empty without a sensor on the pelvis. `swapped` takes the hint's place; `moves_to`: by a sensor's site,
    the one that it moves like.
    """

    gauges: Mapping[Joint, GaugeFace] = field(default_factory=dict)
    hint: Hint = field(default_factory=lambda: Hint(""))
    elapsed_s: float | None = None
    emphasised: Site | None = None
    worn: Mapping[Site, SensorMark] = field(default_factory=dict)
    hips: Mapping[Joint, HipFace] = field(default_factory=dict)
    swapped: Swapped | None = None
    moves_to: Mapping[Site, Site] = field(default_factory=dict)


class FreeMotionPage(QWidget):
    """Its gauges are laid out like the patient who faces you; where there is little room, without the figure."""

    def __init__(self) -> None:
        super().__init__()
        self._is_compact = False
        self.question = _Question()
        self.band = HintBand()
        self.swapped = SwapBanner()
        self.gauges = {joint: Gauge(joint) for joint in LEG_JOINTS}
        self.hips = {hip_of(side): HipGauge(hip_of(side)) for side in Side}
        self.figure = BodyFigure(legs_only=True)
        self._hips, self._grid = QHBoxLayout(), QGridLayout()
        for hip in self.hips.values():
            hip.hide()
        self._place(is_from_behind=False)
        self._grid.addWidget(self.figure, 0, 1, 2, 1)
        for column in (0, 2):
            self._grid.setColumnStretch(column, 1)
        for row in (0, 1):
            self._grid.setRowStretch(row, 1)
        parts = (self.question, self.band, self.swapped, self._hips, (self._grid, 1))
        self._column = lay_out(QVBoxLayout(self), *parts)
        scaled(self._hips.setSpacing, 12)
        scaled(self._grid.setVerticalSpacing, 12)
        self.set_compact(False)

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.question.buttons, *self.swapped.buttons]

    def focus(self) -> None:
        """Give the focus to the choice there is; without one the bar has it."""
        for part in (self.swapped, self.question):
            shown = [button for button in part.buttons if not button.isHidden()]
            if not part.isHidden() and shown:
                shown[0].setFocus()
                return

    def set_from_behind(self, is_from_behind: bool) -> None:
        """Turn figure and gauges: from behind, the patient's left is at the left."""
        self.figure.set_from_behind(is_from_behind)
        self._place(is_from_behind)
        self.update()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.band.set_compact(is_compact)
        self.swapped.set_compact(is_compact)
        for gauge in self.gauges.values():
            gauge.set_compact(is_compact)
        for hip in self.hips.values():
            hip.set_compact(is_compact)
        self.figure.setVisible(not is_compact)
        across, down = (16, 12) if is_compact else (24, 16)
        scaled(self._column.setContentsMargins, across, down, across, down)
        scaled(self._column.setSpacing, 12 if is_compact else 16)
        scaled(self._grid.setHorizontalSpacing, 6 if is_compact else 0)
        scaled(self._set_figure_width, 0 if is_compact else FIGURE_WIDTH)
        self.update()

    def show_state(self, view: FreeMotionFace) -> None:
        """Show how far the motion has come; only what reads otherwise is painted again."""
        self._show_swapped(view.swapped)
        self.band.show_hint(view.hint)
        self.band.show_elapsed(view.elapsed_s, USUAL_S)
        for joint, gauge in self.gauges.items():
            gauge.show_face(view.gauges.get(joint, GaugeFace()))
        for joint, hip in self.hips.items():
            hip.setVisible(joint in view.hips)
            hip.show_face(view.hips.get(joint, HipFace()))
        self.figure.emphasise(view.emphasised)
        self.figure.show_worn(view.worn)
        self.figure.show_moves(view.moves_to)

    def _show_swapped(self, swapped: Swapped | None) -> None:
        """Show the banner in the hint's place; the focus goes to its first way on."""
        was_shown = not self.swapped.isHidden()
        if swapped is not None:
            self.swapped.show_message(swapped.what, swapped.then, swapped.use, swapped.check)
        if was_shown is (swapped is None):
            self.band.setVisible(swapped is None)
            self.swapped.setVisible(swapped is not None)
            if swapped is not None and self.isVisible():
                self.focus()

    def paintEvent(self, event: QPaintEvent) -> None:
        """Lead a line from each card to its joint."""
        middle = self.figure.geometry().adjusted(-px(8), 0, px(8), 0)
        if self._is_compact or not event.rect().intersects(middle):
            return
        painter = smooth_painter(self)
        painter.setPen(current_theme().pen(current_theme().colours.control, 1))
        for joint, gauge in self.gauges.items():
            place = gauge.geometry()
            is_left_of_figure = place.right() < self.figure.geometry().center().x()
            edge = float(place.right() + 1 if is_left_of_figure else place.left())
            start = QPointF(edge, place.center().y())
            end = QPointF(self.figure.pos()) + self.figure.joint_anchor(joint)
            inwards = px(1) if is_left_of_figure else -px(1)
            bends = [start + QPointF(14 * inwards, 0), end - QPointF(24 * inwards, 0)]
            painter.drawPolyline(QPolygonF([start, *bends, end]))

    def _place(self, is_from_behind: bool) -> None:
        for number, joint in enumerate(FACING):
            self._grid.removeWidget(self.gauges[joint])  # else PySide goes on holding its old item, which Qt deletes
            self._grid.addWidget(self.gauges[joint], number // 2, 2 * ((number + is_from_behind) % 2))
        for side in (Side.LEFT, Side.RIGHT) if is_from_behind else (Side.RIGHT, Side.LEFT):
            self._hips.removeWidget(self.hips[hip_of(side)])
            self._hips.addWidget(self.hips[hip_of(side)])

    def _set_figure_width(self, width: int) -> None:
        self._grid.setColumnMinimumWidth(1, width)


class _Question(QWidget):
    """What has to be answered by somebody who sees the patient; hidden while nothing has."""

    answered = Signal(int)  # the answer's number

    def __init__(self) -> None:
        super().__init__()
        self.notice = Notice(size=14)
        self.buttons = (
            Button("", ButtonKind.PRIMARY, height=44),
            Button("", ButtonKind.SECONDARY, height=44),
        )
        lay_out(QHBoxLayout(self), (self.notice, 1), *self.buttons, margins=(6, 6, 10, 6), spacing=12)
        for button in self.buttons:
            button.clicked.connect(self._on_clicked)
        self.hide()

    def ask(self, what: str, then: str = "", answers: tuple[str, ...] = (), *, is_understood: bool = False) -> None:
        """Show what the motion contradicts with up to two answers, or an answer with its undo; empty: hide."""
        offered = dict(enumerate(answers, start=int(is_understood)))
        for number, button in enumerate(self.buttons):
            button.setVisible(number in offered)
            if number in offered:
                button.setText(offered[number])
                button.setAccessibleName(offered[number])
                button.updateGeometry()
        self.setVisible(bool(what))
        set_ground(self, Ground("surface", "control") if is_understood else Ground("caution", "caution_edge"))
        self.notice.show_message(Icon.CHECK if is_understood else Icon.WARNING, what, then)

    def _on_clicked(self) -> None:
        self.answered.emit(int(self.sender() is self.buttons[1]))
