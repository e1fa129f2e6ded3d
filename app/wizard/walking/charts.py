"""The live curves of both legs above their gait phases, on one time that ends now."""

import math

from PySide6.QtCore import QRectF
from PySide6.QtGui import QAccessible, QColor, QPainter
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QSpacerItem, QWidget

from app.charts.axes import ANKLE_DEG, KNEE_DEG, degrees_in_words
from app.plots.phase_lanes import LEGEND, Swatch
from app.theme.current import current_theme, on_theme, px, scaled
from app.widgets.card import Card
from app.widgets.chip import SideKey
from app.widgets.lay_out import lay_out
from app.widgets.painted import Painted
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wizard.walking.live_lanes import LiveLanes
from app.wizard.walking.live_strip import LiveStrip
from app.wizard.walking.readout import WalkingReadout
from app.wording.translation import tr
from core.body import Side

HIP_DEG = (-20.0, 50.0)
HIP_TICK_DEG, KNEE_TICK_DEG, ANKLE_TICK_DEG = 20, 30, 20
HIP_SHARE, KNEE_SHARE, ANKLE_SHARE = 4, 5, 4  # of the height: the knee's axis is half as long again


class WalkingCharts(Card):
    """Knee, ankle and phases in one frame, the hip above them where the pelvis wears a sensor."""

    accessible_role = QAccessible.Role.Chart

    def __init__(self) -> None:
        super().__init__(spacing=4)
        self.hip = LiveStrip(HIP_DEG, HIP_TICK_DEG)
        self.knee = LiveStrip(KNEE_DEG, KNEE_TICK_DEG)
        self.ankle = LiveStrip(ANKLE_DEG, ANKLE_TICK_DEG)
        self.lanes = LiveLanes()
        self._simulated: list[Text] = []  # over each joint's curves and the phases: one may be cut out alone
        self._provisional = Text(size=12, weight=MEDIUM, tone="ink2")
        self._hip_note = Text(size=12, weight=MEDIUM, tone="ink2")
        self._hip_head = QWidget()  # to be hidden at once
        self._has_hips = False
        self._keys = {side: SideKey(side) for side in Side}
        self._is_compact = False
        self._legend_gaps: list[QSpacerItem] = []  # they give way where words are long
        self._lines = Hairline(), Hairline()
        self._hip_line = Hairline()
        self._phases_title = Text(tr("Gait phases"), size=14, tone="ink2")
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._build()
        on_theme(self._keep_gaps)

    def set_simulated(self, is_simulated: bool) -> None:
        for mark in self._simulated:
            mark.setVisible(is_simulated)

    def set_hips(self, has_hips: bool) -> None:
        """Show the hips' curves, or leave their place to the others."""
        self._has_hips = has_hips
        self._hip_head.setVisible(has_hips)
        self.hip.setVisible(has_hips)
        self._hip_line.setVisible(has_hips and not self._is_compact)

    def set_compact(self, is_compact: bool) -> None:
        """Keep the room for the curves."""
        self._is_compact = is_compact
        for widget in (self._phases_title, *self._lines):
            widget.setVisible(not is_compact)
        self._hip_line.setVisible(self._has_hips and not is_compact)
        self.lanes.set_compact(is_compact)
        self.set_padding(8 if is_compact else 16)
        scaled(self.column.setSpacing, 2 if is_compact else 4)

    def set_seconds(self, seconds: float) -> None:
        for chart in (self.hip, self.knee, self.ankle, self.lanes):
            chart.set_seconds(seconds)

    def show_live(self, live: WalkingReadout) -> None:
        """Draw up to now; a side that is left out has no curve or lane."""
        hips, knees, ankles = live.hips, live.knees, live.ankles
        if self._has_hips:
            self.hip.show_traces(live.now_s, hips)
            self._say_of_hips([side for side in Side if side in hips and hips[side].is_provisional], bool(hips))
        self.knee.show_traces(live.now_s, knees)
        self.ankle.show_traces(live.now_s, ankles)
        self.lanes.show_lanes(live.now_s, live.lanes)
        for side, key in self._keys.items():
            key.setVisible(side in knees or side in ankles or side in hips)
        self._say_provisional([side for side in Side if side in ankles and ankles[side].is_provisional])

    def clear(self) -> None:
        for chart in (self.hip, self.knee, self.ankle, self.lanes):
            chart.clear()
        self._say_provisional([])
        self._say_of_hips([], are_known=True)

    def _say_provisional(self, sides: list[Side]) -> None:
        words = tr("{sides} provisional") if self._is_compact else tr("{sides} provisional until five strides")
        stated = words.format(sides=", ".join(side.letter for side in sides)) if sides else ""
        self._provisional.setText(stated)

    def _say_of_hips(self, provisional: list[Side], are_known: bool) -> None:
        words = tr("{sides} provisional") if self._is_compact else tr("{sides} provisional until calibrated by walking")
        stated = words.format(sides=", ".join(side.letter for side in provisional)) if provisional else ""
        if not are_known:
            stated = tr("not known yet") if self._is_compact else tr("not known before the first strides")
        self._hip_note.setText(stated)

    def _build(self) -> None:
        hip = self._head(Text(tr("Hip"), size=16, weight=SEMIBOLD), tr("flexion + (°)"))
        self._hip_head.setLayout(lay_out(hip, 1, self._hip_note, margins=0))
        knee = self._head(Text(tr("Knee"), size=16, weight=SEMIBOLD), tr("flexion + (°)"))
        lay_out(knee, 1, lay_out(QHBoxLayout(), *self._keys.values(), spacing=20))
        ankle = self._head(Text(tr("Ankle"), size=16, weight=SEMIBOLD), tr("dorsiflexion + (°)"))
        lay_out(ankle, 1, self._provisional)
        legend = lay_out(QHBoxLayout(), spacing=6)
        for phase, word in LEGEND:
            if legend.count():
                self._legend_gaps.append(QSpacerItem(0, 0, QSizePolicy.Policy.Maximum))
                legend.addItem(self._legend_gaps[-1])
            legend.addLayout(lay_out(QHBoxLayout(), Swatch(phase), Text(tr(word), size=12, tone="ink2"), spacing=6))
        lay_out(
            self.column,
            self._hip_head,
            (self.hip, HIP_SHARE),
            self._hip_line,
            knee,
            (self.knee, KNEE_SHARE),
            self._lines[0],
            ankle,
            (self.ankle, ANKLE_SHARE),
            self._lines[1],
            lay_out(self._head(self._phases_title, ""), 1, legend),
            self.lanes,
        )
        self.set_simulated(is_simulated=False)
        self.set_hips(has_hips=False)

    def _head(self, title: Text, sign: str) -> QHBoxLayout:
        mark = Text(tr("SIMULATED"), size=12, weight=SEMIBOLD)
        self._simulated.append(mark)
        signs = [Text(sign, size=12, tone="ink2")] if sign else []
        return lay_out(QHBoxLayout(), title, *signs, mark, spacing=8)

    def _keep_gaps(self) -> None:
        for gap in self._legend_gaps:
            gap.changeSize(px(14), 0, QSizePolicy.Policy.Maximum)


class Hairline(Painted):
    """A line across, between things that belong together."""

    def __init__(self) -> None:
        super().__init__()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        scaled(self.setFixedHeight, 9)

    def draw(self, painter: QPainter) -> None:
        line = QRectF(0, (self.height() - px(1)) // 2, self.width(), px(1))
        painter.fillRect(line, QColor(current_theme().colours.line))


def last_angles_in_words(live: WalkingReadout) -> str:
    """Say each joint's newest angle, for who cannot see the curves."""
    hips = {Side.LEFT: tr("Left hip {angle}."), Side.RIGHT: tr("Right hip {angle}.")}
    knees = {Side.LEFT: tr("Left knee {angle}."), Side.RIGHT: tr("Right knee {angle}.")}
    ankles = {Side.LEFT: tr("Left ankle {angle}."), Side.RIGHT: tr("Right ankle {angle}.")}
    stated = []
    for traces, words in ((live.hips, hips), (live.knees, knees), (live.ankles, ankles)):
        for side in Side:
            if side in traces:
                angles = traces[side].angle_rad
                last = math.degrees(angles[-1]) if len(angles) else math.nan
                known = degrees_in_words(last, 0) if math.isfinite(last) else tr("missing")
                stated.append(words[side].format(angle=known))
    return " ".join(stated)
