"""What moves a clip: play and pause, how fast, one stride again and again, and steps from moment to moment."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QWidget

from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.wording.translation import later, tr
from core.body import Side
from core.video.moments import Moment

HEIGHT = 44
STEPPED = (158, 260)  # px: the narrowest and the widest that the choice of moments becomes
SPEEDS = {"quarter": 0.25, "half": 0.5, "whole": 1.0}
MOMENT_WORDS = {
    Moment.INITIAL_CONTACT: later("initial contact"),
    Moment.TOE_OFF: later("toe-off"),
    Moment.PEAK_KNEE_FLEXION: later("peak knee flexion"),
}
STEPS = tuple((side, moment) for moment in MOMENT_WORDS for side in Side)


class TransportRow(QWidget):
    """`stepped` gives -1 to the earlier moment of the chosen kind, 1 to the later one."""

    stepped = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.play = Button("", ButtonKind.SECONDARY, Icon.PLAY, height=HEIGHT)
        self.loop = Button("", ButtonKind.QUIET, Icon.REPEAT, height=HEIGHT)
        self.loop.setCheckable(True)
        self.speeds = Segmented(tr("Speed"), [("quarter", "¼", ""), ("half", "½", ""), ("whole", "1 ×", "")])
        self.earlier = Button("", ButtonKind.QUIET, Icon.BACK, height=HEIGHT)
        self.later = Button("", ButtonKind.QUIET, Icon.NEXT, height=HEIGHT)
        self.moments = Choice(tr("Step to"))
        self.moments.let_shrink(*STEPPED)
        self.moments.set_height(HEIGHT)
        words = (
            tr("{side} {moment}").format(side=side.letter, moment=tr(MOMENT_WORDS[moment])) for side, moment in STEPS
        )
        self.moments.offer([(one, number) for number, one in enumerate(words)], 0)
        for button, name, key in (
            (self.loop, tr("Loop stride"), tr("L")),
            (self.earlier, tr("Earlier moment"), tr("Page Up")),
            (self.later, tr("Later moment"), tr("Page Down")),
        ):
            _name(button, name, key)
        self.show_playing(is_playing=False)
        stepper = lay_out(QHBoxLayout(), self.earlier, (self.moments, 1), self.later, margins=0, spacing=2)
        lay_out(QHBoxLayout(self), self.play, self.loop, self.speeds, (stepper, 1), margins=0, spacing=8)
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.earlier.clicked.connect(lambda: self.stepped.emit(-1))
        self.later.clicked.connect(lambda: self.stepped.emit(1))

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.play, self.loop, *self.speeds.segments, self.earlier, self.moments, self.later]

    @property
    def speed(self) -> float:
        return SPEEDS[self.speeds.choice]

    @property
    def chosen(self) -> tuple[Side, Moment]:
        return STEPS[self.moments.currentIndex()]

    def choose(self, side: Side, moment: Moment) -> None:
        self.moments.setCurrentIndex(STEPS.index((side, moment)))

    def show_playing(self, *, is_playing: bool) -> None:
        self.play.set_face(icon=Icon.PAUSE if is_playing else Icon.PLAY)
        _name(self.play, tr("Pause") if is_playing else tr("Play"), tr("Space"))


def _name(button: Button, name: str, key: str) -> None:
    """Name a button of an icon alone: for readers of screens, and under the mouse."""
    button.setAccessibleName(name)
    button.setAccessibleDescription(tr("Key {key}").format(key=key))
    button.setToolTip(tr("{name} ({key})").format(name=name, key=key))
