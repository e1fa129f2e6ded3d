"""What the clinician sets for the patient's screen, in one place: movement, side, target, tone and metronome."""

from collections.abc import Iterable, Mapping

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QSizePolicy, QWidget

from app.patient_screen.metronome import LEAST, MOST
from app.theme.current import px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.field import NumberField
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.segmented import Segmented
from app.widgets.text import Text
from app.widgets.toggle import Toggle
from app.wording.body import side_name
from app.wording.translation import tr
from core.body import Side
from core.targets import Target, TargetMeasure

NARROW_BELOW = 980
FIELD_WIDTH, FIELD_HEIGHT = 120, 48
Choice = tuple[TargetMeasure, Side | None]
ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
AT_FOOT = Qt.AlignmentFlag.AlignBottom


def choices() -> tuple[Choice, ...]:
    """Every measure of every leg that it can be of."""
    return tuple(
        (measure, side) for measure in TargetMeasure for side in (tuple(Side) if measure.has_side else (None,))
    )


def measure_words(measure: TargetMeasure) -> str:
    return {
        TargetMeasure.KNEE_SWING_PEAK: tr("Knee in swing"),
        TargetMeasure.FOOT_STRIKE: tr("Foot at contact"),
        TargetMeasure.STANCE_RATIO: tr("Stance symmetry"),
        TargetMeasure.CADENCE: tr("Cadence"),
    }[measure]


def choice_words(choice: Choice) -> str:
    """Name a measure with its leg: "Knee in swing, left"."""
    measure, side = choice
    return measure_words(measure) if side is None else f"{measure_words(measure)}, {side_name(side)}"


class ControlsCard(Card):
    """No target is proposed: there is none until one is typed. It is of a measure, and stays as the side changes.

    Enter goes from a choice to the target, and sets what is typed; in the metronome's field it starts or changes it.
    """

    target_set = Signal(object)  # target, or None where nothing that fits is typed
    tone_set = Signal(bool)  # whether a tone is to sound where the target is reached
    metronome_pressed = Signal(int)  # its rate in steps per minute; 0: be silent
    offered = Signal()  # it has come into sight, or is gone

    def __init__(self) -> None:
        super().__init__()
        self._typed: dict[TargetMeasure, int] = {}
        self._reasons: Mapping[Choice, str] = {}
        self._is_ticking = self._is_judging = False
        self._asked = choices()[0]  # what somebody chose, though it may not be possible now
        self.measure = Segmented(tr("Movement"), [(key, measure_words(key), "") for key in TargetMeasure])
        self.side = Segmented(tr("Side"), [(Side.LEFT, tr("Left"), ""), (Side.RIGHT, tr("Right"), "")])
        low, high = TargetMeasure.KNEE_SWING_PEAK.limits
        self.target = NumberField(tr("Target"), low=low, high=high, unit="°", states_wrong=False)
        self.tone = Toggle(tr("Tone"), "", is_on=True)
        self.rate = NumberField(tr("Metronome"), low=LEAST, high=MOST, unit=tr("/min"), states_wrong=False)
        self.tick = Button(tr("Start metronome"), ButtonKind.SECONDARY, Icon.SOUND)
        self.full = Button(tr("Full screen"), ButtonKind.QUIET, Icon.WHOLE, key="F11")
        self.close_screen = Button(tr("Close"), ButtonKind.QUIET, Icon.CLOSE, key="F8")
        self.tone.set_face(height=FIELD_HEIGHT)
        self._wrong, self._status, self._sound = Notice(size=16), Notice(size=16), Notice(size=16)
        self._gated = Text(size=14, tone="ink2", wraps=True)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Maximum)
        self.setAccessibleName(tr("Patient screen"))
        self._build()
        self.measure.chosen.connect(self._on_chosen)
        self.side.chosen.connect(self._on_chosen)
        self.target.committed.connect(self._on_target_committed)
        self.tone.toggled.connect(self.tone_set)
        self.rate.line_edit.returnPressed.connect(self._on_rate_entered)
        self.rate.committed.connect(self._on_rate_committed)
        for field in (self.target, self.rate):
            field.edited.connect(self._show_wrong)
            field.committed.connect(self._show_wrong)
        self.tick.clicked.connect(self._on_tick_clicked)
        self.show_sound("", "")
        self._show()

    def _build(self) -> None:
        for field in (self.target, self.rate):
            scaled(field.setFixedWidth, FIELD_WIDTH)
        tone, tick, full, close = ((one, 0, AT_FOOT) for one in (self.tone, self.tick, self.full, self.close_screen))
        self._choose = lay_out(QBoxLayout(ACROSS), (self.measure, 1), self.side, spacing=12)
        typed = lay_out(QHBoxLayout(), self.target, tone, self.rate, 1, spacing=12)
        acts = lay_out(QHBoxLayout(), tick, 1, full, close, spacing=12)
        self._set = lay_out(QBoxLayout(ACROSS), typed, (acts, 1), spacing=12)
        stated = ((one, 1, Qt.AlignmentFlag.AlignTop) for one in (self._wrong, self._status, self._sound))
        self._say = lay_out(QBoxLayout(ACROSS), *stated, spacing=12)
        lay_out(self.column, self._choose, self._set, self._say, self._gated)

    @property
    def controls(self) -> list[QWidget]:
        """In the order of reading."""
        aimed, ticking = [self.target.line_edit, self.tone], [self.rate.line_edit, self.tick]
        return [*self.measure.segments, *self.side.segments, *aimed, *ticking, self.full, self.close_screen]

    @property
    def choice(self) -> Choice:
        measure = TargetMeasure(self.measure.choice)
        return measure, Side(self.side.choice) if measure.has_side else None

    @property
    def reason(self) -> str:
        """Why the chosen measure cannot be a target; empty where it can."""
        return self._reasons.get(self.choice, "")

    def offer(self, is_offered: bool) -> None:
        """Be there while the patient's screen is."""
        self.setVisible(is_offered)
        self.offered.emit()

    def focus(self) -> None:
        """Put the focus on the movement, which is chosen before its target is typed."""
        self.measure.focus()

    def show_reasons(self, reasons: Mapping[Choice, str]) -> None:
        """Say of each choice that cannot be a target why; a measure that no leg allows cannot be chosen at all."""
        if reasons == self._reasons:
            return
        self._reasons = dict(reasons)
        if self.reason:  # the side that takes its place is nobody's choice
            self._typed.pop(self.choice[0], None)
        gated = {m for m in TargetMeasure if all(choice in reasons for choice in choices() if choice[0] is m)}
        self._is_judging = True
        if gated != set(TargetMeasure):  # one has to be chosen, whatever it is worth
            for measure in TargetMeasure:
                self.measure.set_reason(measure, tr("not available") if measure in gated else "")
        self._go_back()
        self._gated.setText("\n".join(_gated_lines(reasons)))
        self._gated.setVisible(bool(reasons))
        self._show()
        self._is_judging = False
        self._show_message()

    def _go_back(self) -> None:
        """To what was chosen by hand, once that can be a target again and nothing else has become one."""
        measure, side = self._asked
        if self._asked in self._reasons or self.choice[0] in self._typed:
            return
        self.measure.choose(measure)
        if side is not None:
            self.side.set_reason(side, "")
            self.side.choose(side)

    def show_status(self, what: str, then: str, *, is_caution: bool = False) -> None:
        """Say what the patient sees now, or why it is nothing, and what to do."""
        self._status.show_message(Icon.WARNING if is_caution else Icon.INFO, what, then, is_caution=is_caution)

    def show_sound(self, what: str, then: str) -> None:
        """Say why tone and metronome are inaudible; nothing takes it back."""
        self._sound.show_message(Icon.SOUND_OFF, what, then)
        self._sound.setVisible(bool(what))

    def show_metronome(self, beats_per_min: int) -> None:
        self._is_ticking = bool(beats_per_min)
        self.tick.setText(tr("Stop metronome") if self._is_ticking else tr("Start metronome"))
        self.tick.setAccessibleName(self.tick.text())
        self.tick.updateGeometry()

    def show_full(self, is_full: bool) -> None:
        """Name what F11 does: fill the screen, or give it free."""
        self.full.setText(tr("Small window") if is_full else tr("Full screen"))
        self.full.setAccessibleName(self.full.text())
        self.full.updateGeometry()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Enter sets what is typed, and goes from a choice to it; it is not for the verb of the page."""
        if event.key() not in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            super().keyPressEvent(event)
            return
        event.accept()
        if self.focusWidget() in (*self.measure.segments, *self.side.segments):
            self.target.line_edit.setFocus()
            self.target.line_edit.selectAll()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        is_narrow = self.width() < px(NARROW_BELOW)
        for row in (self._choose, self._set, self._say):
            row.setDirection(DOWN if is_narrow else ACROSS)

    def _show(self) -> None:
        """Show the field of the chosen measure, and which sides it can be of."""
        measure = self.choice[0]
        self.side.setVisible(measure.has_side)
        if measure.has_side:
            gated = [one for one in Side if (measure, one) in self._reasons]
            for one in Side:  # one has to be chosen, whatever it is worth
                self.side.set_reason(one, tr("not available") if gated == [one] else "")
        self.target.low, self.target.high = measure.limits
        units = {"deg": "°", "%": "%", "steps/min": tr("/min")}
        self.target.set_unit(units[measure.unit])
        self.target.set_value(self._typed.get(measure))
        self.target.setEnabled(not self.reason)
        self._show_wrong()

    def _show_wrong(self) -> None:
        """Say below the row what is wrong in its narrow fields."""
        wrong = next((field for field in (self.target, self.rate) if field.is_wrong), None)
        self._wrong.setVisible(wrong is not None)
        self._status.setVisible(wrong is None)
        if wrong is not None:
            self._wrong.show_message(Icon.WARNING, wrong.wrong, "")

    def _show_message(self) -> None:
        measure, side = self.choice
        value = None if self.reason else self._typed.get(measure)
        self.target_set.emit(None if value is None else Target(measure, side, value))

    def _on_chosen(self) -> None:
        if self._is_judging:
            return  # nobody's choice; it is shown once all is judged
        self._asked, self._is_judging = self.choice, True
        self._show()
        self._is_judging = False
        self._show_message()

    def _on_target_committed(self) -> None:
        value, measure = self.target.value, self.choice[0]
        if value is None:
            self._typed.pop(measure, None)
        else:
            self._typed[measure] = round(value)
            self._asked = self.choice
        self._show_message()

    def _on_rate_entered(self) -> None:
        if self.rate.value is not None:
            self.metronome_pressed.emit(round(self.rate.value))
        elif not self.rate.text.strip():
            self.metronome_pressed.emit(0)

    def _on_rate_committed(self) -> None:
        """A rate that is left with Tab is gone over to, and starts nothing."""
        if self._is_ticking and self.rate.value is not None:
            self.metronome_pressed.emit(round(self.rate.value))

    def _on_tick_clicked(self) -> None:
        if self._is_ticking:
            self.metronome_pressed.emit(0)
        elif self.rate.value is not None:
            self.metronome_pressed.emit(round(self.rate.value))
        else:
            self.rate.set_wrong(tr("Enter the steps per minute."))
            self._show_wrong()


def _gated_lines(reasons: Mapping[Choice, str]) -> Iterable[str]:
    """A line for each reason, with all that cannot be a target for it; a measure of both legs is named once."""
    for reason in dict.fromkeys(reasons.values()):
        gated = [choice for choice in choices() if reasons.get(choice) == reason]
        measures = [measure for measure, _ in gated]
        names = [
            measure_words(choice[0]) if measures.count(choice[0]) == len(Side) else choice_words(choice)
            for choice in gated
        ]
        yield tr("{names} cannot be a target: {reason}").format(names="; ".join(dict.fromkeys(names)), reason=reason)
