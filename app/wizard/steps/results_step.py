"""What came of the walks: curves, figures and findings of those that are kept."""

from dataclasses import replace
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QStackedWidget, QWidget

from app.pages.sentence_page import SentencePage
from app.theme import Look
from app.widgets.action_bar import BarState, Verb
from app.widgets.icons import Icon
from app.widgets.start_pages import WorkingPage
from app.widgets.step_rail import StepState
from app.wizard.steps.step import Step
from app.wording import place, tr

if TYPE_CHECKING:
    from collections.abc import Sequence

    from app.pages.result_page import ResultPage
    from app.wizard.visit import Visit
    from core.results import Analysis
    from core.samples import Recording


class ResultsStep(Step):
    def __init__(self, look: Look, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(look, visit, parent)
        self._frame: _ResultsFrame | None = None
        self._shown: Analysis | None = None
        visit.takes.changed.connect(self._on_takes_changed)
        visit.evaluation.done.connect(self._on_evaluated)
        visit.evaluation.progressed.connect(self._on_progressed)

    @property
    def page(self) -> "_ResultsFrame":
        if self._frame is None:
            self._frame = _ResultsFrame(self._look)
            self._frame.sentence.pressed.connect(self._on_sentence_pressed)
        return self._frame

    @property
    def title(self) -> str:
        return tr("Results")

    @property
    def note(self) -> str:
        kept = len(self._kept_walks)
        return tr("{count} kept").format(count=kept) if kept else ""

    @property
    def state(self) -> StepState:
        return StepState.DONE if self._shown is not None and self._kept_walks else StepState.TODO

    @property
    def topic(self) -> str:
        return "results"

    @property
    def _kept_walks(self) -> list[object]:
        return [take for take in self._visit.takes.walks if take.told.is_kept]

    def enter(self) -> None:
        if self._kept_walks:
            self._visit.end_stopwatch()
        evaluation = self._visit.evaluation
        recordings = self._visit.takes.recordings()
        is_stale = evaluation.session is None or not _are_same(evaluation.session.recordings, recordings)
        if recordings and is_stale and not evaluation.is_busy:
            self._visit.evaluate()
        self._show()

    def bar(self) -> BarState:
        if self._shown is None or not self._kept_walks:
            return BarState()
        return BarState(primary=Verb(tr("Go to the report"), tr("Enter"), Icon.CHEVRON))

    def on_primary(self) -> None:
        if self.bar().primary is not None:
            self.done.emit()

    def _show(self) -> None:
        page, evaluation = self.page, self._visit.evaluation
        if evaluation.is_busy:
            page.working.begin(tr("Analysing the walks"))
            page.setCurrentWidget(page.working)
        elif evaluation.analysis is None or not evaluation.analysis.recordings:
            page.sentence.show_sentence(
                tr("No walk is kept yet."), tr("Record one, or keep one that was discarded."), tr("Go to Walking")
            )
            page.setCurrentWidget(page.sentence)
        else:
            results = page.results()
            if self._shown is not evaluation.analysis:
                self._shown = evaluation.analysis
                self._show_analysis(results, evaluation.analysis)
            page.setCurrentWidget(results)
            results.focus()
        self.changed.emit()

    def _show_analysis(self, results: "ResultPage", analysis: "Analysis") -> None:
        session = self._visit.evaluation.session
        results.show_analysis(
            analysis,
            session.recordings if session is not None else (),
            is_prosthetic=bool(self._visit.prosthetic_sides),
        )

    def _is_in_sight(self) -> bool:
        return self._frame is not None and self._frame.isVisible()

    def _on_takes_changed(self) -> None:
        self.changed.emit()

    def _on_evaluated(self) -> None:
        if self._is_in_sight():
            self._show()

    def _on_progressed(self, share: float, what: str) -> None:
        if self._is_in_sight():
            words = place(what)
            self.page.working.show_progress(share, words[:1].upper() + words[1:])

    def _on_sentence_pressed(self) -> None:
        self.jumped.emit(4)


def _are_same(evaluated: "Sequence[Recording]", recordings: "Sequence[Recording]") -> bool:
    """Whether these are the recordings that were evaluated, with the very samples: amid a walk only a part was seen."""
    return len(evaluated) == len(recordings) and all(
        one.imu is other.imu and replace(one, imu={}) == replace(other, imu={})
        for one, other in zip(evaluated, recordings, strict=True)
    )


class _ResultsFrame(QStackedWidget):
    """The results, or what stands in their place."""

    def __init__(self, look: Look) -> None:
        super().__init__()
        self._look = look
        self.sentence = SentencePage(look)
        self.working = WorkingPage(look)
        self.working.stop.hide()  # an analysis takes a second; there is nothing to go back to
        self._results: ResultPage | None = None
        self._room = (0.0, 0.0)
        for page in (self.sentence, self.working):
            self.addWidget(page)

    def results(self) -> "ResultPage":
        if self._results is None:
            from app.pages.result_page import ResultPage  # its imports take a second

            self._results = ResultPage(self._look)
            self._results.set_room(*self._room)
            self.addWidget(self._results)
        return self._results

    def set_room(self, width: float, height: float) -> None:
        self._room = width, height
        if self._results is not None:
            self._results.set_room(width, height)

    def focus(self) -> None:
        shown: QWidget | None = self.currentWidget()
        if self._results is not None and shown is self._results:
            self._results.focus()
        elif shown is self.sentence:
            self.sentence.button.setFocus()
