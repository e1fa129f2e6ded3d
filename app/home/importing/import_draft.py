"""Recordings of another program and their sensors: what each is and where it was worn, to be confirmed or changed."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QGridLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.home.importing.clock_part import ClockPart
from app.home.importing.import_words import (
    KIND_WORDS,
    SITE_WORDS,
    breakable,
    facts,
    kind_origin_words,
    liveliness,
    origin_words,
    sensor_name,
)
from app.home.importing.table_words import refused_line
from app.importing.import_drafts import DraftRecording, DraftSensor, Origin, SessionDraft, key_of
from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.card import Card
from app.widgets.choice import Choice
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.small_curve import SmallCurve
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import joined, tr, tr_n
from core.body import Side, Site
from core.placement.chains import USUAL_SITES
from core.session import RecordingKind
from core.signal.clock_events import ClockEventKind

if TYPE_CHECKING:
    from core.placement.chains import Chains

OPEN, ELSEWHERE = "open", "elsewhere"  # what has no site or kind: left open, and worn elsewhere than on a leg


class DraftCards(QWidget):
    """What is imported before it is: recordings, sensors and the patient, each to be corrected."""

    changed = Signal()  # a choice was made
    placing_requested = Signal()  # the motion shall say where the sensors were
    columns_requested = Signal()  # what the columns mean shall be shown, and may be changed
    combining_requested = Signal()  # the files shall be one recording
    split_requested = Signal(int, float)  # the recording of this number shall be two, at this time
    joining_requested = Signal()  # all that was split shall be as it was read

    def __init__(self, of_code: QWidget) -> None:
        super().__init__()
        self._recordings: list[_RecordingRow] = []
        self._sensors: list[_SensorRow] = []
        self._chains: Chains | None = None
        self._program = ""
        self._of_recordings, self._of_sensors = Card(padding=20, spacing=12), Card(padding=20, spacing=8)
        self._recordings_title = Text(size=16, weight=SEMIBOLD, wraps=True)
        self._recording_rows = QVBoxLayout()
        self.columns = Button(tr("Check the columns"), ButtonKind.SECONDARY, Icon.EDIT, height=40)
        self.combine = Button(tr("Combine into one recording"), ButtonKind.SECONDARY, Icon.GROUPS, height=40)
        self.join = Button(tr("Undo splitting"), ButtonKind.SECONDARY, Icon.REPEAT, height=40)
        self._sensors_title = Text(tr("Sensor positions"), size=16, weight=SEMIBOLD, wraps=True)
        self._sensor_rows = QGridLayout()
        self.place = Button(tr("Detect from movement"), ButtonKind.SECONDARY, Icon.WAVE, height=40)
        self._question = Text(wraps=True)
        self.is_left = Button(tr("Left leg"), ButtonKind.SECONDARY, height=40)
        self.is_right = Button(tr("Right leg"), ButtonKind.SECONDARY, height=40)
        self.trouble = Text(tone="ink2", wraps=True)
        self.one_receiver = Toggle(tr("The sensors shared one receiver"), "", is_on=False)
        self._build(of_code)

    @property
    def kinds(self) -> list[RecordingKind | None]:
        """Of each recording; None: it is left out."""
        stated = [row.kind.currentData() for row in self._recordings]
        return [RecordingKind(kind) if kind != OPEN else None for kind in stated]

    @property
    def sites(self) -> dict[str, Site | None]:
        """Of each sensor by its key; None: not on a leg, or not stated."""
        stated = {row.sensor.key: row.site.currentData() for row in self._sensors}
        return {key: Site(site) if site not in (OPEN, ELSEWHERE) else None for key, site in stated.items()}

    @property
    def worn(self) -> list[str]:
        """The keys of all sensors but those that were not on a leg."""
        return [row.sensor.key for row in self._sensors if row.site.currentData() != ELSEWHERE]

    @property
    def is_one_receiver(self) -> bool:
        """Whether somebody states that all sensors shared the clock of one receiver."""
        return not self.one_receiver.isHidden() and self.one_receiver.isChecked()

    @property
    def can_be_placed(self) -> bool:
        """Whether the motion may show positions that are open."""
        is_open = any(row.site.currentData() == OPEN for row in self._sensors)
        return is_open and len(self.worn) in USUAL_SITES

    @property
    def what_is_wrong(self) -> str:
        """Why this cannot be imported yet; empty where it can."""
        placed = [site for site in self.sites.values() if site is not None]
        twice = [site for site in Site if placed.count(site) > 1]
        if twice:
            return tr("{site} is assigned twice.").format(site=tr(SITE_WORDS[twice[0]]))
        if not placed:
            return tr("Enter the position of at least one sensor.")
        if not any(self.kinds):
            return tr("All recordings are excluded.")
        for row in self._recordings:
            if row.kind.currentData() != OPEN and row.breaks(self.sites):
                return tr("{name}: split it where its clock restarts or jumps, or exclude it.").format(name=row.title)
        return ""

    @property
    def tab_order(self) -> list[QWidget]:
        kinds: list[QWidget] = [part for row in self._recordings for part in (row.kind, *row.split_buttons)]
        sites = [row.site for row in self._sensors]
        return [
            *kinds,
            self.columns,
            self.combine,
            self.join,
            *sites,
            self.place,
            self.is_left,
            self.is_right,
            self.one_receiver,
        ]

    def show_folder(self) -> None:
        """Show nothing but the code: what a session folder states of its recordings and sensors holds."""
        self._of_recordings.hide()
        self._of_sensors.hide()

    def show_draft(
        self, program: str, draft: SessionDraft, *, has_columns: bool = False, can_be_combined: bool = False
    ) -> None:
        """Show what was read, with what is proposed. `has_columns`: what they mean can be stated.

        `can_be_combined`: it may be one sensor of several, whose files are not called alike.
        """
        self._chains = None
        self._of_recordings.show()
        self._of_sensors.show()
        for shown in self._recordings:
            shown.remove()
        for sensor in self._sensors:
            sensor.remove()
        self._program = program
        self._show_recordings(draft)
        longest = max(draft.recordings, key=lambda one: max((len(s.block) for s in one.trial.sensors), default=0))
        self._sensors = [_SensorRow(self._sensor_rows, one, longest) for one in draft.sensors]
        for sensor in self._sensors:
            sensor.site.currentIndexChanged.connect(self._on_changed)
        self.columns.setVisible(has_columns)
        self.combine.setVisible(can_be_combined)
        self.join.hide()
        self.one_receiver.show_on(False)
        self.one_receiver.setVisible(draft.is_clock_open)
        for card in (self._of_recordings, self._of_sensors):
            hear_as_laid_out(card)
        self._on_changed()

    def show_split(self, draft: SessionDraft, number: int) -> None:
        """Show that recording `number` is two; what was chosen of all stays."""
        kinds = self.kinds
        self._show_split(draft, [*kinds[: number + 1], *kinds[number:]])
        self.join.show()
        (self._recordings[number + 1].split_buttons or [self._recordings[number + 1].kind])[0].setFocus()

    def show_joined(self, draft: SessionDraft) -> None:
        """Show recordings as they were read, after some were split."""
        self._show_split(draft, [one.kind for one in draft.recordings])
        self.join.hide()
        self._recordings[0].kind.setFocus()

    def _show_split(self, draft: SessionDraft, kinds: Sequence[RecordingKind | None]) -> None:
        for shown in self._recordings:
            shown.remove()
        self._show_recordings(draft)
        for row, kind in zip(self._recordings, kinds, strict=True):
            row.kind.setCurrentIndex(row.kind.findData(kind or OPEN))
        self.one_receiver.setVisible(draft.is_clock_open)
        hear_as_laid_out(self._of_recordings)
        self._on_changed()

    def _show_recordings(self, draft: SessionDraft) -> None:
        count = len(draft.recordings)
        title = tr_n("{count} recording of {program}", "{count} recordings of {program}", count)
        self._recordings_title.setText(title.format(count=count, program=self._program))
        self._recordings = []
        for number, one in enumerate(draft.recordings):
            row = _RecordingRow(self._recording_rows, one)
            row.kind.currentIndexChanged.connect(self._on_changed)
            if row.clock is not None:
                row.clock.split_requested.connect(partial(self.split_requested.emit, number))
            self._recordings.append(row)

    def show_chains(self, chains: "Chains", *, takes_focus: bool) -> bool:
        """Take the legs found from motion and ask which is left unless sites show it; False: sites contradict."""
        stated = {key: site for key, site in self.sites.items() if site is not None}
        fitting = [side for side in Side if all(chains.sites(side).get(key) is site for key, site in stated.items())]
        if not fitting:
            return False
        self._chains = chains
        if len(fitting) == 1:
            self._on_side(fitting[0])
        else:
            self._show_question()
            if takes_focus:
                self.is_left.setFocus()
        return True

    def _build(self, of_code: QWidget) -> None:
        verbs = lay_out(QHBoxLayout(), self.columns, self.combine, self.join, 1)
        lay_out(self._of_recordings.column, self._recordings_title, self._recording_rows, verbs, 1)
        self._sensor_rows.setColumnStretch(0, 1)
        buttons = lay_out(QHBoxLayout(), self.place, self.is_left, self.is_right, 1)
        receiver = lay_out(QHBoxLayout(), self.one_receiver, 1)
        of_sensors = (self._sensors_title, self._sensor_rows, self.trouble, self._question, buttons, receiver)
        lay_out(self._of_sensors.column, *of_sensors, 1)
        self._left = lay_out(QVBoxLayout(), self._of_recordings, of_code, 1)
        self._row = lay_out(
            QBoxLayout(QBoxLayout.Direction.LeftToRight, self), (self._left, 1), (self._of_sensors, 1), margins=0
        )
        self.columns.clicked.connect(self.columns_requested)
        self.combine.clicked.connect(self.combining_requested)
        self.join.clicked.connect(self.joining_requested)
        self.place.clicked.connect(self._on_place)
        self.is_left.clicked.connect(lambda: self._on_side(Side.LEFT))
        self.is_right.clicked.connect(lambda: self._on_side(Side.RIGHT))

    def set_narrow(self, is_narrow: bool) -> None:
        """Put the sensors under the recordings."""
        for layout in (self._row, self._left):
            scaled(layout.setSpacing, 16)
        way = QBoxLayout.Direction.TopToBottom if is_narrow else QBoxLayout.Direction.LeftToRight
        self._row.setDirection(way)

    def _on_changed(self) -> None:
        self.trouble.setText(self.what_is_wrong)
        self.trouble.setVisible(bool(self.what_is_wrong))
        for row in self._sensors:
            row.show_message()
        self._show_question()
        self.changed.emit()

    def _show_question(self) -> None:
        is_asking = self._chains is not None
        self.place.setVisible(self.can_be_placed and not is_asking)
        self._question.setVisible(is_asking)
        for button in (self.is_left, self.is_right):
            button.setVisible(is_asking)
        if self._chains is not None:
            names = {row.sensor.key: sensor_name(row.sensor) for row in self._sensors}
            first = joined([names[key] for key in self._chains.legs[0].sensors])
            asked = tr(
                "According to the movement, {sensors} are on one leg, listed from the thigh down. Which leg is it?"
            )
            doubt = "" if self._chains.is_certain else tr("This is uncertain. Compare it with your notes.")
            self._question.setText(" ".join(filter(None, [asked.format(sensors=first), doubt])))

    def _on_place(self) -> None:
        self._chains = None
        self.placing_requested.emit()

    def _on_side(self, side: Side) -> None:
        assert self._chains is not None
        sites = self._chains.sites(side)
        self._chains = None
        for row in self._sensors:
            if row.sensor.key in sites:
                row.choose(sites[row.sensor.key], Origin.MOTION)
        self._on_changed()


class _RecordingRow:
    def __init__(self, column: QVBoxLayout, recording: DraftRecording) -> None:
        self._part = QWidget()
        grid = QGridLayout(self._part)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setColumnStretch(0, 1)
        self.kind = Choice(tr("Type of {name}").format(name=recording.title))
        for kind, words in KIND_WORDS.items():
            self.kind.addItem(tr(words), kind)
        self.kind.addItem(tr("Excluded"), OPEN)
        self.kind.setCurrentIndex(self.kind.findData(recording.kind))
        self.kind.setMinimumHeight(self.kind.sizeHint().height())
        curve = SmallCurve(tr("Angular rate of a sensor"))
        curve.show_curve(*liveliness([sensor.block for sensor in recording.trial.sensors]))
        grid.addWidget(Text(breakable(recording.title), weight=SEMIBOLD, wraps=True), 0, 0)
        grid.addWidget(curve, 0, 1)
        grid.addWidget(self.kind, 0, 2, Qt.AlignmentFlag.AlignRight)
        stated = f"{facts(recording.trial, recording.clocks)} · {kind_origin_words(recording.origin)}"
        grid.addWidget(Text(stated, size=12, tone="ink2", wraps=True), 1, 0, 1, 3)
        for unread in recording.trial.unread:
            grid.addWidget(
                Text(refused_line(unread.refusal), size=12, tone="ink2", wraps=True), grid.rowCount(), 0, 1, 3
            )
        self.title, self._trial, self._clocks = recording.title, recording.trial, recording.clocks
        self.clock: ClockPart | None = None
        if recording.clocks.events:
            names = [sensor.name for sensor in recording.trial.sensors]
            self.clock = ClockPart(recording.clocks, names)
            grid.addWidget(self.clock, grid.rowCount(), 0, 1, 3)
        column.addWidget(self._part)
        self._part.show()  # at once, so that it can have the focus

    @property
    def split_buttons(self) -> list[QWidget]:
        return list(self.clock.buttons) if self.clock is not None else []

    def breaks(self, sites: Mapping[str, Site | None]) -> bool:
        """Whether the clock of a sensor that is placed restarts or jumps."""
        placed = {k for k, one in enumerate(self._trial.sensors) if sites.get(key_of(one)) is not None}
        broken = (ClockEventKind.RESTART, ClockEventKind.JUMP)
        return any(one.kind in broken and placed & set(one.sensors) for one in self._clocks.events)

    def remove(self) -> None:
        self._part.setParent(None)
        self._part.deleteLater()


class _SensorRow:
    def __init__(self, grid: QGridLayout, sensor: DraftSensor, shown: DraftRecording) -> None:
        self.sensor = sensor
        self._origin, self._proposed = sensor.origin, sensor.site
        name = sensor_name(sensor)
        self.site = Choice(tr("Position of {name}").format(name=name))
        self.site.addItem(tr("Not recorded"), OPEN)
        for site, words in SITE_WORDS.items():
            self.site.addItem(tr(words), site)
        self.site.addItem(tr("Not on a leg"), ELSEWHERE)
        self.site.setCurrentIndex(self.site.findData(sensor.site) if sensor.site is not None else 0)
        self.site.setMinimumHeight(self.site.sizeHint().height())  # the rows of a grid give way before they scroll
        self._curve = SmallCurve(tr("Angular rate of a sensor"))
        self._curve.show_curve(*liveliness([one.block for one in shown.trial.sensors if key_of(one) == sensor.key]))
        self._words = Text(breakable(name), wraps=True)
        self._from = Text(size=12, tone="ink2")
        row = grid.rowCount()
        self._stated = QWidget()
        lay_out(QVBoxLayout(self._stated), self._words, self._from, margins=0, spacing=0)
        for column, part in enumerate(self._parts):
            grid.addWidget(part, row, column)

    @property
    def _parts(self) -> tuple[QWidget, ...]:
        return self._stated, self._curve, self.site

    def choose(self, site: Site, origin: Origin) -> None:
        """As something other than the person states."""
        self._origin, self._proposed = origin, site
        self.site.setCurrentIndex(self.site.findData(site))

    def show_message(self) -> None:
        """Say where the site comes from, as long as it is the one that was proposed."""
        is_proposed = self._proposed is not None and self.site.currentData() == self._proposed
        self._from.setText(origin_words(self._origin) if is_proposed else "")
        self._from.setVisible(is_proposed)

    def remove(self) -> None:
        for part in self._parts:
            part.setParent(None)
            part.deleteLater()
