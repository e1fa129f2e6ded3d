"""What is beside the form of a patient: the reference band, whose code it is, and the visit before this one."""

from dataclasses import dataclass

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPolygonF
from PySide6.QtWidgets import QGridLayout, QHBoxLayout

from app.theme.current import current_theme, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.translation import figure_text, tr
from core.verdicts.norms import ReferenceCurves

DRAWING_HEIGHT = 108


@dataclass(frozen=True, slots=True)
class LastVisit:
    """The visit before this one: its title with the date, and what it is known by, as label and value."""

    title: str
    facts: tuple[tuple[str, str], ...]


class BandCard(Card):
    """The group that the patient's curves will lie on, and whether the patient is like them."""

    def __init__(self, curves: ReferenceCurves) -> None:
        super().__init__(padding=20, spacing=6)
        self._ages_years = curves.ages_years
        group = tr("{n} young adults, barefoot on a treadmill at {speed} m/s. Fukuchi 2018.").format(
            n=curves.n, speed=figure_text(curves.speed_m_s, ".2f")
        )
        self._words = Text(size=14, wraps=True)
        mark = (IconMark(Icon.INFO), 0, Qt.AlignmentFlag.AlignTop)
        advice = lay_out(QHBoxLayout(), mark, (self._words, 1), spacing=10)
        title = Text(tr("Reference"), size=16, weight=SEMIBOLD)
        lay_out(self.column, title, Text(group, size=14, wraps=True), _BandDrawing(curves), advice)

    def judge(self, age: int | None) -> None:
        """Say whether a patient of `age` years is of the group's age."""
        youngest, oldest = self._ages_years
        if age is None:
            words = tr("Enter the birth year to check whether the reference fits the age.")
        elif age > oldest:
            words = tr(
                "The reference does not cover age {age}. It is shown, but differences from it are not reported."
            ).format(age=age)
        elif age < youngest:
            words = tr("The reference is for adults. Gait differs at age {age}, so the reference is not shown.").format(
                age=age
            )
        else:
            words = tr(
                "The reference fits the patient's age. The speed must also fit; checking it requires the body height."
            )
        self._words.setText(words)


class _BandDrawing(Painted):
    """The knee of the group over one stride: one and two standard deviations in two greys."""

    def __init__(self, curves: ReferenceCurves) -> None:
        super().__init__()
        self._curves = curves
        scaled(self.setFixedHeight, DRAWING_HEIGHT)
        scaled(self.setMinimumWidth, 200)
        self.setAccessibleName(_title())
        peak = int(curves.knee_mean_deg.argmax())
        self.setAccessibleDescription(
            tr("Peak {angle}° at {percent} % of the gait cycle").format(
                angle=f"{curves.knee_mean_deg[peak]:.0f}", percent=peak
            )
        )

    def draw(self, painter: QPainter) -> None:
        theme = current_theme()
        c, px = theme.colours, theme.px
        mean, sd = self._curves.knee_mean_deg, self._curves.knee_sd_deg
        low, high = float((mean - 2 * sd).min()), float((mean + 2 * sd).max())
        room = QRectF(0, px(4), self.width(), self.height() - px(8))

        def at(percent: int, angle_deg: float) -> QPointF:
            return QPointF(
                room.left() + percent / (len(mean) - 1) * room.width(),
                room.bottom() - (angle_deg - low) / (high - low) * room.height(),
            )

        painter.setPen(Qt.PenStyle.NoPen)
        for width, colour in ((2, c.band_2sd), (1, c.band_1sd)):
            edge = [at(i, mean[i] + width * sd[i]) for i in range(len(mean))]
            edge += [at(i, mean[i] - width * sd[i]) for i in reversed(range(len(mean)))]
            painter.setBrush(QColor(colour))
            painter.drawPolygon(QPolygonF(edge))
        painter.setPen(theme.pen(c.control, 1))
        painter.drawLine(at(0, 0.0), at(len(mean) - 1, 0.0))
        painter.setPen(QColor(c.ink2))
        painter.setFont(theme.font(12))
        painter.drawText(0, 0, self.width(), px(16), Qt.AlignmentFlag.AlignLeft, _title())


def _title() -> str:
    return tr("Knee, ±1 and ±2 SD")


class TakenCard(Card):
    """The patient who has the code that was typed."""

    def __init__(self) -> None:
        super().__init__(padding=20, spacing=12)
        self._title = Text(size=16, weight=SEMIBOLD, wraps=True)
        self.open = Button(tr("Open this patient"), ButtonKind.SECONDARY, Icon.FOLDER)
        lay_out(self.column, self._title, self.open)

    def show_code(self, code: str) -> None:
        self._title.setText(tr("{code} is in the library").format(code=code))
        self.open.setAccessibleDescription(code)


class LastVisitCard(Card):
    """What was worn and recorded last time, and the way to have the same again."""

    def __init__(self) -> None:
        super().__init__(padding=20, spacing=10)
        self._facts = QGridLayout()
        scaled(self._facts.setHorizontalSpacing, 16)
        scaled(self._facts.setVerticalSpacing, 8)
        self._title = Text(size=16, weight=SEMIBOLD, wraps=True)
        self.same = Button(tr("Use last visit's set-up"), ButtonKind.SECONDARY, Icon.REPEAT)
        self._facts.setColumnStretch(1, 1)
        self._shown: list[Text] = []
        lay_out(self.column, self._title, self._facts, 1, self.same)

    def show_visit(self, visit: LastVisit) -> None:
        self._title.setText(visit.title)
        for text in self._shown:
            text.setParent(None)
            text.deleteLater()
        self._shown = []
        for row, (label, value) in enumerate(visit.facts):
            texts = Text(label, size=14, tone="ink2"), Text(value, size=14, weight=MEDIUM, wraps=True)
            for column, text in enumerate(texts):
                self._facts.addWidget(text, row, column, Qt.AlignmentFlag.AlignTop)
                self._shown.append(text)
        hear_as_laid_out(self)
