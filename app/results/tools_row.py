"""Row of tools over the results: views, what else is chosen, and methods; in two rows where one is too narrow."""

from typing import NamedTuple

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QWidget

from app.results.compare_page import ComparePage
from app.results.result_parts import PageRoom
from app.results.thin_line import ThinLineChoice
from app.results.video_page import VideoPage
from app.theme.current import px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.segmented import Segmented
from app.widgets.text import Text
from app.widgets.toggle import Toggle
from app.wording.translation import later, tr

# the views
ANSWER, COMPARE, WHOLE, STRIDES = "answer", "compare", "whole", "strides"
CURVES, TABLE = "curves", "table"  # of the summary, where there is no room for both
WALK, RECORDING = later("Whole walk"), later("Whole recording")

RECORDINGS = (116, 240)  # px: the narrowest and the widest that their box becomes
TOOLS = 44  # px high
GAP = 12  # px between what is in one row


class Fitting(NamedTuple):
    """What has its room in one row with the views: methods and recordings; what else is chosen; the thin line's name
    before its choice too."""

    has_methods: bool = False
    has_choices: bool = False
    has_thin_name: bool = False


class ToolsRow(QGridLayout):
    """`beneath` takes the choice of the comparison's views, where its card has no room for it."""

    def __init__(self, compare: ComparePage, methods: Segmented, video: VideoPage) -> None:
        super().__init__()
        self._compare, self._methods, self._video = compare, methods, video
        self._room, self._width = PageRoom(), 0
        self.fitting = Fitting()  # as everything is placed
        views = ((ANSWER, tr("Summary")), (COMPARE, tr("Compare")), (WHOLE, tr(WALK)), (STRIDES, tr("Strides")))
        self.view = Segmented(tr("View"), [(key, word, "") for key, word in views])
        self.to_answer = Button(tr("Summary"), ButtonKind.SECONDARY, Icon.BACK, tr("Esc"))
        self.recordings = Choice(tr("Recording"))
        self.recordings.let_shrink(*RECORDINGS)  # conditions are typed
        self.thin = ThinLineChoice()
        self.thin_name = Text(tr("Thin line"), size=12, tone="ink2")
        self.part = Segmented(tr("Part"), [(CURVES, tr("Curves"), ""), (TABLE, tr("Table"), "")])
        self.show_legs = Toggle(tr("Legs"), tr("G"), is_on=True)
        self.show_legs.set_face(height=TOOLS)
        self.show_video = Toggle(tr("Video"), tr("V"), is_on=False)
        self.show_video.set_face(height=TOOLS, icon=Icon.CAMERA)
        for choice in (self.recordings, self.thin):
            choice.set_height(TOOLS)
        self.against, self.choices, self.beneath = QWidget(), QWidget(), QWidget()
        seen = (self.thin_name, self.thin, video.clip, video.beside, self.show_legs, self.show_video)
        chosen = (self.part, self.recordings, *seen, self.against)
        self._against = lay_out(QHBoxLayout(self.against), compare.kinds, compare.bases, margins=0, spacing=GAP)
        self._choices = lay_out(QHBoxLayout(self.choices), *chosen, margins=0, spacing=GAP)
        self._beneath = lay_out(QHBoxLayout(self.beneath), margins=0)
        self.setColumnStretch(4, 1)

    def is_to_be_placed(self, room: PageRoom, width: int) -> bool:
        """Whether in so much room, `width` px wide, anything has another place; that is taken by `place`."""
        self._name_video()
        is_new = room != self._room
        self._room, self._width = room, width
        return is_new or self._fits() != self.fitting

    def place(self) -> None:
        """Put all into one row, where they fit; the methods are placed by the page where they do not."""
        for widget in (self.view, self.to_answer, self._methods, self.choices):
            self.removeWidget(widget)
        left, room = Qt.AlignmentFlag.AlignLeft, self._room
        self.fitting = self._fits()
        self.addWidget(self.view, 0, 0, left)
        self.addWidget(self.to_answer, 0, 1, left)
        if self.fitting.has_choices:
            self.addWidget(self.choices, 0, 2)
        else:
            self.addWidget(self.choices, 1, 0, 1, 4, left)
        if self.has_methods:
            self.addWidget(self._methods, 0, 3)
        if room.is_narrow:
            self._against.insertWidget(2, self._compare.view)
        elif room.is_compact:
            self._beneath.addWidget(self._compare.view)
        scaled(self.setSpacing, 8 if room.is_compact else GAP)
        scaled(self._choices.setSpacing, 8 if room.is_compact else GAP)

    @property
    def has_methods(self) -> bool:
        """Whether the methods are in this row."""
        return self.fitting.has_methods and not self._room.is_narrow

    def _fits(self) -> Fitting:
        return Fitting(self._do_methods_fit(), self._do_choices_fit(), self._does_name_fit())

    def _do_methods_fit(self) -> bool:
        return self._have_room(self.view, self.recordings, self._methods, gaps=3)

    def _do_choices_fit(self) -> bool:
        """With what is chosen in the view that is shown."""
        if self._room.is_narrow:
            return False
        if self.view.choice == COMPARE:
            return self._have_room(self.view, self._compare.kinds, self._compare.bases, gaps=3)
        other = (self.part,) if self._room.is_compact else () if self.is_video else (self.thin,)
        shown = (*other, self.recordings, *self._of_video)  # which may be cut short
        of_answer = sum(one.minimumSizeHint().width() for one in shown) + px((len(shown) - 1) * GAP)
        return self._width >= self.view.sizeHint().width() + of_answer + px(3 * GAP)

    def _does_name_fit(self) -> bool:
        """With nothing cut."""
        shown = (self.view, self.recordings, self.thin_name, self.thin, *self._of_video)
        return self._have_room(*shown, gaps=len(shown))

    @property
    def is_video(self) -> bool:
        """Whether the clip is shown, where there is one."""
        return self._video.has_clip and self.show_video.isChecked()

    @property
    def _of_video(self) -> tuple[QWidget, ...]:
        """The toggles of what is beside the curves, and the choices of the clip while it is shown."""
        if self.is_video:
            return (*(one for one in (self._video.clip, self._video.beside) if one.count() > 1), self.show_video)
        return (self.show_legs, self.show_video) if self._video.has_clips else (self.show_legs,)

    def show_video_choices(self, *, is_offered: bool, is_shown: bool) -> None:
        """Offer the clip where some walk of the visit has one."""
        self.show_video.setVisible(is_offered and self._video.has_clips)
        for choice in (self._video.clip, self._video.beside):
            choice.setVisible(is_shown and choice.count() > 1)

    def _name_video(self) -> None:
        """State on the toggle that this walk has no clip."""
        has_clip = self._video.has_clip
        self.show_video.setEnabled(has_clip)
        self.show_video.setText(tr("Video") if has_clip else tr("No video of this walk"))
        self.show_video.setAccessibleName(self.show_video.text())
        self.show_video.set_face(key=tr("V") if has_clip else "")

    def _have_room(self, *tools: QWidget, gaps: int) -> bool:
        return self._width >= sum(one.sizeHint().width() for one in tools) + px(gaps * GAP)
