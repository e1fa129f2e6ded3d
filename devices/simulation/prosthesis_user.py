"""The demonstration's user of a prosthesis, who walks by what it is stated to be and by the settings entered."""

from collections.abc import Callable, Iterable
from dataclasses import replace

from core.alignment import NetChange
from core.body import Side
from core.prosthesis import NOT_STATED, Prosthesis
from core.session import RecordingKind
from devices.clocks.host_clock import host_time_ns
from devices.simulation.demonstration_patient import DemonstrationPatient
from devices.simulation.fitted_prosthesis import SPEED_M_S, setting_of
from devices.simulation.replay import DEMONSTRATION_SESSION
from devices.simulation.walker import PEOPLE, Walk, WalkerSettings


class ProsthesisUser(DemonstrationPatient):
    """Standing and moving as the demonstration's patient; each walk is made when it is asked for, up to a second.

    Every walk differs a little from the others, as people's do. Of the changes entered, those of these parts move
    the leg, see `walker_prosthesis`: the foot's front and back screws by angle and shift, these and the pylon by
    height, the knee by its angle (where it is stopped) and by turns (resistance in swing). Nothing else does, and the
    patient's own knee, above a transtibial prosthesis, is nothing that can be set.

    Parameters
    ----------
    fitted
        Level, knee and foot; not stated: above the knee, with a stiff foot.
    now_ns
        As of `ReplaySource`.
    """

    course_speed_m_s = SPEED_M_S

    def __init__(
        self,
        side: Side,
        settings: WalkerSettings = DEMONSTRATION_SESSION,
        *,
        fitted: Prosthesis = NOT_STATED,
        speed: float = 1.0,
        now_ns: Callable[[], int] = host_time_ns,
    ) -> None:
        still = tuple(one for one in settings.recordings if not isinstance(one, Walk))
        of_user = replace(settings, prosthetic_side=side, fitted=fitted, variation=PEOPLE, recordings=still)
        super().__init__(of_user, speed=speed, now_ns=now_ns)
        self._walks: list[Walk] = []
        self._setting = setting_of({}, fitted)

    def set_up(self, changes: Iterable[NetChange]) -> None:
        """Say by what the prosthesis differs from its first alignment; the next walk is walked so."""
        of_part = {change.part: change for change in changes}
        with self._asking:
            self._setting = setting_of(of_part, self._settings.fitted)

    def ask(self, kind: RecordingKind | None) -> float | None:
        if kind is not RecordingKind.WALKING:
            return super().ask(kind)
        with self._asking:
            name = f"walk {len(self._walks) + 1}"
            new = Walk(name, SPEED_M_S, strides=14, standing_before_s=1.0, prosthesis=self._setting)
            self._walks.append(new)
            walks = tuple(self._walks)
        self._walk(walks)  # all of them: sensors ride on the tissue as they did in the first
        return None
