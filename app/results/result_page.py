"""What came of one session: a walk's headline, four values, curves with the legs, largest differences, quality."""

from collections.abc import Mapping, Sequence
from enum import Enum, auto

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut, QShowEvent
from PySide6.QtWidgets import QBoxLayout, QHBoxLayout, QVBoxLayout, QWidget

from app.results.differs_card import DiffersCard
from app.results.headline_text import HeadlineText
from app.results.result_parts import PageRoom, ResultParts
from app.results.shown_clips import ClipsOfVisit, is_same_session
from app.results.summary_text import door_words, strides_in_short
from app.results.thin_line import ThinLine
from app.results.tools_row import ANSWER, COMPARE, RECORDING, STRIDES, TABLE, WALK, WHOLE, ToolsRow
from app.results.value_tile import TileRow
from app.summary.agreed import agreed_with
from app.summary.conditions import Part, conditions_of
from app.summary.course_lanes import CourseVisit
from app.summary.data_quality import data_quality, quality_without_walk
from app.summary.facts import Facts
from app.summary.headline import Headline, headline_of
from app.summary.marks_on_curves import bracket_of, gaps_of, labels_of
from app.summary.mean_legs import MeanLegs, ThinBend, mean_legs, thin_bends
from app.summary.quality_line import quality_sentence
from app.summary.reference_bands import age_and_height
from app.summary.request import AnalysedVisit, default_walks
from app.summary.tiles import tiles_of
from app.summary.visits import ComparedVisits
from app.theme.current import px, scaled
from app.theme.icons import Icon
from app.widgets.button import Button, ButtonKind
from app.widgets.detail_button import DetailButton
from app.widgets.heard_order import hear_as_laid_out
from app.widgets.lay_out import lay_out
from app.widgets.toggle import Toggle
from app.wording.recordings import with_shown_names
from app.wording.translation import tr
from core.body import Joint, JointKind, Side, Site, knee_of
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.session import RecordingKind
from core.video.clip import Clip

LEG_KINDS = (JointKind.KNEE, JointKind.ANKLE)  # whose charts are always there

ACROSS, DOWN = QBoxLayout.Direction.LeftToRight, QBoxLayout.Direction.TopToBottom
BOTTOM = 40  # px high: the row that closes the summary
OTHERS, COMPACT_OTHERS = 298, 270  # px high: all else of a summary than charts and table
SECOND_TOOLS = 56  # px high: where the tools take two rows
CHART = 222  # px high: what the charts have before the table gets more rows
LEGS, LEGS_SHARE = 144, 0.135  # px wide, or of the page


class Behind(Enum):
    """What somebody looks at behind the summary, in place of its curves."""

    NOTHING = auto()
    FIGURES = auto()
    QUALITY = auto()


class ResultPage(QWidget):
    """`parts`: those that were made before. `reported`: the text in the bar beneath the page has changed.

    `synchronised`: a clip's id and its Sync, as somebody confirmed it.
    """

    reported = Signal()
    synchronised = Signal(object, object)

    def __init__(self, parts: ResultParts | None = None) -> None:
        super().__init__()
        parts = parts or ResultParts()
        self._visit: AnalysedVisit | None = None
        self._facts: Facts | None = None  # of the walk on the screen
        self._headline: Headline | None = None
        self._can_choose = self._is_live = False
        self._course: tuple[CourseVisit, ...] = ()
        self._stride: Mapping[Joint, FloatArray] = {}  # in force
        self._room = PageRoom()
        self._width = self._height = 0.0
        self._thin: Mapping[Side, ThinBend] = {}
        self._drawn: tuple[AnalysedVisit, RecordingAnalysis, MeanLegs | None] | None = None
        self._mended_by_motion: Side | None = None  # whose free motion would mend the gravest cause
        self._has_band, self._has_chosen_legs = True, False
        self._behind = Behind.NOTHING
        self._required = ANSWER  # of a walk; kept while recordings without it are looked at
        tools = self._tools = ToolsRow(parts.compare, parts.whole.methods, parts.video)
        self.view, self.to_answer, self.part = tools.view, tools.to_answer, tools.part
        self.recordings, self.thin, self.thin_name = tools.recordings, tools.thin, tools.thin_name
        self.show_legs, self.show_video = tools.show_legs, tools.show_video
        self.headline = HeadlineText()
        self.tiles = TileRow()
        self.differs = DiffersCard()
        self.door = DetailButton(tr("Q"))
        self.repeat = Button(tr("Repeat free motion"), ButtonKind.SECONDARY, Icon.REPEAT, height=BOTTOM)
        self.repeat.hide()
        self.all_figures = Toggle(tr("All values"), tr("F"), is_on=False)
        self.cycles = parts.cycles
        self.legs = parts.legs
        self.strides = parts.strides
        self.compare = parts.compare
        self.whole = parts.whole
        self.quality = parts.quality
        self.video = parts.video
        self._build()
        self._connect()

    def show_visit(
        self,
        visit: AnalysedVisit,
        *,
        can_choose: bool = False,
        is_live: bool = False,
        course: tuple[CourseVisit, ...] = (),
    ) -> None:
        """Show the recording in sight if `visit` has it, else a report's walk or the first.
        `course`: in time order; `can_choose`: strides may be left out; `is_live`: free motion repeatable.
        """
        if self._visit is not None and not is_same_session(self._visit, visit):
            self.video.clear()  # another patient's walk may have the same name
        self._visit, self._can_choose, self._is_live, self._course = visit, can_choose, is_live, course
        session, analysis = visit.session, visit.analysis
        shown, called = self.recordings.currentData(), visit.shown_names
        is_prosthetic = session.patient.prosthetic_side in set(Side)
        parts = conditions_of(analysis, session.recordings, agreed=agreed_with(session))
        self.compare.show_conditions(analysis, parts, is_prosthetic, age_and_height(session))
        self.thin.show_visit(visit)
        names = [recording.name for recording in analysis.recordings]
        proposed = default_walks(visit)
        first = names.index(proposed[-1]) if proposed else 0
        self.recordings.offer([(str(called.get(name, name)), name) for name in names], shown, first)
        self.recordings.setVisible(bool(names))
        if self._is_to_be_placed():
            self._place()
        self._on_recording_changed()
        self._fit_parts()

    def set_has_visits(self, has_visits: bool) -> None:
        """Offer earlier visits to compare with."""
        self.compare.set_has_visits(has_visits)

    def show_visits(self, visits: Sequence[ComparedVisits], walked: str = "", every: Sequence[Part] = ()) -> None:
        """Show earlier visits, which `compare` requested, as `ComparePage.show_visits` describes."""
        self.compare.show_visits(visits, walked, every)
        if isinstance(self.thin.currentData(), ThinLine):
            self._show_thin()

    def show_clips(self, clips: Sequence[Clip]) -> None:
        """Offer clips of the visit's walks."""
        self.video.show_clips(clips)
        self._show_parts()

    def show_clips_of_visits(self, visits: Sequence[ClipsOfVisit]) -> None:
        """Offer clips of other visits to be shown beside."""
        self.video.show_clips_of_visits(visits)
        self._show_parts()

    def clear_clips(self) -> None:
        """Drop every clip and picture, as at Lock."""
        self.video.clear()
        self._show_parts()

    def set_room(self, width: float, height: float) -> None:
        """Fold the page to its room in design px: curves or table, legs in the ankle's place, if little."""
        room = PageRoom.of(width, height)
        self._width, self._height = width, height
        if not self._has_chosen_legs and self.show_legs.isChecked() is room.is_compact:
            self.show_legs.show_on(not room.is_compact)  # where there is little room the ankle is shown first
            self._show_moving_legs()
        self._room = room
        if self._is_to_be_placed():
            self._place()
        self.legs.setFixedWidth(max(px(max(LEGS, LEGS_SHARE * width)), self.legs.least_width))
        self._fit_parts()
        self._fit_table()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        if self._is_to_be_placed():  # words are measured by the fonts that they are shown in
            self._place()

    def _fit_table(self) -> None:
        """Show as many rows of what differs as leave the charts their room; alone it has all of the page."""
        others = COMPACT_OTHERS if self._room.is_compact else OTHERS + CHART
        others += 0 if self._tools.fitting.has_choices else SECOND_TOOLS
        self.differs.set_room(self._height - others, is_compact=self._room.is_compact)

    def focus(self) -> None:
        """Give the focus to the first choice of the page."""
        if self._behind is Behind.QUALITY:
            self.quality.focus()
        elif not self.video.isHidden():
            self.video.focus()
        elif not self.legs.isHidden():
            self.legs.setFocus()  # arrows move the cursor at once
        else:
            (self.whole.methods if self.view.isHidden() else self.view).focus()

    def leave_behind(self) -> bool:
        """Go back to the answer from the details behind it; whether there was anything to leave."""
        if self._behind is Behind.NOTHING:
            return False
        self._show_behind(Behind.NOTHING)
        self.door.setFocus()
        return True

    @property
    def recording(self) -> RecordingAnalysis | None:
        """The recording on the screen; None in a session without any that moves."""
        if self._visit is None or not self._visit.analysis.recordings:
            return None
        return self._visit.analysis.recordings[self.recordings.currentIndex()]

    @property
    def band_words(self) -> str:
        """Whose band is drawn behind the curves and how fast this walk was; empty where no curve has a band."""
        is_shown = self.view.choice == ANSWER and self._behind is Behind.FIGURES
        return self.cycles.band_words if is_shown else ""  # over the curves their info button has it

    @property
    def tab_order(self) -> list[QWidget]:
        """What takes the focus, in the order of reading."""
        choices = [
            self.to_answer,
            *self.view.segments,
            *self.part.segments,
            self.recordings,
            self.thin,
            self.video.clip,
            self.video.beside,
            self.show_legs,
            self.show_video,
            *self.whole.methods.segments,
        ]
        shown = [
            *self.whole.tab_order,
            *self.strides.tab_order,
            *self.video.tab_order,
            self.legs,
            self.differs.table,
            *self.cycles.tables,
            *self.compare.tab_order,
        ]
        return [
            *choices,
            *shown,
            *self.quality.tab_order,
            self.door,
            self.repeat,
            self.video.synchronise,
            self.all_figures,
        ]

    def _build(self) -> None:
        self._figures = QWidget()
        right = lay_out(QVBoxLayout(), (self.cycles.time_distance, 1), (self.cycles.hips, 1))
        tables = ((self.cycles.peaks, 1), (right, 1))
        self._tables = lay_out(QBoxLayout(ACROSS, self._figures), *tables, margins=0, spacing=12)
        wide = (self.whole, self.video, self.cycles, self.compare, self._figures, self.quality)
        parts = (*wide[:3], self.legs, self.strides, *wide[3:])
        self._columns = lay_out(QHBoxLayout(), *((part, int(part in wide)) for part in parts), spacing=12)
        bottom = lay_out(
            QHBoxLayout(), (self.door, 1), self.repeat, self.video.synchronise, self.all_figures, spacing=12
        )
        self.all_figures.set_face(height=BOTTOM)
        self._page = lay_out(
            QVBoxLayout(self),
            self._tools,
            (self._tools.beneath, 0, Qt.AlignmentFlag.AlignLeft),
            self.headline,
            self.tiles,
            (self._columns, 1),
            self.differs,
            bottom,
            spacing=10,
        )
        self._place()

    def _connect(self) -> None:
        self.view.chosen.connect(self._on_view_chosen)
        self.recordings.currentIndexChanged.connect(self._on_recording_changed)
        self.thin.currentIndexChanged.connect(self._on_thin_changed)
        self.part.chosen.connect(self._show_parts)
        self.strides.chosen.connect(self._on_stride_chosen)
        self.cycles.charts.picked.connect(self._on_stride_picked)
        self.show_legs.toggled.connect(self._on_legs_toggled)
        self.show_video.toggled.connect(self._on_video_toggled)
        self.video.synchronised.connect(self.synchronised)
        self.legs.moved.connect(self._on_cursor_moved)
        self.door.clicked.connect(self._on_door)
        self.to_answer.clicked.connect(self.leave_behind)
        self.repeat.clicked.connect(lambda: self.quality.repeat_requested.emit(self._mended_by_motion))
        self.all_figures.toggled.connect(lambda is_on: self._show_behind(Behind.FIGURES if is_on else Behind.NOTHING))
        for key, button in (
            (tr("Q"), self.door),
            (tr("F"), self.all_figures),
            (tr("G"), self.show_legs),
            (tr("V"), self.show_video),
            (tr("E"), self.quality.engineering),
        ):
            shortcut = QShortcut(QKeySequence(key), button)  # asleep while its button is hidden
            shortcut.activated.connect(button.click)
        for key, turn in ((tr("B"), self._turn_band), (tr("T"), self.thin.turn)):
            shortcut = QShortcut(QKeySequence(key), self.cycles)  # asleep while there are no curves
            shortcut.activated.connect(turn)

    def _place(self) -> None:
        """Put the tools into one row, where they fit; the methods go under the curves where they do not."""
        self._tools.place()
        room = self._room
        self.whole.place(has_methods=not self._tools.has_methods, is_narrow=room.is_narrow, is_wide=room.has_two_tables)
        self.compare.set_room(room.is_compact, room.is_spacious, room.has_two_charts, has_view=not room.is_narrow)
        self.strides.set_charts_beside(room.has_strides_beside)
        self.tiles.set_brief(room.is_compact)
        scaled(self._page.setContentsMargins, self._side, 12, self._side, 8)
        self._fit_table()
        hear_as_laid_out(self)
        self._offer()

    def _fit_parts(self) -> None:
        """Put beside each other what has its room there: tables of figures, the doors, the phases' legend."""
        room, cycles = self._room, self.cycles
        self.video.set_compact(room.is_compact)
        self.quality.set_room(self._inner_width, is_compact=room.is_compact, is_narrow=room.is_narrow)
        self.whole.fit_phases(self._inner_width, is_narrow=room.is_narrow)
        right = [card for card in (cycles.time_distance, cycles.hips) if not card.isHidden()]
        needed = _least_width(cycles.peaks) + max(map(_least_width, right), default=0) + self._tables.spacing()
        does_fit = room.has_two_tables and needed <= self._inner_width
        self._tables.setDirection(ACROSS if does_fit else DOWN)

    @property
    def _inner_width(self) -> int:
        """Between the margins of the page, in pixels."""
        return px(self._width - 2 * self._side)

    @property
    def _side(self) -> int:
        """The margin at either side, as of the bar beneath, in px of the design."""
        return 24 if self._room.is_on_grid else 16

    def _is_to_be_placed(self) -> bool:
        return self._tools.is_to_be_placed(self._room, self._inner_width)

    def _offer(self) -> None:
        """Offer the views that this recording has."""
        recording = self.recording
        is_walk = recording is not None and recording.kind is RecordingKind.WALKING
        has_strides = recording is not None and any(len(gait.strides) for gait in recording.gait.values())
        self.view.blockSignals(True)
        self.view.set_word(WHOLE, tr(WALK if is_walk else RECORDING))
        for view in (ANSWER, COMPARE, STRIDES):
            self.view.set_offered(view, is_walk)
            self.view.set_reason(view, "" if has_strides else tr("no strides"))
        if self.view.choice in (ANSWER, WHOLE):
            self.view.choose(self._required if is_walk and has_strides else WHOLE)
        self.view.blockSignals(False)
        self._show_parts()

    def _show_behind(self, behind: Behind) -> None:
        self._behind = behind
        self.all_figures.show_on(behind is Behind.FIGURES)
        self._show_parts()

    def _show_parts(self) -> None:
        """Show what belongs to the view, or the details behind the answer."""
        if self._is_to_be_placed():  # each view has choices of its own
            self._place()
            return
        recording, view = self.recording, self.view.choice
        is_walk = recording is not None and recording.kind is RecordingKind.WALKING
        has_answer = is_walk and view == (ANSWER if self.view.segments[0].isEnabled() else WHOLE)
        has_door = self._visit is not None and view in (ANSWER, WHOLE)
        behind = self._behind if has_answer or (has_door and self._behind is Behind.QUALITY) else Behind.NOTHING
        is_answer = view == ANSWER and behind is Behind.NOTHING
        is_compact, is_quality = self._room.is_compact, behind is Behind.QUALITY
        has_curves = is_answer and not (is_compact and self.part.choice == TABLE)
        has_video = has_curves and self._tools.is_video
        self.view.setVisible(is_walk and not is_quality)
        self.to_answer.setVisible(is_quality)
        self.whole.methods.setVisible(view == WHOLE and not is_quality)
        self.part.setVisible(is_answer and is_compact)
        self.recordings.setVisible(view != COMPARE and self.recordings.count() > (1 if view == ANSWER else 0))
        has_thin = has_curves and self.thin.count() > 1 and not is_compact and not has_video
        self.thin.setVisible(has_thin)
        self.thin_name.setVisible(has_thin and self._tools.fitting.has_thin_name)
        self.show_legs.setVisible(has_curves and not has_video)
        self._tools.show_video_choices(is_offered=has_curves, is_shown=has_video)
        self._tools.against.setVisible(view == COMPARE)
        self._tools.beneath.setVisible(view == COMPARE and is_compact and not self._room.is_narrow)
        self.compare.setVisible(view == COMPARE)
        has_headline = has_answer and behind is Behind.NOTHING and bool(self.headline.text)
        if not has_video:
            self.video.hide()
        self.headline.setVisible(has_headline and not (is_compact and has_video))
        self.tiles.setVisible(is_answer and not has_video)
        self.video.synchronise.setVisible(has_video)
        self.whole.setVisible(view == WHOLE and not is_quality)
        self.cycles.setVisible((has_curves and not has_video) or (view == STRIDES and self._room.has_strides_beside))
        has_legs = has_curves and self.show_legs.isChecked() and not has_video
        self.legs.setVisible(has_legs)
        self._fit_charts(has_legs=has_legs)
        self.cycles.set_notes_shown(is_answer)
        self.strides.setVisible(view == STRIDES)
        self._show_strides()
        self._figures.setVisible(behind is Behind.FIGURES)
        self.quality.setVisible(is_quality)
        self.differs.setVisible(
            is_answer and self.differs.has_rows and not (is_compact and has_curves) and not has_video
        )
        self.video.setVisible(has_video)  # once the curves are hidden: both have no room beside each other
        is_table_alone = is_answer and not has_curves
        self._page.setStretchFactor(self._columns, 0 if is_table_alone else 1)
        self._page.setStretchFactor(self.differs, 1 if is_table_alone else 0)
        self.door.setVisible(has_door and not is_quality)
        self.repeat.setVisible(is_answer and self._is_live and self._mended_by_motion is not None and not is_compact)
        self.all_figures.setVisible(view == ANSWER and not is_quality and not has_video)
        self._page.activate()  # now, else the charts would be painted once too small and once right
        self.reported.emit()

    def _fit_charts(self, *, has_legs: bool) -> None:
        """Charts side by side where two have room; where there is little, the legs take the ankle's place."""
        room, charts = self._room, self.cycles.charts
        is_answer = self.view.choice == ANSWER
        has_hips = len(charts.frames) > len(LEG_KINDS)
        charts.set_side_by_side(is_answer and (has_hips or room.has_two_charts))
        charts.set_tight(is_tight=is_answer and (has_hips or room.is_compact))
        charts.ankle.setVisible(not (room.is_compact and has_legs))
        charts.show_cursor(dict.fromkeys(Side, self.legs.percent) if has_legs else {})

    def _on_view_chosen(self) -> None:
        if self.view.choice in (ANSWER, WHOLE) and self.view.segments[0].isEnabled():
            self._required = self.view.choice
        self._show_parts()

    def _on_door(self) -> None:
        self._show_behind(Behind.QUALITY)
        self.quality.focus()

    def _on_recording_changed(self) -> None:
        recording, visit = self.recording, self._visit
        self._show_quality()
        if visit is not None:
            is_walk = recording is not None and recording.kind is RecordingKind.WALKING
            self.video.show_walk(visit, recording if is_walk else None)
        called = self._called(recording.name) if recording is not None else ""
        self.whole.show_recording(recording, called, is_simulated=visit is not None and visit.analysis.is_simulated)
        if recording is None or visit is None:
            self._facts = self._headline = None
            self._offer()
            return
        self.strides.show_walk(recording, self._can_choose)
        self._show_walk()
        self._offer()

    def _called(self, name: str) -> str:
        """What a recording of this session is called."""
        return str(self._visit.shown_names.get(name, name)) if self._visit is not None else name

    def _show_walk(self) -> None:
        """Show the walk: headline, values, curves and what differs; then what is thin beside it."""
        recording, visit = self.recording, self._visit
        if recording is None or visit is None or recording.kind is not RecordingKind.WALKING:
            self._facts = self._headline = None
            self.headline.show_sentences("")
            return
        facts = Facts(visit, recording, course=self._course)
        headline = self._headline = headline_of(facts)
        self.thin.offer_beside(facts, headline)
        if self.thin.walks:
            facts = Facts(visit, recording, self.thin.walks, self._course)
            headline = self._headline = headline_of(facts)
        before, self._facts = self._facts, facts
        is_new = before is None or before.visit is not visit or before.walk.name != facts.walk.name
        self.headline.show_sentences(headline.first, headline.beside)
        self.tiles.show_tiles(tiles_of(facts))
        self.cycles.show_walk(facts.part, recording, facts.is_simulated, age_and_height(visit.session))
        self.differs.show_facts(facts)
        self._show_thin(is_walk_new=is_new)
        self._fit_table()

    def _show_thin(self, *, is_walk_new: bool = False) -> None:
        """Draw the thin line again, with what is marked on the curves; of a new walk the cursor is where it counts."""
        facts, headline = self._facts, self._headline
        if facts is None or headline is None:
            return
        chosen = self.thin.currentData()
        if isinstance(chosen, ThinLine) and chosen.is_visit and self.compare.visits is None:
            self.compare.wish_visits()
        found, words = self.thin.compared(facts, self.compare.visits)
        charts, bracket = self.cycles.charts, bracket_of(facts, headline)
        sides = frozenset((facts.affected,)) if facts.affected is not None else frozenset(Side)
        charts.show_beside(found, words, sides)
        charts.show_marks([bracket] if bracket is not None else [], gaps_of(facts))
        labels = [label for kind in facts.kinds for label in labels_of(facts, kind)]
        charts.show_labels(labels)
        knees = [label.point for label in labels if label.kind is JointKind.KNEE]
        points = bracket.points if bracket is not None else knees
        if is_walk_new and points:  # of the headline, else where the knee is bent most
            self.legs.percent = max(points, key=lambda one: one.angle_deg).percent
        self._thin = thin_bends(found) if found is not None else {}
        self._show_moving_legs()

    def _show_quality(self) -> None:
        """Say what can be read of a walk, and of anything else what was noticed."""
        recording, visit = self.recording, self._visit
        if visit is None:
            return
        line = None
        if recording is not None and recording.kind is RecordingKind.WALKING:
            facts = Facts(visit, recording)
            found, strides, calibrated = data_quality(facts), strides_in_short(facts), facts.calibrated
            line = quality_sentence(facts, found)
            joints = {joint: facts.verdicts.joint(joint).shape.verdict for joint in Joint if facts.is_measured(joint)}
        else:
            found, strides, joints = quality_without_walk(visit, recording.name if recording else ""), "", {}
            calibrated = visit.analysis.calibrated_for(recording) if recording is not None else {}
        sites = [site for site in Site if any(site in one.imu for one in visit.session.recordings)]
        self.door.show_message(door_words(found, line))
        self._mended_by_motion = line.line.side if line is not None and line.line is not None else None
        self.quality.show_quality(found, joints, sites, strides, can_repeat=self._is_live)
        names = visit.shown_names
        self.quality.show_engineering(
            calibrated,
            [with_shown_names(finding, names) for finding in visit.analysis.findings],
            recording.hips if recording is not None else {},
        )

    def _show_strides(self) -> None:
        """Draw single strides where they are chosen from; the one in force only there."""
        is_choosing = self.view.choice == STRIDES
        self.cycles.charts.set_strides_shown(is_choosing)
        self.cycles.charts.show_stride(self._stride if is_choosing else {})

    def _on_stride_chosen(self, curves_deg: Mapping[Joint, FloatArray]) -> None:
        self._stride = curves_deg
        self._show_strides()

    def _on_legs_toggled(self, is_on: bool) -> None:
        self._has_chosen_legs = True
        self._show_moving_legs()
        self._fit_table()
        self._show_parts()
        if is_on:
            self.legs.setFocus()

    def _on_video_toggled(self, is_on: bool) -> None:
        self._show_parts()
        if is_on:
            self.video.focus()

    def _show_moving_legs(self) -> None:
        """Draw the legs where they are shown; they take longest, and what was drawn of the same walk stays."""
        recording, visit, facts = self.recording, self._visit, self._facts
        if recording is None or visit is None or facts is None or not self.show_legs.isChecked():
            return
        if self._drawn is None or self._drawn[0] is not visit or self._drawn[1] is not recording:
            self._drawn = visit, recording, mean_legs(visit.session, visit.analysis, recording)
        knees = {
            side: facts.measured_curve_deg(side, JointKind.KNEE)
            if facts.verdicts.joint(knee_of(side)).shape.is_reported
            else None
            for side in facts.gait
        }
        self.legs.show_legs(self._drawn[2], knees, self._thin)

    def _on_cursor_moved(self, percent: float) -> None:
        self.cycles.charts.show_cursor(dict.fromkeys(Side, percent) if not self.legs.isHidden() else {})

    def _turn_band(self) -> None:
        """Show or hide the reference."""
        self._has_band = not self._has_band
        self.cycles.charts.set_band_shown(self._has_band)

    def _on_stride_picked(self, kind: JointKind, percent: float, angle_deg: float) -> None:
        if self.legs.isVisible():
            self.legs.show_percent(percent)
        elif self.view.choice == STRIDES:
            self.strides.choose_nearest(kind, percent, angle_deg, self.cycles.charts.heights_deg)

    def _on_thin_changed(self) -> None:
        if self._facts is not None and bool(self._facts.chosen) != bool(self.thin.walks):
            self._show_walk()  # of one condition with the other walk it now stands alone, or together again
        else:
            self._show_thin()


def _least_width(widget: QWidget) -> int:
    return widget.minimumSizeHint().width()
