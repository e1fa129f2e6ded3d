"""Degree to which a walk can be trusted. What can be read, what is against the rest and what to do, joint by joint."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from types import MappingProxyType

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.summary.data_quality import DataQuality, QualityLine
from app.theme.current import current_theme, px, scaled
from app.theme.ground import Ground, set_ground
from app.theme.icons import VERDICT_ICONS, Icon, paint_icon
from app.widgets.body_figure import SENSOR, BodyFigure, SensorMark
from app.widgets.body_shapes import body_shapes
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.facts_table import fact_columns, fact_rows, hip_columns, hip_rows
from app.widgets.findings_list import FindingsList
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.table import CellTable
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.body import name_of
from app.wording.translation import tr
from app.wording.verdicts import verdict_alone, verdict_word
from core.body import Joint, Side, Site
from core.findings import Finding
from core.hip.results import HipAngle
from core.results import JointCalibration
from core.verdicts.model import Verdict

SENTENCE_PX = 22
FIGURE_WIDTH = 320
BESIDE = 78  # px at either side of the legs: a verdict and its word
MARK = (56, 32)
HIP_BELOW = 14  # units of the drawing, from the upper edge of the thigh


class QualityPage(QWidget):
    """Signals: `repeat_requested` of a leg's free motion."""

    repeat_requested = Signal(object)  # Side

    def __init__(self) -> None:
        super().__init__()
        self.lines: tuple[QualityLine, ...] = ()
        self._can_repeat = False
        self._line_cards: list[LineCard] = []
        self.first = Text(size=SENTENCE_PX, weight=SEMIBOLD, wraps=True)
        self.then = Text(tone="ink2", wraps=True)
        self.in_order = Text(wraps=True)
        self.engineering = Toggle(tr("Engineering details"), tr("E"), is_on=False)
        self.how_found = Button(tr("Show calibration"), ButtonKind.SECONDARY, Icon.SEARCH, height=52)
        self.agreement = Button(tr("Compare with optical system"), ButtonKind.SECONDARY, Icon.SEARCH, height=52)
        self._fill_engineering: Callable[[], None] | None = None  # what the folded tables have yet to show
        self.facts = CellTable(tr("Joint calibration"), head=36)
        self.hip_facts = CellTable(tr("Hip calibration"), head=36)
        self.hip_facts.hide()
        self.findings = FindingsList()
        self.figure = JointsFigure()
        self.strides = Text(size=12, tone="ink2", wraps=True)
        self._build()
        self.engineering.toggled.connect(self._show_parts)
        self._show_parts()

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            *self._repeats(),
            self.engineering,
            self.how_found,
            self.agreement,
            self.facts,
            self.hip_facts,
            self.findings,
        ]

    def focus(self) -> None:
        (next(iter(self._repeats()), None) or self.engineering).setFocus()

    def show_quality(
        self,
        found: DataQuality,
        joints: Mapping[Joint, Verdict],
        worn: Sequence[Site],
        strides: str,
        *,
        can_repeat: bool = False,
    ) -> None:
        """Show one walk's quality; `joints`: verdicts of shape, `strides`: used and left out, in words."""
        self.first.setText(found.first)
        self.then.setText(found.then)
        self.then.setVisible(bool(found.then))
        self.in_order.setText(found.in_order)
        self._order_card.setVisible(bool(found.in_order))
        self.strides.setText(strides)
        self.figure.show_joints(joints, worn)
        if (found.lines, can_repeat) != (self.lines, self._can_repeat):
            self.lines, self._can_repeat = found.lines, can_repeat
            self._fill()

    def show_engineering(
        self,
        calibrated: Mapping[Joint, JointCalibration],
        findings: Sequence[Finding],
        hips: Mapping[Joint, HipAngle] = MappingProxyType({}),
    ) -> None:
        """Fill the tables, once they are unfolded."""
        self._fill_engineering = partial(self._show_tables, calibrated, findings, hips)
        self._show_parts()

    def set_room(self, width: int, *, is_compact: bool, is_narrow: bool) -> None:
        """Leave the figure out where it has no room, and let the doors stand below each other in `width` px."""
        self._figure_card.setVisible(not is_compact)
        beside = 0 if is_compact else px(FIGURE_WIDTH) + self._columns.spacing()
        doors = (self.engineering, self.how_found, self.agreement)
        needed = sum(door.sizeHint().width() for door in doors) + 2 * self._doors.spacing()
        self._place_doors(1 if is_narrow else 3 if needed + beside <= width else 2)

    def _show_tables(
        self,
        calibrated: Mapping[Joint, JointCalibration],
        findings: Sequence[Finding],
        hips: Mapping[Joint, HipAngle],
    ) -> None:
        self.facts.show_rows(fact_columns(calibrated), fact_rows(calibrated))
        self.hip_facts.show_rows(hip_columns(hips), hip_rows(hips))
        self.hip_facts.setVisible(bool(hips))
        self.findings.show_findings(findings)

    def _build(self) -> None:
        cards = QWidget()
        self._list = lay_out(QVBoxLayout(cards), 1, margins=0, spacing=12)
        self._scroll = scrolled(cards)
        self._order_card, self._figures_card, self._figure_card = Card(), Card(padding=12), Card()
        order = lay_out(QHBoxLayout(), (IconMark(Icon.READ), 0, Qt.AlignmentFlag.AlignTop), (self.in_order, 1))
        scaled(order.setSpacing, 12)
        self._order_card.column.addLayout(order)
        tables, title = QWidget(), Text(tr("All findings"), size=16, weight=SEMIBOLD)
        lay_out(QVBoxLayout(tables), self.facts, self.hip_facts, 1, margins=0)
        area = scrolled(tables, is_upright=False)
        lay_out(self._figures_card.column, (area, 2), title, (self.findings, 1))
        self._doors = QGridLayout()
        scaled(self._doors.setSpacing, 12)
        self._place_doors(3)
        parts = ((self._scroll, 1), (self._figures_card, 1), self._order_card, self._doors)
        left = lay_out(QVBoxLayout(), *parts, spacing=12)
        title = Text(tr("Joints and sensors"), size=16, weight=SEMIBOLD)
        lay_out(self._figure_card.column, title, (self.figure, 1), self.strides)
        scaled(self._figure_card.setFixedWidth, FIGURE_WIDTH)
        self._columns = lay_out(QHBoxLayout(), (left, 1), self._figure_card, spacing=16)
        words = lay_out(QVBoxLayout(), self.first, self.then, spacing=4)
        lay_out(QVBoxLayout(self), words, (self._columns, 1), margins=0, spacing=12)
        scaled(self.figure.keep_beside, BESIDE)

    def _place_doors(self, in_row: int) -> None:
        """Put so many beside each other; of two rows the first has one door, as wide as both below it."""
        places = {1: ((0, 0), (1, 0), (2, 0)), 2: ((0, 0, 1, 2), (1, 0), (1, 1)), 3: ((0, 0), (0, 1), (0, 2))}
        for door, place in zip((self.engineering, self.how_found, self.agreement), places[in_row], strict=True):
            self._doors.removeWidget(door)
            self._doors.addWidget(door, *place)

    def _fill(self) -> None:
        """Make a new card of each line."""
        for card in self._line_cards:
            self._list.removeWidget(card)
            card.hide()
            card.deleteLater()
        self._line_cards = [LineCard(line, can_repeat=self._can_repeat) for line in self.lines]
        for number, card in enumerate(self._line_cards):
            if card.repeat is not None:
                card.repeat.clicked.connect(partial(self.repeat_requested.emit, card.side))
            self._list.insertWidget(number, card)

    def _repeats(self) -> list[QWidget]:
        return [card.repeat for card in self._line_cards if card.repeat is not None]

    def _show_parts(self) -> None:
        is_folded = not self.engineering.isChecked()
        if not is_folded and (fill := self._fill_engineering) is not None:
            self._fill_engineering = None
            fill()
        self._scroll.setVisible(is_folded)
        self._figures_card.setVisible(not is_folded)


class LineCard(QWidget):
    """One thing that speaks against a figure: yellow where it keeps one from being reported."""

    def __init__(self, line: QualityLine, *, can_repeat: bool) -> None:
        super().__init__()
        self.side = line.side  # the leg whose free motion mends it
        is_grave = line.is_grave
        tone, quiet = ("caution_ink", "caution_ink") if is_grave else ("ink", "ink2")
        title = f"{line.where}: {verdict_word(line.verdict)}" if line.where else verdict_alone(line.verdict)
        self.setAccessibleName(" ".join(filter(None, [f"{title}.", line.why, line.to_do])))
        self.repeat: Button | None = None
        top = Qt.AlignmentFlag.AlignTop
        words = QVBoxLayout()
        scaled(words.setSpacing, 2)
        what = Text(title, size=16, weight=SEMIBOLD, tone=tone, wraps=True)
        lay_out(words, what, Text(line.why, tone=quiet, wraps=True))
        if line.to_do:
            word = Text(tr("To do"), weight=SEMIBOLD, tone=tone)
            to_do = lay_out(QHBoxLayout(), (word, 0, top), (Text(line.to_do, tone=tone, wraps=True), 1))
            scaled(to_do.setSpacing, 12)
            words.addLayout(to_do)
        mark = IconMark(VERDICT_ICONS[line.verdict], tone=tone)
        row = lay_out(QHBoxLayout(self), (mark, 0, top), (words, 1), margins=(16, 12, 16, 12), spacing=12)
        if can_repeat and line.side is not None:
            stated = tr("Repeat left leg") if line.side is Side.LEFT else tr("Repeat right leg")
            self.repeat = Button(stated, ButtonKind.SECONDARY, Icon.REPEAT, height=44)
            row.addWidget(self.repeat, 0, Qt.AlignmentFlag.AlignBottom)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Preferred)
        set_ground(self, Ground("caution", "caution_edge") if is_grave else Ground("surface", "control"))


class JointsFigure(BodyFigure):
    """The legs with their sensors, and beside each joint that was measured what may be read of it."""

    def __init__(self) -> None:
        super().__init__(legs_only=True)
        self._joints: dict[Joint, Verdict] = {}
        self._has_pelvis = False

    def joint_anchor(self, joint: Joint) -> QPointF:
        """Where a joint lies; a hip in the upper end of its thigh, which the drawing does not mark."""
        if not joint.is_hip:
            return super().joint_anchor(joint)
        thigh = body_shapes().outlines[joint.distal].boundingRect()
        return self._placed().map(QPointF(thigh.center().x(), thigh.top() + HIP_BELOW))

    def show_joints(self, joints: Mapping[Joint, Verdict], worn: Sequence[Site]) -> None:
        self._joints = dict(joints)
        self._has_pelvis = Site.PELVIS in worn
        self.show_worn(dict.fromkeys((site for site in worn if site is not Site.PELVIS), SensorMark.WORN))
        stated = [f"{name_of(joint)}: {verdict_word(verdict)}" for joint, verdict in joints.items()]
        self.setAccessibleDescription("; ".join([*stated, self.accessibleDescription()]))
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)
        theme = current_theme()
        c = theme.colours
        painter = QPainter(self)
        if self._has_pelvis:
            box = QRectF(0, 0, px(SENSOR[0]), px(SENSOR[1]))
            box.moveCenter(self._placed().map(body_shapes().outlines["pelvis"].boundingRect().center()))
            painter.setPen(theme.pen(c.surface, 1))
            painter.setBrush(QColor(c.ink))
            painter.drawRoundedRect(box, px(3), px(3))
            painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setFont(theme.font(12, SEMIBOLD))
        for joint, verdict in self._joints.items():
            at, is_right = self.joint_anchor(joint), joint.side is Side.RIGHT
            width, height = px(MARK[0]), px(MARK[1])
            box = QRectF(1 if is_right else self.width() - 1 - width, at.y() - height / 2, width, height)
            is_grave = verdict is Verdict.NOT_REPORTED
            painter.setPen(theme.pen(c.control, 1))
            edge = box.right() if is_right else box.left()
            painter.drawLine(
                round(edge), round(at.y()), round(at.x() - px(7) if is_right else at.x() + px(7)), round(at.y())
            )
            fill, line = (c.caution, c.caution_edge) if is_grave else (c.sunken, c.control)
            theme.paint_box(painter, box, fill, line, 1)
            icon = px(18)
            mark = QRectF(box.center().x() - icon / 2, box.center().y() - icon / 2, icon, icon)
            paint_icon(painter, VERDICT_ICONS[verdict], mark, c.caution_ink if is_grave else c.ink)
            painter.setPen(QColor(c.ink))
            side = Qt.AlignmentFlag.AlignLeft if is_right else Qt.AlignmentFlag.AlignRight
            # beside the hips the letters of both legs stand
            words = QRectF(0, box.bottom() + px(2) if joint.is_hip else box.top() - px(18), self.width(), px(16))
            painter.drawText(words, side | Qt.AlignmentFlag.AlignVCenter, verdict_alone(verdict))
