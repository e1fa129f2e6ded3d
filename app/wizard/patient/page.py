"""Page for the patient and the side that the session is about.

Only the code is needed; the rest chooses the band and is printed.
"""

from dataclasses import dataclass, field, replace
from datetime import date

from PySide6.QtCore import QEvent, QObject, QSignalBlocker, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.summary.reference_bands import reference_curves
from app.theme.current import current_theme, on_theme
from app.theme.ground import Ground, set_ground
from app.widgets.card import Card
from app.widgets.chips import Chips
from app.widgets.field import Field, NumberField
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.segmented import Segmented
from app.widgets.text import SEMIBOLD, Text
from app.wizard.patient.captioned import Captioned
from app.wizard.patient.cards import BandCard, LastVisit, LastVisitCard, TakenCard
from app.wizard.patient.prosthesis_row import ProsthesisRow
from app.wording.patients import AIDS
from app.wording.translation import tr
from core.body import Side
from core.prosthesis import NOT_STATED, stated_only
from core.session import Patient

ONE_COLUMN_BELOW = 620  # room for the form, where a row of three fields still reads well
BAND_CARD_WIDTH = 328
WIDEST = 1240  # further apart, labels and cards no longer belong together
HIGHEST_CARD = 620
ANY_SIZE = 16777215  # what Qt calls no limit
MOST_OF_CODE, MOST_OF_DEVICE = 40, 80  # characters; both stand in the header of all that follows

_ACROSS, _DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom


@dataclass(frozen=True, slots=True)
class PatientDraft:
    """What is on the page. `without_ankle`: sides whose foot was answered to have no ankle joint, its kind unknown."""

    patient: Patient = field(default_factory=Patient)
    without_ankle: frozenset[Side] = frozenset()


class PatientPage(QWidget):
    """What was typed stays on the page, right or wrong."""

    edited = Signal(PatientDraft)  # what is on the page, with every letter
    open_pressed = Signal(str)  # the patient whose code was typed is in the library: take that one
    same_set_up_pressed = Signal()  # as at the last visit, and on to the sensors

    def __init__(self, today: date | None = None) -> None:
        super().__init__()
        self._year = (today or date.today()).year
        self._shown = PatientDraft()
        self._taken_code = ""
        self._is_compact = False
        self._saved = Text(size=14, tone="ink2")
        self.code = Field(tr("Patient code"), is_code=True, most=MOST_OF_CODE)
        self.sex = Segmented(
            tr("Sex"), [("female", tr("Female"), ""), ("male", tr("Male"), ""), ("", tr("Not recorded"), "")]
        )
        self.birth_year = NumberField(tr("Birth year"), low=1900, high=self._year, is_optional=True)
        self.height_cm = NumberField(tr("Height"), low=30, high=280, decimals=1, unit=tr("cm"), is_optional=True)
        self.mass_kg = NumberField(tr("Weight"), low=1, high=500, decimals=1, unit=tr("kg"), is_optional=True)
        self.side = Segmented(
            tr("Affected or prosthetic side"),
            [
                ("none", tr("Neither"), ""),
                ("left", tr("Left"), ""),
                ("right", tr("Right"), ""),
                ("both", tr("Both"), ""),
            ],
        )
        self.limb = Segmented(
            tr("This side is"), [("affected", tr("Affected"), ""), ("prosthetic", tr("Prosthetic"), "")]
        )
        self.device = Field(tr("Device"), is_optional=True, most=MOST_OF_DEVICE)
        self.prostheses = {side: ProsthesisRow(side) for side in Side}
        self.ankles = {
            Side.LEFT: Chips(tr("Left ankle joint"), [("none", tr("Left foot has no ankle joint"))]),
            Side.RIGHT: Chips(tr("Right ankle joint"), [("none", tr("Right foot has no ankle joint"))]),
        }
        aids = [(aid, tr(words)) for aid, words in AIDS.items()]
        self.aids = Chips(tr("Aids and footwear"), aids, rivals=("shoes", "barefoot"))
        self._band = BandCard(reference_curves())
        self._taken = TakenCard()
        self._last = LastVisitCard()
        self._build()
        self._connect()
        self.show_draft(PatientDraft())
        self.show_last_visit(None)
        self._taken.hide()
        on_theme(self._fit)

    @property
    def draft(self) -> PatientDraft:
        """What is on the page now; what the page cannot show, or what is half typed, is as it was shown."""
        reported = self._shown.patient
        affected, prosthetic = reported.affected_side, reported.prosthetic_side
        if (self.side.choice, self.limb.choice) != _sides_on_page(reported):
            is_prosthetic = self.limb.choice == "prosthetic"
            affected, prosthetic = ("none", self.side.choice) if is_prosthetic else (self.side.choice, "none")
        height_cm = _typed(self.height_cm, reported.height_m and reported.height_m * 100)
        birth_year = _typed(self.birth_year, reported.birth_year)
        patient = replace(
            reported,
            code=self.code.text,
            birth_year=None if birth_year is None else round(birth_year),
            sex=self.sex.choice if self.sex.choice != _sex_on_page(reported) else reported.sex,
            height_m=None if height_cm is None else round(height_cm / 100, 4),
            mass_kg=_typed(self.mass_kg, reported.mass_kg),
            device=self.device.text,
            aids=", ".join(self.aids.chosen) if self.aids.chosen != _aids_in(reported) else reported.aids,
            affected_side=affected,
            prosthetic_side=prosthetic,
        )
        shown = {side: self.prostheses[side].prosthesis for side in patient.prosthetic_sides}
        if patient.prosthetic_sides == reported.prosthetic_sides:  # what is stated of another side is not shown
            shown = {**reported.prostheses, **shown}
        patient = replace(patient, prostheses=stated_only(shown))
        answered = (side for side in _asked_about_ankle(patient) if self.ankles[side].chosen)
        return PatientDraft(patient, frozenset(answered))

    @property
    def tab_order(self) -> list[QWidget]:
        return [
            self.code.line_edit,
            *self.side.segments,
            *self.limb.segments,
            self.device.line_edit,
            *self.sex.segments,
            self.birth_year.line_edit,
            self.height_cm.line_edit,
            self.mass_kg.line_edit,
            *self.aids.buttons,
            *(choice for row in self.prostheses.values() for choice in row.choices),
            *(chip for chips in self.ankles.values() for chip in chips.buttons),
            self._taken.open,
            self._last.same,
        ]

    def focus(self) -> None:
        self.code.setFocus()

    def set_compact(self, is_compact: bool) -> None:
        """Lay the cards below one another where the window is small."""
        self._is_compact = is_compact
        self._cards.setDirection(_DOWN if is_compact else _ACROSS)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        self._fit()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Fit the cards again when something on them needs another height: chips know it once they have their width."""
        if watched is self._scroll.widget() and event.type() is QEvent.Type.LayoutRequest:
            self._fit()
        return super().eventFilter(watched, event)

    def show_draft(self, draft: PatientDraft) -> None:
        """Fill the page; what is there is not reported as an edit."""
        self._shown = draft
        reported = draft.patient
        side, limb = _sides_on_page(reported)
        with QSignalBlocker(self.sex), QSignalBlocker(self.side), QSignalBlocker(self.limb):
            self.sex.choose(_sex_on_page(reported))
            self.side.choose(side)
            self.limb.choose(limb)
        self.code.set_text(reported.code)
        self.birth_year.set_value(reported.birth_year)
        self.height_cm.set_value(None if reported.height_m is None else reported.height_m * 100)
        self.mass_kg.set_value(reported.mass_kg)
        self.device.set_text(reported.device)
        self.aids.choose(_aids_in(reported))
        for one, row in self.prostheses.items():
            row.show_prosthesis(reported.prostheses.get(one, NOT_STATED))
            self.ankles[one].choose(["none"] if one in draft.without_ankle else [])
        self._follow()

    def show_saved(self, words: str) -> None:
        """Say in a few words whether what is here is kept: "draft, saved"."""
        self._saved.setText(words)

    def show_code_taken(self, code: str) -> None:
        """Say that `code` is another patient's, and offer to take that one; an empty code takes it back."""
        self._taken_code = code
        self.code.set_wrong(
            tr("{code} already exists. Open that patient, or choose another code.").format(code=code) if code else ""
        )
        self._taken.show_code(code)
        self._taken.setVisible(bool(code))
        self._fit()

    def show_last_visit(self, visit: LastVisit | None) -> None:
        """Show the visit before this one; None where it is the first."""
        self._last.setVisible(visit is not None)
        if visit is not None:
            self._last.show_visit(visit)
        self._fit()

    def _build(self) -> None:
        how = tr("Only the code is required. The other entries select the reference and are printed.")
        subtitle = Text(how, size=15, tone="ink2", wraps=True)
        self._limb_box = Captioned(self.limb, tr("This side is"))
        ankles = QWidget()
        both = [(chips, 1) for chips in self.ankles.values()]
        self._ankle_row = lay_out(QBoxLayout(_ACROSS, ankles), *both, margins=0, spacing=16)
        self._ankle_box = Captioned(
            ankles,
            tr("Prosthetic foot"),
            tr("without ankle joint, the angle is called “foot relative to shank”"),
        )
        sex = Captioned(self.sex, tr("Sex"))
        side = Captioned(self.side, tr("Affected or prosthetic side"))
        aids = Captioned(self.aids, tr("Aids and footwear"), tr("choose all that apply"))
        self._form = Card(padding=24, spacing=16)
        self._rows = [
            self._row(self.code, side),  # the side decides what results, report and bands are about
            self._row(self._limb_box, self.device),
            self._row(sex, self.birth_year),
            self._row(self.height_cm, self.mass_kg),
            self._row(aids),
            *(self._row(row) for row in self.prostheses.values()),
            self._row(self._ankle_box),  # last: where they come and go, nothing under the pointer moves
        ]
        for number, row in enumerate(self._rows):
            if number == 2:
                self._form.column.addWidget(_line())
            self._form.column.addLayout(row)
        self._form.column.addStretch(1)
        self._beside = QWidget()
        lay_out(QVBoxLayout(self._beside), self._taken, self._band, (self._last, 1), 0, margins=0, spacing=16)
        self._cards = lay_out(QBoxLayout(_ACROSS), (self._form, 1), self._beside, spacing=16)
        saved = (self._saved, 0, Qt.AlignmentFlag.AlignBottom)
        words = lay_out(QHBoxLayout(), (subtitle, 1), saved, margins=(0, 0, 0, 12), spacing=16)
        content = QWidget()
        title = Text(tr("Patient details"), size=26, weight=SEMIBOLD, wraps=True)
        self._column = lay_out(QVBoxLayout(content), title, words, (self._cards, 1), 0, spacing=4)
        self._scroll = scrolled(content)
        content.installEventFilter(self)
        lay_out(QVBoxLayout(self), self._scroll, margins=0)

    def _row(self, *widgets: QWidget) -> QBoxLayout:
        parts = [(widget, 1, Qt.AlignmentFlag.AlignTop) for widget in widgets]
        return lay_out(QBoxLayout(_ACROSS), *parts, spacing=16)

    def _connect(self) -> None:
        for line in (self.code, self.birth_year, self.height_cm, self.mass_kg, self.device):
            line.edited.connect(self._on_edited)
        for segmented in (self.sex, self.side, self.limb):
            segmented.chosen.connect(self._on_edited)
        for chips in (*self.ankles.values(), self.aids):
            chips.turned.connect(self._on_edited)
        for row in self.prostheses.values():
            row.edited.connect(self._on_edited)
        self._taken.open.clicked.connect(self._on_open_clicked)
        self._last.same.clicked.connect(self.same_set_up_pressed)

    def _follow(self) -> None:
        """Ask only what follows from what is stated: no limb without a side, no ankle beside the foot's kind."""
        draft = self.draft
        has_side = self.side.choice != "none"
        self.limb.setEnabled(has_side)
        self._limb_box.set_note("" if has_side else tr("choose a side first"))
        asked = _asked_about_ankle(draft.patient)
        for side, row in self.prostheses.items():
            row.setVisible(side in draft.patient.prosthetic_sides)
            self.ankles[side].setVisible(side in asked)
        self._ankle_box.setVisible(bool(asked))
        self._band.judge(None if draft.patient.birth_year is None else self._year - draft.patient.birth_year)
        self._fit()

    def _fit(self) -> None:
        """Set the fields of a row below one another where they would be too narrow."""
        scale, px = current_theme().scale, current_theme().px
        side = max(px(24), (self.width() - px(WIDEST)) // 2)
        self._column.setContentsMargins(side, px(20), side, px(20))
        room = self.width() / scale - 48 - (0 if self._is_compact else BAND_CARD_WIDTH + 16)
        way = _ACROSS if room >= ONE_COLUMN_BELOW else _DOWN
        for row in self._rows:
            row.setDirection(way)
        for line in self.prostheses.values():
            line.fit(round(scale * (room - 48)))
        self._ankle_row.setDirection(way)
        width = max(px(BAND_CARD_WIDTH), self._beside.minimumSizeHint().width())  # its button may need more
        self._beside.setMinimumWidth(0 if self._is_compact else width)
        self._beside.setMaximumWidth(ANY_SIZE if self._is_compact else width)
        cards = (self._form, self._beside)
        bar = self._scroll.verticalScrollBar().sizeHint().width()
        form = self.width() - 2 * side - bar - self._cards.spacing() - width
        needed = (card.heightForWidth(room) for card, room in zip(cards, (form, width), strict=True))
        highest = max(px(HIGHEST_CARD), *needed)  # long words need more
        for card in cards:
            card.setMaximumHeight(ANY_SIZE if self._is_compact else highest)

    def _on_edited(self) -> None:
        if self._taken_code and self.code.text.strip() != self._taken_code:
            self.show_code_taken("")
        self._follow()
        self.edited.emit(self.draft)

    def _on_open_clicked(self) -> None:
        self.open_pressed.emit(self._taken_code)


def _line() -> QWidget:
    """A hairline between what the session is about and what chooses the reference."""
    line = QWidget()
    line.setFixedHeight(1)
    set_ground(line, Ground("line", radius=0, inset=0))
    return line


def _typed(line: NumberField, before: float | None) -> float | None:
    """Give the number in a field; while it is half typed or out of range, the one from before."""
    if not line.text.strip():
        return None
    return line.value if line.value is not None else before


def _sex_on_page(patient: Patient) -> str:
    return patient.sex if patient.sex in ("female", "male") else ""


def _sides_on_page(patient: Patient) -> tuple[str, str]:
    """Give the choices that show the patient's sides; where two are entered, the prosthesis is the one it is about."""
    if patient.prosthetic_side not in ("", "none"):
        return patient.prosthetic_side, "prosthetic"
    return patient.affected_side or "none", "affected"


def _asked_about_ankle(patient: Patient) -> tuple[Side, ...]:
    """The sides with a prosthetic foot whose kind is not stated: its kind shows whether it has an ankle joint."""
    worn = {side: patient.worn.get(side, NOT_STATED) for side in Side if side in patient.prosthetic_sides}
    return tuple(side for side, one in worn.items() if one.foot is None and one.may_have_foot)


def _aids_in(patient: Patient) -> tuple[str, ...]:
    """Give the aids as the page's keys; an unknown one in its own words."""
    known = {aid.lower(): aid for aid in AIDS}
    reported = [aid.strip() for aid in patient.aids.split(",") if aid.strip()]
    named = [known.get(aid.lower(), aid) for aid in reported]
    order = [*AIDS]
    return tuple(sorted(dict.fromkeys(named), key=lambda aid: order.index(aid) if aid in AIDS else len(order)))
