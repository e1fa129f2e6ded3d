"""Card of the camera: while it is off, which one it is and from where it looks; while it is on, what it sees now."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QVBoxLayout, QWidget

from app.theme.current import px, scaled
from app.theme.icons import Icon
from app.video.jpeg import JpegDecoder
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import later, tr

VIEWS = (later("from the left"), later("from the right"), later("from the front"), later("from behind"))
MODES = ((1280, 720, 30), (1280, 720, 15), (640, 360, 30), (640, 360, 15))  # px wide and high, frames a second
WIDE, HIGH = 232, 119  # px of the design: what one camera sees
CONTROL = 40


@dataclass(frozen=True, slots=True)
class CameraShown:
    """What the card shows.

    `cameras`: names of what can be chosen, one or both of two; `chosen` is one of them, `views` from where each looks.
    `lost`: numbers, from 1, of those that ended while they were on. `needs_consent`: the patient has not agreed yet, so
    no camera runs. `facts`: what is written now, or how it is sent.
    """

    cameras: tuple[str, ...]
    chosen: int
    views: tuple[str, ...]
    mode: tuple[int, int, int]
    lost: frozenset[int] = frozenset()
    is_on: bool = False
    is_recording: bool = False
    needs_consent: bool = False
    has_consent: bool = False
    facts: str = ""
    what: str = ""
    then: str = ""


class CameraCard(Card):
    turned = Signal(bool)
    agreed = Signal()
    withdrawn = Signal()
    camera_chosen = Signal(int)
    view_chosen = Signal(int, str)  # of which of the two cameras
    mode_chosen = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self._title = Text(tr("Camera"), size=16, weight=SEMIBOLD)
        self.switch = Toggle(tr("Off"), "", is_on=False)
        self.switch.set_face(height=CONTROL)
        self.pictures = (_Preview(), _Preview())
        self.facts = Text(size=12, tone="ink2", wraps=True)
        self.notice = Notice(size=13)
        self.agree = Button(tr("Patient agrees"), ButtonKind.SECONDARY, Icon.CHECK, height=44)
        self.withdraw = Button(tr("Withdraw consent"), ButtonKind.QUIET, height=44)
        self.camera = Choice(tr("Camera"))
        self.views = (Choice(tr("Position of the camera")), Choice(tr("Position of the second camera")))
        self.mode = Choice(tr("Resolution and rate"))
        self._choices = QWidget()
        self._build()
        self.switch.toggled.connect(self.turned)
        self.agree.clicked.connect(self.agreed)
        self.withdraw.clicked.connect(self.withdrawn)
        self.camera.activated.connect(self.camera_chosen)
        self.mode.activated.connect(lambda _index: self.mode_chosen.emit(self.mode.currentData()))
        for number, view in enumerate(self.views):
            view.activated.connect(lambda _index, number=number: self._on_view_chosen(number))

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.switch, self.agree, self.camera, *self.views, self.mode, self.withdraw]

    def show_camera(self, shown: CameraShown) -> None:
        self.switch.show_on(shown.is_on)
        self.switch.setText(tr("On") if shown.is_on else tr("Off"))
        self.switch.setEnabled(not shown.is_recording)
        self.switch.setAccessibleName(tr("Camera"))
        has_two = len(shown.views) > 1
        for number, picture in enumerate(self.pictures):
            is_live = shown.is_on and number + 1 not in shown.lost
            picture.setVisible(is_live and not shown.needs_consent and number < len(shown.views))
            if not is_live:
                picture.clear()
        self.facts.setText(shown.facts or tr("Camera is off."))
        self.facts.setVisible(bool(shown.facts) or not shown.is_on)
        self._show_message(shown)
        self.agree.setVisible(shown.needs_consent)
        self._choices.setVisible(not shown.is_on)
        self.withdraw.setVisible(shown.has_consent and not shown.is_on)
        self.camera.offer([(name, number) for number, name in enumerate(shown.cameras)], shown.chosen)
        self.camera.setVisible(len(shown.cameras) > 1)
        for number, (view, box) in enumerate(zip(shown.views, self.views, strict=False)):
            box.offer([(tr(one), one) for one in VIEWS], view)
            box.setVisible(number == 0 or has_two)
        self.views[1].setVisible(has_two)
        self.mode.offer([(_mode_words(one), one) for one in MODES], shown.mode)

    def show_now(self, facts: str, jpegs: Sequence[bytes]) -> None:
        """Show what each camera sees now, as far as there is anything, and how it is recorded."""
        if facts and facts != self.facts.text():
            self.facts.setText(facts)
        for picture, jpeg in zip(self.pictures, jpegs, strict=False):
            if jpeg:
                picture.show_jpeg(jpeg)

    def _show_message(self, shown: CameraShown) -> None:
        what, then = shown.what, shown.then
        if not what and shown.needs_consent:
            what = tr("The patient has not agreed to video yet.")
            then = tr("Ask before the first video. Who asked, and when, is stored with the patient.")
        elif not what and shown.is_on:
            what = tr("Faces are recorded.")
            then = "" if shown.is_recording else tr("Video stays in this library.")  # the curves need the height
        self.notice.show_message(Icon.WARNING if shown.what else Icon.INFO, what, then, is_caution=True)
        self.notice.setVisible(bool(what))

    def _on_view_chosen(self, number: int) -> None:
        self.view_chosen.emit(number, str(self.views[number].currentData()))

    def _build(self) -> None:
        self.setAccessibleName(tr("Camera"))
        words = lay_out(QVBoxLayout(), self._title, self.facts, spacing=0)
        head = lay_out(QHBoxLayout(), (words, 1), self.switch, spacing=8)
        grid = QGridLayout(self._choices)
        grid.setContentsMargins(0, 0, 0, 0)
        for row, choice in enumerate((self.camera, *self.views, self.mode)):
            choice.let_shrink(120, WIDE)
            choice.set_height(CONTROL)
            grid.addWidget(choice, row, 0, Qt.AlignmentFlag.AlignLeft)
        scaled(grid.setSpacing, 8)
        seen = lay_out(QVBoxLayout(), *self.pictures, spacing=4)
        lay_out(self.column, head, seen, self.notice, self.agree, self._choices, self.withdraw)


class _Preview(QLabel):
    """What a camera sees, decoded no larger than it is shown."""

    def __init__(self) -> None:
        super().__init__()
        self._decoder = JpegDecoder()
        self.setAccessibleName(tr("Picture of the camera"))
        scaled(self.setMinimumHeight, HIGH)
        self.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.hide()

    def show_jpeg(self, jpeg: bytes) -> None:
        if not self.isVisible():
            return
        image = self._decoder.decoded(jpeg, QSize(min(self.width(), px(2 * WIDE)), px(HIGH)) * self.devicePixelRatio())
        image.setDevicePixelRatio(self.devicePixelRatio())
        if not image.isNull():  # a damaged frame is passed over: the next comes in a moment
            self.setPixmap(QPixmap.fromImage(image))


def _mode_words(mode: Sequence[int]) -> str:
    width, height, rate = mode
    return tr("{width} x {height}, {rate}/s").format(width=width, height=height, rate=rate)
