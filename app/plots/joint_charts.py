"""Hip, knee and ankle over one recording: one time axis, one reading line, and always a way back to the whole."""

from collections.abc import Mapping

import numpy as np
from PySide6.QtCore import QPointF, Qt, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QKeyEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.charts.axes import (
    USUAL_DEG,
    degrees_in_words,
    nothing_in_words,
    part_in_words,
    range_in_words,
    sign_in_words,
    title_in_words,
)
from app.plots.angle_chart import AngleChart, Curve
from app.plots.phase_lanes import PhaseFrame
from app.theme.current import on_theme, scaled
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.chip import SideKey
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.body import name_of
from app.wording.numbers import MINUS
from app.wording.translation import figure_text, later, tr
from core.body import Joint, JointKind, Side
from core.results import SideGait
from core.samples import FloatArray, IntArray

ZOOM = 0.6  # what one press of + leaves of the time in sight
NO_VALUE = later("no value")
NO_GAIT: Mapping[Side, SideGait] = {}


class JointCharts(QWidget):
    """Charts that act as one control: the mouse or the keys read, move along and zoom in time.

    The hip's is there where a hip was measured. `view_changed` gives whether the whole recording is in sight, and which
    part is.
    """

    accessible_role = QAccessible.Role.Chart

    view_changed = Signal(bool, str)

    def __init__(self) -> None:
        super().__init__()
        self._time_s: FloatArray = np.zeros(0)
        self.cursor_s: float | None = None
        self._name = ""
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.hip, self.knee, self.ankle = (
            ChartFrame(AngleChart(*USUAL_DEG[kind], has_times=kind is JointKind.ANKLE), kind) for kind in JointKind
        )
        self.frames = (self.hip, self.knee, self.ankle)
        self.hip.hide()
        self.phases = PhaseFrame()
        self._event_rows: IntArray = np.zeros(0, dtype=np.int64)
        self._column = QVBoxLayout(self)
        self._column.setContentsMargins(0, 0, 0, 0)
        for frame in self.frames:
            self._column.addWidget(frame, 1)
            frame.chart.scene().sigMouseMoved.connect(self._on_mouse_moved)
        self._column.addWidget(self.phases)
        self.phases.hide()
        self.phases.lanes.pointed.connect(self.read_at)
        self.phases.lanes.zoomed.connect(self.zoom)
        self.phases.lanes.dragged.connect(self.go_on)
        for frame in (self.hip, self.ankle):
            frame.chart.link_time(self.knee.chart)
        self.knee.chart.view_moved.connect(self._on_view_moved)
        scaled(self._column.setSpacing, 12)

    @property
    def visible_s(self) -> tuple[float, float]:
        return self.knee.chart.visible_s

    @property
    def is_whole(self) -> bool:
        first, last = self.knee.chart.whole_s
        shown = self.visible_s
        return bool(np.allclose(shown, (first, last), atol=1e-3 * (last - first)))

    def show_recording(
        self, name: str, time_s: FloatArray, is_simulated: bool, gait: Mapping[Side, SideGait] = NO_GAIT
    ) -> None:
        """Prepare the charts for a recording, all in sight; `time_s` (n,), `gait`: of walking legs."""
        self._time_s = time_s
        self.phases.show_gait(time_s, gait, is_simulated)
        rows = [row for lane in self.phases.lanes.lanes.values() for row in lane.event_rows]
        self._event_rows = np.unique(np.array(rows, dtype=np.int64))
        self._name = name
        for frame in self.frames:
            frame.set_simulated(is_simulated)
            frame.chart.show_curves(time_s, {})
        self.read_at(None)
        self.show_whole()

    def show_joints(self, curves: Mapping[Joint, Curve]) -> None:
        """Draw the joints' curves, all on the time of `show_recording`; the stretch in sight stays."""
        for frame in self.frames:
            joints = {side: frame.kind.of(side) for side in Side}
            frame.show_curves(self._time_s, {side: curves[joint] for side, joint in joints.items() if joint in curves})
        has_hips = any(joint.is_hip for joint in curves)
        self.hip.setVisible(has_hips)
        for frame in self.frames:
            frame.set_of_three(has_hips)
        scaled(self._column.setSpacing, 6 if has_hips else 12)
        self.hip.set_moment_shown(has_hips)  # once is enough, on top
        self.knee.set_moment_shown(not has_hips)
        what = (
            tr("Hip, knee and ankle angles of {recording}") if has_hips else tr("Knee and ankle angles of {recording}")
        )
        self.setAccessibleName(what.format(recording=self._name))
        reported = [*(frame.in_words() for frame in self._shown), self.phases.in_words()]
        self.setAccessibleDescription(" ".join(filter(None, reported)))
        self.read_at(self.cursor_s)

    @property
    def _shown(self) -> list["ChartFrame"]:
        return [frame for frame in self.frames if not frame.isHidden()]

    def show_whole(self) -> None:
        self._see(*self.knee.chart.whole_s)

    def zoom(self, share: float) -> None:
        """Keep `share` of the time in sight, about the reading line if it is there."""
        first, last = self.visible_s
        centre = self.cursor_s if self.cursor_s is not None and first <= self.cursor_s <= last else (first + last) / 2
        self._see(centre - (centre - first) * share, centre + (last - centre) * share)

    def go_on(self, share: float) -> None:
        """Go on by `share` of the time in sight; negative goes back."""
        first, last = self.visible_s
        whole = self.knee.chart.whole_s
        step = min(max(share * (last - first), whole[0] - first), whole[1] - last)
        self._see(first + step, last + step)

    def go_to_event(self, is_later: bool) -> None:
        """Put the reading line on the next contact or toe-off of either foot, earlier or later."""
        if not len(self._event_rows):
            return
        first, last = self.visible_s
        at = self.cursor_s if self.cursor_s is not None else (first if is_later else last)
        here = int(np.argmin(np.abs(self._time_s - at)))
        passed = int(np.searchsorted(self._event_rows, here, side="right" if is_later else "left"))
        following = passed if is_later else passed - 1
        if 0 <= following < len(self._event_rows):
            self._go_to(int(self._event_rows[following]))

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.modifiers() & Qt.KeyboardModifier.ControlModifier:
            super().keyPressEvent(event)
            return
        match event.key():
            case Qt.Key.Key_Plus | Qt.Key.Key_Equal:
                self.zoom(ZOOM)
            case Qt.Key.Key_Minus:
                self.zoom(1 / ZOOM)
            case Qt.Key.Key_Home:
                self.show_whole()
            case Qt.Key.Key_PageUp:
                self.go_on(-0.5)
            case Qt.Key.Key_PageDown:
                self.go_on(0.5)
            case Qt.Key.Key_Left | Qt.Key.Key_Right:
                pixels = 10 if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
                self.step(pixels if event.key() == Qt.Key.Key_Right else -pixels)
            case Qt.Key.Key_BracketLeft | Qt.Key.Key_BracketRight:
                self.go_to_event(is_later=event.key() == Qt.Key.Key_BracketRight)
            case _:
                super().keyPressEvent(event)

    def step(self, pixels: int) -> None:
        """Move the reading line by pixels, but at least from sample to sample, and keep it in sight."""
        if len(self._time_s) == 0:
            return
        first, last = self.visible_s
        at = self.cursor_s if self.cursor_s is not None else (first + last) / 2
        here = int(np.searchsorted(self._time_s, at))
        there = int(np.searchsorted(self._time_s, at + pixels * (last - first) / max(self.knee.chart.width(), 1)))
        if there == here:
            there += 1 if pixels > 0 else -1
        self._go_to(min(max(there, 0), len(self._time_s) - 1))

    def _go_to(self, row: int) -> None:
        """Read sample `row`, bring it in sight and say what is there."""
        time_s = float(self._time_s[row])
        self.read_at(time_s)
        first, last = self.visible_s
        if not first <= time_s <= last:
            self.go_on((time_s - (first + last) / 2) / (last - first))
        reported = [*(frame.reading_in_words() for frame in self._shown), self.phases.reading_in_words()]
        stated = " ".join(reported)
        stated = f"{figure_text(time_s, '.2f')} s. {stated}".strip()
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self, stated))

    def _see(self, first_s: float, last_s: float) -> None:
        first, last = self.knee.chart.whole_s
        self.knee.chart.see(max(first_s, first), min(last_s, last))

    def read_at(self, time_s: float | None) -> None:
        """Put the reading line on the sample nearest to `time_s`, None takes it away."""
        row = None
        if time_s is not None and len(self._time_s):
            row = int(np.argmin(np.abs(self._time_s - time_s)))
            time_s = float(self._time_s[row])
        self.cursor_s = time_s
        for frame in (*self.frames, self.phases):
            frame.read(row, time_s)

    def _on_mouse_moved(self, position: QPointF) -> None:
        for frame in self.frames:
            if frame.chart.underMouse():
                time_s = frame.chart.time_at(position.x(), position.y())
                if time_s is not None:
                    self.read_at(time_s)

    def _on_view_moved(self) -> None:
        first, last = self.visible_s
        self.phases.lanes.see(first, last)
        length = self.knee.chart.whole_s[1] - self.knee.chart.whole_s[0]
        stated = tr("Whole recording, {whole} s") if self.is_whole else tr("{first} to {last} s of {whole} s")
        shown = {"first": first, "last": last, "whole": length}
        times = {name: figure_text(time_s, ".1f").replace("-", MINUS) for name, time_s in shown.items()}
        self.view_changed.emit(self.is_whole, stated.format_map(times))


class ChartFrame(Card):
    """A chart with its title, its sign in words, and what is at the reading line."""

    def __init__(self, chart: AngleChart, kind: JointKind) -> None:
        super().__init__(spacing=4)
        self.kind = kind
        self.chart = chart
        self._is_narrow = self._is_wide = False
        self._title = Text(title_in_words(kind), size=16, weight=SEMIBOLD)
        self._sign = Text(sign_in_words(kind), size=12, tone="ink2")
        self.simulated = Text(tr("SIMULATED"), size=12, weight=SEMIBOLD)
        self.moment = Text(size=14, tone="ink2")
        self.keys = {side: SideKey(side) for side in Side}
        self.values = {side: Text(size=15, weight=SEMIBOLD, tone=f"{side}_text") for side in Side}
        self._wide_mark = IconMark(Icon.DIFFERENCE, size=18)
        self.wide = Text(size=12, weight=MEDIUM)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        head = QGridLayout()
        scaled(head.setHorizontalSpacing, 8)
        scaled(head.setVerticalSpacing, 4)
        names = lay_out(QHBoxLayout(), self._title, self._sign, self._wide_mark, self.wide, self.simulated, 1)
        readings = lay_out(QHBoxLayout(), 1, self.moment)
        scaled(names.setSpacing, 8)
        scaled(readings.setSpacing, 8)
        for side in Side:
            readings.addSpacing(12)
            lay_out(readings, self.keys[side], self.values[side])
        self._head = (names, readings)
        self._grid = head
        self._place()
        lay_out(self.column, head, (chart, 1))
        self.set_moment_shown(kind is JointKind.KNEE)
        self._set_widened()
        on_theme(self._reserve_room)

    def set_room(self, *, is_narrow: bool, is_wide: bool) -> None:
        """Put the readings under the title where they do not fit beside it and the words of a widened axis."""
        self._is_narrow, self._is_wide = is_narrow, is_wide
        self._place()

    def set_of_three(self, is_of_three: bool) -> None:
        """Let it be lower, where three charts share the room of two."""
        self.chart.set_of_three(is_of_three)
        above = 6 if is_of_three else 12
        scaled(self.column.setContentsMargins, 16, above, 16, above)
        scaled(self.column.setSpacing, 2 if is_of_three else 4)

    def set_moment_shown(self, is_shown: bool) -> None:
        self.moment.setVisible(is_shown)

    def set_simulated(self, is_simulated: bool) -> None:
        self.simulated.setVisible(is_simulated)

    def show_curves(self, time_s: FloatArray, curves: Mapping[Side, Curve]) -> None:
        self.chart.show_curves(time_s, curves)
        for side in Side:
            for widget in (self.keys[side], self.values[side]):
                widget.setVisible(side in curves)
        self._set_widened()
        self.chart.setAccessibleName(tr("{joint} during the recording").format(joint=title_in_words(self.kind)))
        self.chart.setAccessibleDescription(self.in_words())

    def read(self, row: int | None, time_s: float | None) -> None:
        """Show the values of sample `row`."""
        self.moment.setText("" if time_s is None else f"{figure_text(time_s, '.2f')} s".replace("-", MINUS))
        for side, value in self.values.items():
            curve = self.chart.curves.get(side)
            value.setText("" if row is None or curve is None else _reading(curve, row))
        self._reserve_room()
        self.chart.set_cursor(time_s)

    def reading_in_words(self) -> str:
        return " ".join(
            f"{name_of(self.kind.of(side))} {self.values[side].text()}." for side in Side if side in self.chart.curves
        )

    def in_words(self) -> str:
        """Say each leg's range, for who cannot see the curves."""
        stated = []
        for side, curve in self.chart.curves.items():
            part = part_in_words(side, self.kind)
            if np.isfinite(curve.angle_deg).any():
                lowest, highest = (degrees_in_words(find(curve.angle_deg)) for find in (np.nanmin, np.nanmax))
                reported = tr("{part} from {lowest} to {highest}.")
                stated.append(reported.format(part=part, lowest=lowest, highest=highest))
            else:
                stated.append(tr("{part} has no values.").format(part=part))
        return " ".join(stated) or nothing_in_words(self.kind)

    def _place(self) -> None:
        for part in self._head:
            self._grid.removeItem(part)
        self._grid.addLayout(self._head[0], 0, 0)
        if self._is_narrow or (self.chart.is_widened and not self._is_wide):
            self._grid.addLayout(self._head[1], 1, 0)
        else:
            self._grid.addLayout(self._head[1], 0, 1)

    def _reserve_room(self) -> None:
        """Make the readings as wide as they ever get, so that nothing jumps while the line moves."""
        for label, widest in (
            (self.moment, "1000.00 s"),
            *((value, "\N{MINUS SIGN}100.0° ± 10.0°") for value in self.values.values()),
        ):
            label.setMinimumWidth(label.fontMetrics().horizontalAdvance(widest) if label.text() else 0)

    def _set_widened(self) -> None:
        self.wide.setText(range_in_words(self.chart.range_deg).removesuffix("."))
        self.wide.setVisible(self.chart.is_widened)
        self._wide_mark.setVisible(self.chart.is_widened)
        self._place()


def _reading(curve: Curve, row: int) -> str:
    angle = curve.angle_deg[row]
    if not np.isfinite(angle):
        return tr(NO_VALUE)
    stated = degrees_in_words(angle)
    if curve.sd_deg is not None and np.isfinite(curve.sd_deg[row]):
        stated += f" ± {figure_text(2 * curve.sd_deg[row], '.1f')}°"
    return stated
