"""What joins the bench to the visit: which alignments are shown, what the next walk is walked with, what leads back."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal, Slot

from app.summary.agreed import agreed_with
from app.summary.comparison import Comparison, Contrast
from app.summary.conditions import Part, parts_of
from app.summary.numbers_in_words import fixed
from app.summary.set_angle import set_angle, set_angle_in_words
from app.wizard.evaluation import failure_in_words
from app.wizard.walking.alignment_card import AlignmentRow, RowRole
from app.wizard.walking.bench import AlignmentChain, ChangeEntry, chain_of, next_walk
from app.wizard.walking.bench_view import BenchState
from app.wizard.walking.bench_words import SPEED, Answer, Outcome, bench_answer, variation_sentence
from app.wizard.walking.shown_before import ShownBefore
from app.wizard.walking.walk_labels import new_alignment
from app.wording.alignment import change_lines, to_do_in_words
from app.wording.recordings import is_alignment, name_in_words
from app.wording.translation import tr
from core.alignment import AlignmentChange
from core.body import JointKind, Side
from core.session import Recording

if TYPE_CHECKING:
    from app.wizard.visit import Visit


class Bench(QObject):
    """Knows the visit and no page."""

    changed = Signal()  # something else is to be shown

    def __init__(self, visit: "Visit", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._visit = visit
        self.entry = ChangeEntry()
        self.is_requested = True  # else the list of walks is shown there
        self._returned_to = ""
        self._shown = self._beside = ""  # letters; empty: the latest, and what it was changed from
        self._to_undo = ""  # in words, as long as the prosthesis counts as put back
        self._discarded = ""  # the name of the latest walk, if it was discarded and the next is as it was
        self._may_undo_return = False
        self._shown_before = ShownBefore()

    @property
    def side(self) -> Side | None:
        """The prosthetic one; None where there is none, or both are: no side is sound then."""
        sides = self._visit.prosthetic_sides
        return next(iter(sides)) if len(sides) == 1 else None

    @property
    def is_offered(self) -> bool:
        """Whether the latest counting walk had an alignment; after any other walk the setting is unknown."""
        kept = [one.details.condition for one in self._visit.recordings.walks if one.details.is_kept]
        return self.side is not None and bool(kept) and is_alignment(kept[-1])

    @property
    def is_shown(self) -> bool:
        """Whether it is shown in the place of the walks, while none is recorded."""
        return self.is_requested and self.is_offered

    def turn(self) -> None:
        """Show it, or all walks in its place."""
        self.is_requested = not self.is_requested
        self.changed.emit()

    @property
    def chain(self) -> AlignmentChain:
        return chain_of([one.details for one in self._visit.recordings.every], self._returned_to)

    def next_walk(self) -> tuple[str, AlignmentChange | None]:
        """What the next walk is called and what was changed before it."""
        chain = self.chain
        return next_walk(chain, self.entry, new_alignment(chain.next_letter, list(chain.changes)))

    def begun(self) -> None:
        """The next walk begins: what was entered for it is its own now."""
        self.entry.load(())
        self._returned_to = self._shown = self._beside = self._to_undo = self._discarded = ""
        self._may_undo_return = False

    def discarded(self, walk: Recording) -> None:
        """A walk does not count, but the prosthesis is still as it was then: what changed is entered for the next."""
        known, change, walks = self.chain.changes, walk.alignment, self._visit.recordings.walks
        is_latest = bool(walks) and walks[-1].details.name == walk.name
        if is_latest and change is not None and change.returns_to in known:
            self._returned_to, self._discarded = change.returns_to, walk.name
        elif is_latest and walk.condition in known:
            self._returned_to, self._discarded = walk.condition, walk.name
        elif is_latest and change is not None and not self.entry.parts and change.since in known:
            self._returned_to, self._discarded = change.since, walk.name
            self.entry.load(change.parts)
        self._shown = self._beside = ""
        self.changed.emit()

    def counts_again(self, walk: Recording) -> None:
        """A discarded walk counts after all: what was entered for the next because of it is its own again."""
        if walk.name != self._discarded:
            return
        self._returned_to = self._discarded = ""
        if walk.alignment is not None and walk.alignment.parts == self.entry.parts:
            self.entry.load(())
        self.changed.emit()

    def return_to_first(self) -> str:
        """Say that the prosthesis is put back to where it began; gives what is to be turned, empty where nothing is."""
        chain = self.chain
        back = chain.way_back(chain.first)
        if not back:
            return ""
        self._returned_to, self._to_undo, self._may_undo_return = chain.first, to_do_in_words(back), True
        self.changed.emit()
        letter = chain.letters.get(chain.first, "")
        return tr("Back to {letter}: {changes}").format(letter=letter, changes=self._to_undo)

    def undo_return(self) -> bool:
        """Take back that it was put back; whether it was."""
        if not self._may_undo_return:
            return False
        self._returned_to, self._to_undo, self._may_undo_return = "", "", False
        self.changed.emit()
        return True

    def settle_return(self) -> None:
        """Something else can be taken back now."""
        self._may_undo_return = False

    def returns_as(self, label: str) -> bool:
        """Whether the prosthesis was put back since the latest walk, and the next one is called so then."""
        return bool(self._returned_to) and not self.entry.parts and self.next_walk()[0] == label

    @Slot(int, bool)
    def choose(self, number: int, is_beside: bool) -> None:
        """Show an alignment by its number from 0, or let it stand beside."""
        parts = self._parts()
        if not 0 <= number < len(parts):
            return
        if is_beside:
            self._beside = parts[number].letter
        else:
            self._shown, self._beside = parts[number].letter, ""
        self._shown_before.chosen()
        self.changed.emit()

    def state(self) -> BenchState | None:
        """All that is shown; None where the bench means nothing."""
        side, parts = self.side, self._parts()
        if side is None:
            return None
        analysis = self._visit.evaluation.analysis
        shown = next((part for part in parts if part.letter == self._shown), parts[-1] if parts else None)
        is_simulated = analysis is not None and analysis.is_simulated
        every = Comparison(Contrast.CONDITIONS, parts, is_simulated=is_simulated) if parts else None
        beside = None
        if shown is not None and every is not None:
            beside = next((part for part in parts if part.letter == self._beside), every.base_of(shown))
        found = None
        if shown is not None and beside is not None and beside is not shown:
            found = Comparison(Contrast.CONDITIONS, (beside, shown), is_simulated=is_simulated)
        self.entry.known = self.chain.known
        self.entry.has_knee = JointKind.KNEE.of(side) in self._visit.prosthetic_joints
        drawn = found.parts if found is not None else [shown] if shown is not None else []
        return BenchState(
            self._answer(found, side, shown),
            self._rows(every, shown, beside if found else None) if every is not None else [],
            self.next_title,
            side,
            drawn,
            found,
            is_simulated,
            self._notes(found, side, parts),
        )

    def _notes(self, found: Comparison | None, side: Side, parts: tuple[Part, ...]) -> tuple[str, ...]:
        """What was set at the foot beside what is measured, how walks vary, and what is shown otherwise than before."""
        if found is None or (self._is_behind and not self._shown):
            return ()
        shown = set_angle(found, found.parts[1], found.against, side, self.chain.changes)
        words = set_angle_in_words(shown) if shown is not None else ""
        every = [words, variation_sentence(found, side, parts), self._shown_before.note(found, side)]
        return tuple(filter(None, every))

    @property
    def next_title(self) -> str:
        chain = self.chain
        base = chain.letters.get(chain.base, "")
        if self.entry.parts:
            return tr("{letter}: changed from {base}").format(letter=chain.next_letter, base=base)
        if self._to_undo:
            stated = tr("{letter}: {base} again. Undo first: {changes}")
            return stated.format(letter=chain.again_letter, base=base, changes=self._to_undo)
        if chain.is_back:
            return tr("{letter}: {base} again").format(letter=chain.again_letter, base=base)
        return tr("Next change, from {base}").format(base=base)

    @property
    def _is_behind(self) -> bool:
        """Whether a walk that counts is not among those that are shown, or only a part of it: it was going on then."""
        session = self._visit.evaluation.session
        known = {one.name: one.imu for one in session.recordings} if session is not None else {}
        for one in self._visit.recordings.walks:
            if one.details.is_kept:
                is_known, whole = one.details.name in known, one.read_back
                if not is_known or (whole is not None and known[one.details.name] is not whole.imu):
                    return True
        return self._visit.evaluation.is_busy

    def _parts(self) -> tuple[Part, ...]:
        evaluation = self._visit.evaluation
        if evaluation.analysis is None or evaluation.session is None:
            return ()
        session = evaluation.session
        parts = parts_of(evaluation.analysis, session.recordings, agreed=agreed_with(session))
        return tuple(part for part in parts if not part.is_apart)

    def _answer(self, found: Comparison | None, side: Side, shown: Part | None) -> Answer:
        if self._is_behind and (shown is None or not self._shown):
            if self._visit.evaluation.has_failed:
                return Answer(Outcome.OPEN, *failure_in_words())
            return Answer(Outcome.OPEN, tr("The walk is being analysed."), "")
        if shown is None:
            return Answer(
                Outcome.OPEN,
                tr("No walk to compare yet."),
                tr("Record a walk without a timed test or a target on the patient screen."),
            )
        if found is not None:
            return bench_answer(found, side)
        first = tr("{letter} is the starting point. Change one thing, enter the change, then record a walk.")
        return Answer(
            Outcome.OPEN, first.format(letter=shown.letter), tr("Enter the change before you record its walk.")
        )

    def _rows(self, every: Comparison, shown: Part | None, beside: Part | None) -> list[AlignmentRow]:
        side, parts, rows = self.side, every.parts, []
        for part in parts:
            since, base = "", every.base_of(part)
            if part.is_again(base):
                since = tr("{letter} again").format(letter=base.letter)
            elif part.alignment is not None:
                of_since = base.letter if base.name == part.alignment.since else name_in_words(part.alignment.since)
                since = tr("{base}, changed").format(base=of_since)
            speed = part.of_both(SPEED)
            strides = part.strides(side) if side is not None else 0
            note = tr("{strides} strides · {speed} m/s").format(strides=strides, speed=fixed(speed, 2))
            if len(part.walks) > 1:
                note = tr("{count} walks, {note}").format(count=len(part.walks), note=note)
            role = RowRole.SHOWN if part is shown else RowRole.BESIDE if part is beside else RowRole.NONE
            title = since or (tr("Starting point") if part is parts[0] else name_in_words(part.name))
            rows.append(AlignmentRow(part.letter, title, note, tuple(change_lines(part.alignment)), role))
        return rows
