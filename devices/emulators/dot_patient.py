"""Emulated DOTs that an emulated patient wears, in air that is not there."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from core.body import Site
from core.samples import FloatArray
from devices.clocks.host_clock import host_time_ns
from devices.emulators.bluetooth import Air
from devices.emulators.dot import EmulatedDot
from devices.emulators.patient import EmulatedPatient

CORRECTED = 0.02  # share of the tilt that each sample's force corrects


class WornDot:
    """What one DOT measures at its site: rate and force as the patient moves, and an orientation made of them."""

    def __init__(self, patient: EmulatedPatient, site: Site, rate_hz: float) -> None:
        self._patient, self._site, self._rate_hz = patient, site, rate_hz
        self._chance = np.random.default_rng(list(Site).index(site))
        self._q = np.array([1.0, 0.0, 0.0, 0.0])
        self._last_ns: float | None = None

    def __call__(self, at_ns: float) -> Sequence[float]:
        row = self._patient.measured(self._site, at_ns, self._rate_hz, self._chance)
        passed_s = 0.0 if self._last_ns is None else min(max((at_ns - self._last_ns) / 1e9, 0.0), 0.1)
        share = 1.0 if self._last_ns is None else CORRECTED
        self._last_ns = at_ns
        self._turn(row[:3] * passed_s + share * self._tilt(row[3:]))
        rate_deg_s: list[float] = np.degrees(row[:3]).tolist()
        return [*self._q.tolist(), *row[3:].tolist(), *rate_deg_s]

    def _tilt(self, force: FloatArray) -> FloatArray:
        """The turn (3) that brings what is up by the orientation onto what is up by the force."""
        w, x, y, z = self._q
        up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
        axis = np.cross(force / np.linalg.norm(force), up)
        sine = float(np.linalg.norm(axis))
        angle = math.atan2(sine, float(force @ up) / float(np.linalg.norm(force)))
        return axis * (angle / sine) if sine > 1e-9 else axis

    def _turn(self, by: FloatArray) -> None:
        angle = float(np.linalg.norm(by))
        if angle < 1e-12:
            return
        (w, x, y, z), c, (a, b, d) = self._q, math.cos(angle / 2), by / angle * math.sin(angle / 2)
        self._q = np.array(
            [
                w * c - x * a - y * b - z * d,
                w * a + x * c + y * d - z * b,
                w * b - x * d + y * c + z * a,
                w * d + x * b - y * a + z * c,
            ]
        )


def worn_air(
    patient: EmulatedPatient, count: int, now_ns: Callable[[], int] = host_time_ns, *, states_so: bool = True
) -> tuple[Air, list[EmulatedDot]]:
    """Air with so many DOTs, worn at the sites in their order; their clocks are askew, their links unlike."""
    dots = [
        EmulatedDot(
            number, WornDot(patient, site, 60.0), now_ns, skew=(-1) ** number * 2e-5 * number, states_so=states_so
        )
        for number, site in enumerate(list(Site)[:count])
    ]
    EmulatedDot.meet(dots)
    return Air(dots, [0.004 + 0.003 * number for number in range(count)]), dots
