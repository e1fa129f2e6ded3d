"""The clip of a walk beside its curves: one cursor for the picture, three seconds of curves, and the whole walk."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from time import monotonic
from uuid import UUID

import numpy as np
from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QAccessible, QAccessibleAnnouncementEvent, QHideEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.plots.moment_chart import MomentFrame
from app.plots.walk_strip import WalkStrip
from app.results.beside_stride import place_at, time_at, used_strides
from app.results.shown_clips import (
    ClipsOfVisit,
    ShownClip,
    clips_beside,
    clips_of_walk,
    has_heights,
    stride_at,
    values_at,
)
from app.summary.request import AnalysedVisit
from app.video.player import ClipPlayer
from app.video.sync_row import SyncRow
from app.video.sync_words import sync_in_words
from app.video.transport import TransportRow
from app.widgets.button import Button, ButtonKind
from app.widgets.choice import Choice
from app.widgets.lay_out import lay_out
from app.widgets.text import MEDIUM, Text
from app.wording.body import side_name
from app.wording.translation import figure_text, tr
from core.body import JointKind, Side
from core.results import RecordingAnalysis
from core.samples import FloatArray
from core.video.clip import Clip, Sync, SyncBy
from core.video.moments import Moment, moments_s

WINDOW_S = 3.0
EDGE, TURNED = 0.1, 0.2  # of the window: so near to its end it is turned on, so far in the cursor is then
TICK_MS = 16  # half the time of a frame
STEP_S, LONG_STEP_S = 0.01, 0.1  # of the arrows
CHOICE = (116, 240)  # px: the narrowest and the widest that a choice becomes
BOTTOM = 40


class VideoPage(QWidget):
    """`clip`, `beside` and `synchronise` are placed by the page around.

    `synchronised` gives a clip's id and its Sync, as somebody confirmed it.
    """

    synchronised = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self._clips: list[Clip] = []
        self._visits: Sequence[ClipsOfVisit] = ()
        self._visit: AnalysedVisit | None = None
        self._walk: RecordingAnalysis | None = None
        self._known: Mapping[UUID, ShownClip] = {}  # what is offered, by the clip's id
        self._held_frame: int | None = None  # while it is synchronised by hand
        self._is_compact = False
        self._window_s = (0.0, WINDOW_S)
        self._loop_s: tuple[float, float] | None = None
        self._played_from_s = self._began_s = 0.0
        self.cursor_s = 0.0
        self.clip, self.beside = Choice(tr("Clip")), Choice(tr("Beside"))
        for choice in (self.clip, self.beside):
            choice.let_shrink(*CHOICE)
            choice.set_height(44)
        self.synchronise = Button(tr("Synchronise at a contact"), ButtonKind.QUIET, height=BOTTOM)
        self.player, self.other = ClipPlayer(), ClipPlayer()
        self.other.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.transport = TransportRow()
        self.sync = SyncRow()
        self.knee = MomentFrame(JointKind.KNEE, has_times=False)
        self.ankle = MomentFrame(JointKind.ANKLE, has_times=True)
        self.frames = (self.knee, self.ankle)
        self.percent = Text(size=14, weight=MEDIUM)
        self.strip = WalkStrip()
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(TICK_MS)
        self.now_s: Callable[[], float] = monotonic
        within = Qt.ShortcutContext.WidgetWithChildrenShortcut
        self._escape = QShortcut(QKeySequence(Qt.Key.Key_Escape), self, context=within)
        self._build()
        self._connect()

    def show_clips(self, clips: Sequence[Clip]) -> None:
        """Have these clips of the visit's walks; which of them are shown follows the walk."""
        self._clips = list(clips)
        self._offer()

    def show_clips_of_visits(self, visits: Sequence[ClipsOfVisit]) -> None:
        """Offer clips of other visits to be shown beside."""
        self._visits = visits
        self._offer()

    def show_walk(self, visit: AnalysedVisit, walk: RecordingAnalysis | None) -> None:
        """Show a walk of the visit; the cursor begins at the first used stride."""
        is_new = walk is not self._walk
        self._visit, self._walk = visit, walk
        if walk is None:
            self._offer()
            return
        if is_new:
            self._show_curves(walk)
            starts = [float(spans[0, 0]) for side in Side if len(spans := used_strides(walk, side))]
            self.cursor_s = min(starts, default=float(walk.time_s[0]) if len(walk.time_s) else 0.0)
            self._window_s = (self.cursor_s - WINDOW_S / 2, self.cursor_s + WINDOW_S / 2)
        self._offer()

    @property
    def has_clips(self) -> bool:
        """Whether any walk of the visit has a clip."""
        return bool(self._clips)

    @property
    def has_clip(self) -> bool:
        """Whether the walk that is shown has one."""
        return self._walk is not None and any(clip.recording == self._walk.name for clip in self._clips)

    @property
    def shown(self) -> ShownClip | None:
        return self._known.get(self.clip.currentData())

    @property
    def shown_beside(self) -> ShownClip | None:
        """None where this clip has no time of the samples, and so no stride."""
        is_timed = self.shown is not None and self.shown.clip.sync is not None
        return self._known.get(self.beside.currentData()) if is_timed else None

    @property
    def is_playing(self) -> bool:
        return self._timer.isActive()

    @property
    def is_synchronising(self) -> bool:
        return self._held_frame is not None

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.player, *self.transport.tab_order, *self.sync.tab_order]

    def clear(self) -> None:
        """Drop every clip and picture, as at Lock."""
        self.stop()
        self._clips, self._visits, self._held_frame = [], (), None
        self._offer()

    def focus(self) -> None:
        self.player.setFocus()

    def set_compact(self, is_compact: bool) -> None:
        """Where there is little room the clip takes the ankle's place."""
        self._is_compact = is_compact
        self.ankle.setVisible(not is_compact)
        self.knee.chart.set_times_shown(is_compact)

    def move_to(self, time_s: float) -> None:
        """Move the one cursor; the nearest frame follows."""
        walk = self._walk
        if walk is None or not len(walk.time_s):
            return
        self.cursor_s = min(max(time_s, float(walk.time_s[0])), float(walk.time_s[-1]))
        self._show_moment()

    def step_frame(self, frames: int) -> None:
        """Go on by frames of the clip; while it is synchronised by hand the cursor stays."""
        shown = self.shown
        if shown is None or not len(shown.clip.stamped_s):
            return
        self.stop()
        at = self._held_frame if self._held_frame is not None else shown.clip.nearest(self.cursor_s)
        at = min(max(at + frames, 0), len(shown.clip.stamped_s) - 1)
        if self._held_frame is not None:
            self._held_frame = at
            self._show_moment()
        else:
            self.move_to(float(shown.clip.time_s[at]))
            self._announce()

    def step_moment(self, way: int) -> None:
        """Go to the next moment of the chosen kind, -1 earlier or 1 later; a contact where it is synchronised."""
        if self._walk is None:
            return
        self.stop()
        side, moment = self.transport.chosen
        times_s = self._contacts_s() if self.is_synchronising else moments_s(self._walk, side, moment)
        beyond = times_s[times_s > self.cursor_s + 1e-6] if way > 0 else times_s[times_s < self.cursor_s - 1e-6]
        if len(beyond):
            self.move_to(float(beyond[0] if way > 0 else beyond[-1]))
            self._announce()

    def turn(self) -> None:
        """Play, or pause."""
        if self.is_playing:
            self.stop()
        elif self.shown is not None and self._walk is not None and len(self._walk.time_s):
            last_s = float(self._walk.time_s[-1])
            if not self.is_synchronising and self.cursor_s >= last_s:
                self.move_to(float(self._walk.time_s[0]))
            self._begin_to_play()
            self._timer.start()
            self.transport.show_playing(is_playing=True)

    def stop(self) -> None:
        self._timer.stop()
        self.transport.show_playing(is_playing=False)
        self._describe()

    def start_synchronising(self) -> None:
        """Hold the frame, and put the cursor on the nearest contact."""
        shown, contacts_s = self.shown, self._contacts_s()
        if shown is None or not len(shown.clip.stamped_s) or not len(contacts_s):
            return
        self.stop()
        self.beside.setCurrentIndex(0)
        self._held_frame = shown.clip.nearest(self.cursor_s)
        self.move_to(float(contacts_s[np.argmin(np.abs(contacts_s - self.cursor_s))]))
        self._show_parts()
        self.player.setFocus()

    def hideEvent(self, event: QHideEvent) -> None:
        self.stop()
        super().hideEvent(event)

    def _build(self) -> None:
        left = lay_out(QVBoxLayout(), (self.player, 1), self.transport, self.sync, spacing=10)
        self._charts, self._aside = QWidget(), QWidget()
        lay_out(QVBoxLayout(self._charts), (self.knee, 1), (self.ankle, 1), margins=0, spacing=10)
        lay_out(QVBoxLayout(self._aside), (self.other, 1), self.percent, margins=0, spacing=10)
        self.percent.setAlignment(Qt.AlignmentFlag.AlignCenter)
        columns = lay_out(QHBoxLayout(), (left, 1), (self._charts, 1), (self._aside, 1), spacing=12)
        lay_out(QVBoxLayout(self), (columns, 1), self.strip, margins=0, spacing=10)
        self._show_parts()

    def _connect(self) -> None:
        self._timer.timeout.connect(self._on_beat)
        self.clip.currentIndexChanged.connect(self._on_clip_chosen)
        self.beside.currentIndexChanged.connect(self._on_beside_chosen)
        self.transport.play.clicked.connect(self.turn)
        self.transport.loop.toggled.connect(self._begin_to_play)
        self.transport.speeds.chosen.connect(self._begin_to_play)
        self.transport.stepped.connect(self.step_moment)
        self.transport.moments.currentIndexChanged.connect(self._on_leg_chosen)
        self.player.clicked.connect(self.turn)
        self.player.dragged.connect(self._on_dragged)
        self.strip.pointed.connect(self._on_pointed)
        for frame in self.frames:
            frame.chart.pointed.connect(self._on_pointed)
        self.synchronise.clicked.connect(self.start_synchronising)
        self.sync.stepped.connect(self.step_frame)
        self.sync.confirmed.connect(self._on_confirmed)
        self.sync.cancelled.connect(self._stop_synchronising)
        here, within = Qt.ShortcutContext.WidgetShortcut, Qt.ShortcutContext.WidgetWithChildrenShortcut
        keys: tuple[tuple[QKeySequence, QWidget, Qt.ShortcutContext, Callable[[], None]], ...] = (
            (QKeySequence(Qt.Key.Key_Space), self.player, here, self.turn),
            (QKeySequence(Qt.Key.Key_Left), self.player, here, lambda: self._step(-STEP_S)),
            (QKeySequence(Qt.Key.Key_Right), self.player, here, lambda: self._step(STEP_S)),
            (QKeySequence("Shift+Left"), self.player, here, lambda: self._step(-LONG_STEP_S)),
            (QKeySequence("Shift+Right"), self.player, here, lambda: self._step(LONG_STEP_S)),
            (QKeySequence(Qt.Key.Key_Comma), self, within, lambda: self.step_frame(-1)),
            (QKeySequence(Qt.Key.Key_Period), self, within, lambda: self.step_frame(1)),
            (QKeySequence(Qt.Key.Key_PageUp), self, within, lambda: self.step_moment(-1)),
            (QKeySequence(Qt.Key.Key_PageDown), self, within, lambda: self.step_moment(1)),
            (QKeySequence(tr("L")), self, within, self.transport.loop.click),
        )
        self._escape.activated.connect(self._stop_synchronising)
        for key, owner, context, act in keys:
            shortcut = QShortcut(key, owner, context=context)
            shortcut.activated.connect(act)

    def _offer(self) -> None:
        """Offer the clips of the walk, and those of other walks and visits to be beside; show what is chosen."""
        shown, beside, visit, walk = self.shown, self.shown_beside, self._visit, self._walk
        own, others = list[ShownClip](), list[tuple[str, ShownClip]]()
        if visit is not None and walk is not None:
            own = clips_of_walk(visit, self._clips, walk.name)
            others = clips_beside(visit, self._clips, walk.name, self._visits)
        self._known = {one.clip.id: one for one in (*own, *(one for _, one in others))}
        self.clip.offer([(one.view, one.clip.id) for one in own], shown.clip.id if shown else None)
        lines: list[tuple[str, object]] = [(tr("Nothing beside"), None)]
        lines += [(words, one.clip.id) for words, one in others]
        self.beside.offer(lines, beside.clip.id if beside else None)
        self._on_clip_chosen()

    def _on_clip_chosen(self) -> None:
        self._held_frame = None
        shown = self.shown
        if shown is None:
            self.stop()
            self.player.clear()
        else:
            clip = shown.clip
            self.player.show_clip(clip, shown.what, sync_in_words(clip), is_caution=not clip.is_synchronised)
        self._show_beside()

    def _on_beside_chosen(self) -> None:
        self._held_frame = None
        self._show_beside()

    def _show_beside(self) -> None:
        other = self.shown_beside
        if other is None:
            self.other.clear()
        else:
            clip = other.clip
            self.other.show_clip(clip, other.what, sync_in_words(clip), is_caution=not clip.is_synchronised)
        self._show_parts()
        self._show_moment()

    def _show_parts(self) -> None:
        is_beside = self.shown_beside is not None
        for usual, other, is_other in (
            (self._charts, self._aside, is_beside),
            (self.transport, self.sync, self.is_synchronising),
        ):
            (usual if is_other else other).hide()  # before the other comes: there is no room for both
            (other if is_other else usual).show()
        self.synchronise.setEnabled(self.shown is not None and not self.is_synchronising)
        self.beside.setEnabled(self.shown is not None and self.shown.clip.sync is not None)
        self._escape.setEnabled(self.is_synchronising)  # else it is the window's

    def _show_curves(self, walk: RecordingAnalysis) -> None:
        is_simulated = self._visit is not None and self._visit.analysis.is_simulated
        contacts_s = {side: moments_s(walk, side, Moment.INITIAL_CONTACT) for side in Side}
        for frame in self.frames:
            joints = {side: frame.chart.kind.of(side) for side in Side}
            drawn = {
                side: joint
                for side, joint in joints.items()
                if joint in walk.joints and walk.verdicts.joint(joint).shape.is_reported
            }
            curves_deg: Mapping[Side, FloatArray] = {
                side: np.rad2deg(walk.joints[joint].angle_rad) for side, joint in drawn.items()
            }
            frame.show_curves(
                walk.time_s,
                curves_deg,
                contacts_s,
                is_about_mean=not has_heights(walk, frame.chart.kind),
                is_simulated=is_simulated,
            )
        self.strip.show_walk(walk)

    def _show_moment(self) -> None:
        """Show the cursor everywhere, and the frames that are nearest to it."""
        walk, shown = self._walk, self.shown
        if walk is None or not len(walk.time_s):
            return
        if shown is not None:  # first, so that it is decoded meanwhile
            self._show_frame(self.player, shown, self.cursor_s, self._held_frame)
        self._show_other_moment()
        self._bring_in_sight(walk)
        for frame in self.frames:
            frame.chart.set_cursor(self.cursor_s)
        self.strip.lanes.show_cursor(self.cursor_s, self._window_s)
        if self.is_synchronising and (side := self._contact_at(self.cursor_s)) is not None:
            self.sync.show_contact(side, self.cursor_s)
        if not self.is_playing:
            self._describe()

    def _show_frame(self, player: ClipPlayer, shown: ShownClip, time_s: float, held: int | None = None) -> None:
        """Show the frame nearest to a time; its values where both have one time for certain."""
        number = held if held is not None else shown.clip.frame_at(time_s)
        if number is None:
            player.note = tr("The video has no frame at this time.")
        player.show_frame(number)
        has_values = held is None and number is not None and shown.clip.is_synchronised
        player.show_values(values_at(shown.walk, time_s) if has_values else ())

    def _show_other_moment(self) -> None:
        """Show the other clip at the same percent of its own stride."""
        walk, other = self._walk, self.shown_beside
        if walk is None or other is None:
            return
        side, _ = self.transport.chosen
        place = place_at(used_strides(walk, side), self.cursor_s)
        time_s = time_at(used_strides(other.walk, side), place) if place is not None else None
        if place is None or time_s is None:
            self.percent.setText(tr("Not in a used {side} stride").format(side=side_name(side)))
            self.other.note = tr("Shown within used {side} strides.").format(side=side_name(side))
            self.other.show_frame(None)
            self.other.show_values(())
            return
        stated = tr("Both at {percent:.0f} % of the {side} stride")
        self.percent.setText(stated.format(percent=place.percent, side=side_name(side)))
        self._show_frame(self.other, other, time_s)

    def _bring_in_sight(self, walk: RecordingAnalysis) -> None:
        """Turn the window on like a page: a curve that is clicked does not move away under the mouse."""
        first_s, last_s = float(walk.time_s[0]), float(walk.time_s[-1])
        start_s, end_s = self._window_s
        if self.cursor_s > end_s - EDGE * WINDOW_S:
            start_s = self.cursor_s - TURNED * WINDOW_S
        elif self.cursor_s < start_s + EDGE * WINDOW_S:
            start_s = self.cursor_s - (1 - TURNED) * WINDOW_S
        start_s = max(min(start_s, last_s - WINDOW_S), first_s)
        self._window_s = start_s, min(start_s + WINDOW_S, last_s)
        for frame in self.frames:
            if not np.allclose(frame.chart.visible_s, self._window_s, atol=1e-6):
                frame.chart.see(*self._window_s)

    def _begin_to_play(self, _changed: object = None) -> None:
        """Play on from the cursor, as fast as chosen, round the stride that it is in."""
        self._began_s = self.now_s()
        self._played_from_s = self.cursor_s
        shown, held = self.shown, self._held_frame
        if shown is not None and held is not None:
            self._played_from_s = float(shown.clip.stamped_s[held])
        self._loop_s = None
        if self.transport.loop.isChecked() and self._walk is not None:
            self._loop_s = stride_at(self._walk, self.transport.chosen[0], self.cursor_s)

    def _on_beat(self) -> None:
        walk, shown = self._walk, self.shown
        if walk is None or shown is None:
            self.stop()
            return
        time_s = self._played_from_s + self.transport.speed * (self.now_s() - self._began_s)
        if self._held_frame is not None:
            self._held_frame = int(np.argmin(np.abs(shown.clip.stamped_s - time_s)))
            self._show_moment()
            if self._held_frame == len(shown.clip.stamped_s) - 1:
                self.stop()
            return
        if self._loop_s is not None:
            start_s, end_s = self._loop_s
            time_s = start_s + math.fmod(time_s - start_s, end_s - start_s)
        self.move_to(time_s)
        if time_s >= float(walk.time_s[-1]):
            self.stop()

    def _step(self, by_s: float) -> None:
        if self.is_synchronising:
            self.step_moment(1 if by_s > 0 else -1)
            return
        self.stop()
        self.move_to(self.cursor_s + by_s)
        self._announce()

    def _on_pointed(self, time_s: float) -> None:
        self.player.setFocus(Qt.FocusReason.MouseFocusReason)
        self.stop()
        if self.is_synchronising:
            contacts_s = self._contacts_s()
            time_s = float(contacts_s[np.argmin(np.abs(contacts_s - time_s))])
        self.move_to(time_s)

    def _on_dragged(self, frames: int) -> None:
        if not self.is_synchronising:
            self.start_synchronising()
        self.step_frame(frames)

    def _on_leg_chosen(self) -> None:
        self._begin_to_play()
        self._show_other_moment()

    def _on_confirmed(self) -> None:
        shown, frame = self.shown, self._held_frame
        if shown is None or frame is None:
            return
        clip = shown.clip
        sync = Sync(self.cursor_s - float(clip.stamped_s[frame]), 1.0 / clip.rate_hz, SyncBy.HAND)
        self._clips = [replace(one, sync=sync) if one.id == clip.id else one for one in self._clips]
        self._held_frame = None
        self._offer()
        self.player.setFocus()
        self.synchronised.emit(clip.id, sync)

    def _stop_synchronising(self) -> None:
        self._held_frame = None
        self.stop()
        self._show_parts()
        self._show_moment()
        self.player.setFocus()

    def _contacts_s(self) -> FloatArray:
        """Of both feet, ascending."""
        if self._walk is None:
            return np.zeros(0)
        return np.sort(np.concatenate([moments_s(self._walk, side, Moment.INITIAL_CONTACT) for side in Side]))

    def _contact_at(self, time_s: float) -> Side | None:
        walk = self._walk
        sides = [] if walk is None else [s for s in Side if time_s in moments_s(walk, s, Moment.INITIAL_CONTACT)]
        return sides[0] if sides else None

    def _describe(self) -> None:
        for part in (self.player, self.other, *self.frames):
            part.describe()

    def _announce(self) -> None:
        readings = [reading for frame in self.frames for reading in frame.readings()]
        stated = " ".join([f"{figure_text(self.cursor_s, '.2f')} s.", *readings])
        QAccessible.updateAccessibility(QAccessibleAnnouncementEvent(self.player, stated))
