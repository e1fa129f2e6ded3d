"""Page of standing still:

whether the patient keeps still, and at which angles. It has a count read from six metres, and what the goniometer
states.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum, auto

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.theme.current import on_theme, px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button
from app.widgets.card import Card
from app.widgets.field import NumberField
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.reading_area import scrolled
from app.widgets.stillness import INSET, STEPS, CountRing, MovementBars, RingFace
from app.widgets.text import MEDIUM, SEMIBOLD, Text
from app.wording.body import name_of
from app.wording.translation import capitalised, tr, tr_n
from core.body import LEG_JOINTS, Joint, Side, Site
from core.calibration.rest import MAX_SPREAD_RAD_S
from core.live.standing import REQUIRED_S

KNEE_DEG, ANKLE_DEG = (-60.0, 150.0), (-60.0, 60.0)  # what a goniometer can be laid along
MOVED_FOR_S = 1.0  # who moved is named until the count has come this far again
OFFERED_AFTER = 3  # restarts
READING = (Joint.LEFT_KNEE, Joint.RIGHT_KNEE, Joint.LEFT_ANKLE, Joint.RIGHT_ANKLE)
TITLE, LARGE_TITLE, COMPACT_TITLE = 60, 72, 32
LARGE_FROM = 1500
ZERO_WIDTH, COMPACT_ZERO_WIDTH = 328, 264
BARS_WIDTH, LARGE_BARS_WIDTH, COMPACT_BARS_WIDTH = 268, 400, 240
SCROLL_BAR = 12


class StandPhase(Enum):
    READY = auto()
    COUNTING = auto()
    DONE = auto()
    SKIPPED = auto()


@dataclass(frozen=True, slots=True)
class StandStillView:
    """What the standing looks like now.

    `movement_deg_s`: of the worn sensors, by site, or by name where nobody knows the site yet: from the limit on they
    move.
    """

    phase: StandPhase = StandPhase.READY
    still_s: float = 0.0
    required_s: float = REQUIRED_S
    movement_deg_s: Mapping[str, float] = field(default_factory=dict)
    limit_deg_s: float = math.degrees(MAX_SPREAD_RAD_S)
    moved: tuple[str, ...] = ()  # who made the count begin again last
    silent: tuple[str, ...] = ()  # the sensors from which nothing is received
    restarts: int = 0  # how often it began again by itself
    is_read_back: bool = True  # once it is done: whether what was recorded has been read back, and counts

    @property
    def moving(self) -> tuple[str, ...]:
        """Sensors at or beyond the limit as shown, and for a moment those that were."""
        is_waiting = self.phase in (StandPhase.READY, StandPhase.COUNTING)
        named = self.moved if is_waiting and self.still_s < MOVED_FOR_S else ()
        now = (name for name, moves in self.movement_deg_s.items() if self.limit_deg_s <= moves < math.inf)
        return (*named, *(name for name in now if name not in named))

    @property
    def is_known(self) -> bool:
        """Whether enough was received from all sensors to show whether they move."""
        return bool(self.movement_deg_s) and all(map(math.isfinite, self.movement_deg_s.values()))


class StandStillPage(QWidget):
    """Words go L then R.

    `cannot_stand_pressed`, `can_stand_pressed`: the patient cannot, or can after all.
    """

    cannot_stand_pressed = Signal()
    can_stand_pressed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self._view = StandStillView()
        self._is_compact = False
        self._count = Card(padding=24, spacing=4)
        self._title = Text(size=TITLE, weight=SEMIBOLD)
        self._how = Text(size=20, tone="ink2", wraps=True)
        self._ring = CountRing()
        self._limit = Text(size=14, tone="ink2")
        self.bars = MovementBars()
        self.verdict = Notice()
        self._build_count()
        self.zero = _ZeroCard()
        self.zero.button.clicked.connect(self._on_button_clicked)
        self._row = lay_out(QHBoxLayout(self), (self._count, 1), self.zero)
        on_theme(self._fit)
        self.set_compact(False)

    @property
    def view(self) -> StandStillView:
        """What is shown."""
        return self._view

    @property
    def tab_order(self) -> list[QWidget]:
        return self.zero.tab_order

    def focus(self) -> None:
        """Leave the focus to the bar: in a field of this page Space would be written, and not start the count."""
        for one in self.zero.fields.values():
            one.line_edit.clearFocus()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        self.bars.set_compact(is_compact)
        self.zero.set_compact(is_compact)
        across, down = (16, 10) if is_compact else (24, 20)
        scaled(self._row.setContentsMargins, across, down, across, down)
        scaled(self._row.setSpacing, 12 if is_compact else 16)
        scaled(self._middle.setSpacing, 12 if is_compact else 24)
        scaled(self._count.column.setContentsMargins, *((16, 10, 16, 10) if is_compact else (24, 18, 24, 18)))
        self._fit()
        self._show()

    def show_state(self, view: StandStillView) -> None:
        """Show how the standing goes; only what changed is painted again."""
        if view != self._view:
            self._view = view
            self._show()

    def _show(self) -> None:
        view = self._view
        self._title.setText(title(view))
        self._how.setText(instruction(view))
        self._ring.show_face(ring_face(view))
        self._limit.setText(tr("limit {limit:.1f} °/s").format(limit=view.limit_deg_s))
        self.bars.show_movement(view.movement_deg_s, view.limit_deg_s, view.moving, view.silent)
        icon, what, then, is_caution = verdict(view, self._is_compact)
        self.verdict.show_message(icon, what, then, is_caution)
        self.zero.show_standing(view)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def _build_count(self) -> None:
        now = Text(tr("Movement now"), size=14, weight=MEDIUM)
        above = lay_out(QHBoxLayout(), (now, 1), self._limit, margins=(INSET, 0, INSET, 0))
        side = lay_out(QVBoxLayout(), 1, above, self.bars, self.verdict, 1, spacing=8)
        self._middle = lay_out(QHBoxLayout(), (self._ring, 1), side)
        lay_out(self._count.column, self._title, self._how, (self._middle, 1))
        self._count.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def _on_button_clicked(self) -> None:
        (self.can_stand_pressed if self._view.phase is StandPhase.SKIPPED else self.cannot_stand_pressed).emit()

    def _fit(self) -> None:
        is_large = not self._is_compact and self.width() >= px(LARGE_FROM)
        self._title.set_size(COMPACT_TITLE if self._is_compact else LARGE_TITLE if is_large else TITLE)
        self._how.set_size(16 if self._is_compact else 24 if is_large else 20)
        bars_width = COMPACT_BARS_WIDTH if self._is_compact else LARGE_BARS_WIDTH if is_large else BARS_WIDTH
        for one in (self.bars, self.verdict):
            one.setFixedWidth(px(bars_width))
        width = px(COMPACT_ZERO_WIDTH if self._is_compact else ZERO_WIDTH)
        self.zero.setFixedWidth(max(width, self.zero.least_width))


class _ZeroCard(Card):
    """The angles of the patient in standing, and the way round the standing. The fields scroll where they must."""

    edited = Signal(object, object)  # joint and degrees; None where nothing is in the field any more

    def __init__(self) -> None:
        super().__init__(padding=20, spacing=12)
        self._inside = QWidget()
        self._grid = QGridLayout()
        scaled(self._grid.setHorizontalSpacing, 12)
        scaled(self._grid.setVerticalSpacing, 6)
        self._is_compact = False
        self._view = StandStillView()
        self._worn: frozenset[Joint] = frozenset(LEG_JOINTS)
        self.fields: dict[Joint, NumberField] = {}
        named = Text(tr("Standing angle"), size=20, weight=SEMIBOLD)
        explained = tr("Enter 0° if the joint is straight now. With a contracture, enter the goniometer value.")
        how = Text(explained, size=14, tone="ink2", wraps=True)
        self._add_joint(tr("Knee"), tr("flexion is +"), tr("Knee flexion"), KNEE_DEG, is_knee=True)
        self._add_joint(tr("Ankle"), tr("dorsiflexion is +"), tr("Ankle dorsiflexion"), ANKLE_DEG, is_knee=False)
        self._why = Text(size=14, tone="ink2", wraps=True)
        lay_out(QVBoxLayout(self._inside), named, how, self._grid, self._why, 1, margins=0, spacing=8)
        fields = scrolled(self._inside)
        fields.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Ignored)
        self.note = Notice(size=14)
        self.button = Button(tr("Patient cannot stand still"))
        lay_out(self.column, (fields, 1), self.note, self.button)
        self._show()

    @property
    def tab_order(self) -> list[QWidget]:
        return [*(self.fields[joint].line_edit for joint in READING), self.button]

    @property
    def why(self) -> str:
        """Why a field cannot be typed into; empty where all can."""
        return self._why.text()

    @property
    def least_width(self) -> int:
        """What the fields, the button and their margins take at least."""
        margins, bar = self.column.contentsMargins(), px(SCROLL_BAR)
        inside = max(self._inside.minimumSizeHint().width() + bar, self.button.sizeHint().width())
        return inside + margins.left() + margins.right()

    def set_compact(self, is_compact: bool) -> None:
        self._is_compact = is_compact
        scaled(self.column.setContentsMargins, *((16, 12, 16, 12) if is_compact else (20, 16, 20, 20)))
        self._show()

    def show_zero(self, zero_deg: Mapping[Joint, float]) -> None:
        """Show the goniometer's angle of each joint that has its sensors; the others have no field to type into."""
        self._worn = frozenset(zero_deg)
        for joint, one in self.fields.items():
            one.set_value(zero_deg.get(joint))
        self._show()

    def show_standing(self, view: StandStillView) -> None:
        is_same = (view.phase, view.restarts) == (self._view.phase, self._view.restarts)
        self._view = view
        if not is_same:
            self._show()

    def _show(self) -> None:
        is_skipped = self._view.phase is StandPhase.SKIPPED
        for joint, one in self.fields.items():
            one.setEnabled(joint in self._worn and not is_skipped)
        missing = [joint for joint in READING if joint not in self._worn]
        why = tr("Without standing there is no standing reference.") if is_skipped else _no_field(missing)
        self._why.setText(why)
        self._why.setVisible(bool(why))
        cannot = tr("Patient cannot stand still")
        self.button.setText(tr("Patient can stand still") if is_skipped else cannot)
        self.button.updateGeometry()
        icon, what, then, is_caution = way_round(self._view, self._is_compact)
        self.note.show_message(icon, what, then, is_caution)

    def _add_joint(self, name: str, sign: str, label: str, range_deg: tuple[float, float], is_knee: bool) -> None:
        row = self._grid.rowCount()
        words, way = Text(name, size=14, weight=MEDIUM), Text(sign, size=12, tone="ink2")
        below = Qt.AlignmentFlag.AlignBottom
        heading = lay_out(QHBoxLayout(), (words, 1), (way, 0, below), margins=(0, 8, 0, 0))
        self._grid.addLayout(heading, row, 0, 1, 2)
        for column, side in enumerate((Side.LEFT, Side.RIGHT)):
            joint = next(joint for joint in LEG_JOINTS if joint.side is side and joint.is_knee == is_knee)
            low, high = range_deg
            one = _ZeroField(joint, label, low, high)
            one.reported.connect(self.edited)
            self.fields[joint] = one
            self._grid.addWidget(one, row + 1, column, Qt.AlignmentFlag.AlignTop)


class _ZeroField(NumberField):
    """One joint's angle; `reported` gives the joint with it."""

    reported = Signal(object, object)

    def __init__(self, joint: Joint, label: str, low: float, high: float) -> None:
        super().__init__(label, low=low, high=high, decimals=1, unit="°", side=joint.side, has_label=False)
        self._joint = joint
        self.committed.connect(self._on_committed)

    def _on_committed(self) -> None:
        if not self.is_wrong:
            self.reported.emit(self._joint, self.value)


def title(view: StandStillView) -> str:
    """Say in two words what is asked for."""
    return tr("ROM only") if view.phase is StandPhase.SKIPPED else tr("Stand still")


def instruction(view: StandStillView) -> str:
    """Say how, or what came of it."""
    if view.phase is StandPhase.SKIPPED:
        return tr("The patient cannot stand. Range of motion is reported, absolute angles are not.")
    if view.phase is StandPhase.DONE:
        stated = tr("Still for {still:.1f} s. Gyroscope offset and standing reference are set.")
        if not view.is_read_back:
            stated = tr("Still for {still:.1f} s. The recording is being loaded.")
        return stated.format(still=view.still_s)
    return tr("Both feet are flat, the patient looks ahead. Holding a rail is fine.")


def ring_face(view: StandStillView) -> RingFace:
    """Choose what the ring shows."""
    if view.phase is StandPhase.SKIPPED:
        return RingFace(word=tr("skipped"), is_dotted=True)
    if view.phase is StandPhase.DONE:
        return RingFace(share=1.0, icon=Icon.CHECK)
    if view.phase is StandPhase.READY:
        return RingFace(figure=f"{math.ceil(view.required_s)}", word=tr("starts"), key=tr("Space"))
    left_s = max(1, math.ceil(view.required_s - view.still_s - 1e-9))
    share = round(min(view.still_s / view.required_s, 1.0) * STEPS) / STEPS
    return RingFace(share, f"{left_s}", word=tr("second") if left_s == 1 else tr("seconds"))


def verdict(view: StandStillView, is_short: bool = False) -> tuple[Icon | None, str, str, bool]:
    """Say whether all are still: icon, what is so, what follows, and whether it needs a look."""
    if view.phase is StandPhase.SKIPPED or not view.movement_deg_s:
        return None, "", "", False
    if view.phase is StandPhase.DONE:
        is_still = view.is_known and not view.moving
        what = _all_still(len(view.movement_deg_s)) if is_still else tr("Standing is recorded")
        return Icon.CHECK, what, tr("Continues automatically."), False
    if view.silent == (Site.PELVIS,):
        goes_on = tr("The countdown continues; hip angles will be missing.")
        return Icon.SILENT, tr("Pelvis: no signal"), tr("No hip angles.") if is_short else goes_on, True
    if view.silent:
        what = tr("{sites}: no signal").format(sites=_names(view.silent))
        waits = tr("The countdown is paused.")
        return Icon.SILENT, what, waits if is_short else f"{waits} {tr('Switch the sensor off and on.')}", True
    if view.moving:
        what = tr("{sites} moving").format(sites=_names(view.moving))
        return Icon.WAVE, what, _moved(view), True
    if not view.is_known:
        return None, "", "", False
    then = "" if is_short else tr("Movement restarts the countdown.")  # in a small window the countdown shows it
    return Icon.CHECK, _all_still(len(view.movement_deg_s)), then, False


def way_round(view: StandStillView, is_short: bool = False) -> tuple[Icon | None, str, str, bool]:
    """Say what follows without the standing; after some restarts offer to go on so."""
    if view.phase is StandPhase.SKIPPED:
        return Icon.INFO, "", tr("The report states that there is no standing reference."), False
    if view.restarts >= OFFERED_AFTER and view.phase is not StandPhase.DONE:
        what = tr("The countdown restarted {count} times.").format(count=view.restarts)
        if is_short:
            return Icon.WARNING, what, tr("Without standing there are no absolute angles."), True
        then = tr("If the patient cannot stand, range of motion is reported, absolute angles are not.")
        return Icon.WARNING, what, then, True
    range_only = tr("Without this step there are no absolute angles.")
    then = (
        range_only if is_short else " ".join([tr("The report states how the standing reference was set."), range_only])
    )
    return Icon.INFO, "", then, False


def _moved(view: StandStillView) -> str:
    """What follows where something is counted."""
    return tr("The countdown restarts automatically.") if view.phase is StandPhase.COUNTING else ""


def _all_still(count: int) -> str:
    return tr_n("{count} sensor still", "All {count} sensors still", count).format(count=count)


def _names(sensors: Sequence[str]) -> str:
    names = [name_of(Site(sensor)) if sensor in set(Site) else sensor for sensor in sensors]
    if len(names) > 2:  # more cannot be read in the time
        return tr("{count} sensors").format(count=len(names))
    stated = tr("{first} and {last}").format(first=names[0], last=names[1]) if len(names) == 2 else names[0]
    return capitalised(stated) if sensors[0] in set(Site) else stated


def _no_field(joints: Sequence[Joint]) -> str:
    if not joints:
        return ""
    names = ", ".join(name_of(joint) for joint in joints)
    return tr("Sensor missing above or below the joint: {joints}.").format(joints=names)
