"""Frames of a joint's two sensors against each other: the algebra of `core.angles.twist`, quick for blocks.

A joint frame is (x, y, j) of eq 13, z along the axis. The unit quaternion w + x i + y j + z k that turns it into the
earth is kept as two complex numbers, u = w + i z and v = x + i y (Cayley and Klein's parameters). A turn of the earth
about the vertical by d multiplies both by exp(i d/2): the relative heading enters as simply as it can.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from core.live.pairing import PairedSamples
from core.results import JointCalibration
from core.samples import ComplexArray, FloatArray
from core.signal.pair import angular_acceleration, lever_matrix
from core.signal.rotations import in_plane, joint_frame, wrap


def frame_map(axis: FloatArray) -> ComplexArray:
    """Give the complex matrix (4, 2) from orientations (n, 4), as rows, to u and v of the joint frame."""
    return orientation_map(np.stack([*joint_frame(axis), axis], axis=1))


def orientation_map(frame: FloatArray) -> ComplexArray:
    """Give the complex matrix (4, 2) from orientations (n, 4) to u and v of a frame (3, 3) of columns."""
    w, x, y, z = Rotation.from_matrix(frame).as_quat(scalar_first=True)
    product = np.array([[w, x, y, z], [-x, w, -z, y], [-y, z, w, -x], [-z, -y, x, w]])  # of 1, i, j, k with it
    return np.stack([product[:, 0] + 1j * product[:, 3], product[:, 1] + 1j * product[:, 2]], axis=1)


@dataclass(frozen=True, slots=True)
class JointFrames:
    """Orientations (n,) of the proximal (1) and the distal (2) joint frame, each in its own earth."""

    u1: ComplexArray
    v1: ComplexArray
    u2: ComplexArray
    v2: ComplexArray

    @property
    def heading_seen(self) -> ComplexArray:
        """Give (n,) along the heading of parallel axes, of length the product of their horizontal parts."""
        return np.asarray(4 * self.u1 * self.v1 * np.conj(self.u2 * self.v2))

    def part(self, which: slice) -> "JointFrames":
        return JointFrames(self.u1[which], self.v1[which], self.u2[which], self.v2[which])

    @property
    def steepness(self) -> FloatArray:
        """Sine (n,) of the proximal axis' angle to the horizontal."""
        return 1 - 2 * np.abs(self.v1) ** 2

    def twist(self, heading_rad: FloatArray) -> FloatArray:
        """Rotation (n,) of the distal segment against the proximal one about the axis, -2 pi to 2 pi."""
        half = np.exp(0.5j * heading_rad)
        about = np.conj(self.u1) * (half * self.u2) + self.v1 * np.conj(half * self.v2)
        return 2 * np.angle(about)

    def off_axis_rate(self, rate_1: FloatArray, rate_2: FloatArray, heading_rad: FloatArray) -> ComplexArray:
        """Give the relative rate across the axis (n,), rad/s, complex in the proximal joint frame."""
        half = np.exp(0.5j * heading_rad)
        u2, v2 = half * self.u2, half * self.v2
        u, v = np.conj(self.u1) * u2 + self.v1 * np.conj(v2), np.conj(self.u1) * v2 - self.v1 * np.conj(u2)
        across_1, across_2 = rate_1[:, 0] + 1j * rate_1[:, 1], rate_2[:, 0] + 1j * rate_2[:, 1]
        turned = u**2 * across_2 + v**2 * np.conj(across_2) - 2j * u * v * rate_2[:, 2]
        return np.asarray(turned - across_1)


class JointGeometry:
    """A joint's calibration, made ready for samples."""

    def __init__(self, calibration: JointCalibration) -> None:
        self.calibration = calibration
        self.j1, self.j2 = calibration.axis_proximal, calibration.axis_distal
        self._frame_1, self._frame_2 = (np.stack([*joint_frame(j), j], axis=1) for j in (self.j1, self.j2))
        self._map_1, self._map_2 = frame_map(self.j1), frame_map(self.j2)
        self.has_centre = calibration.centre_proximal_m is not None and calibration.centre_distal_m is not None
        self._lever_1 = _known(calibration.centre_proximal_m), _known(calibration.acc_bias_proximal_m_s2)
        self._lever_2 = _known(calibration.centre_distal_m), _known(calibration.acc_bias_distal_m_s2)
        self.is_hinge = calibration.is_hinge and self.has_centre

    def frames(self, rows: PairedSamples) -> JointFrames:
        one, two = rows.proximal[:, 0:4] @ self._map_1, rows.distal[:, 0:4] @ self._map_2
        return JointFrames(one[:, 0], one[:, 1], two[:, 0], two[:, 1])

    def rates(self, rows: PairedSamples) -> tuple[FloatArray, FloatArray]:
        """Of both sensors (n, 3), each in its joint frame."""
        return rows.proximal[:, 4:7] @ self._frame_1, rows.distal[:, 4:7] @ self._frame_2

    def bending_rate(self, rows: PairedSamples) -> FloatArray:
        """Rate (n,) of the twist on a hinge: of the distal sensor about the axis, less the proximal one's (eq 11)."""
        return rows.distal[:, 4:7] @ self.j2 - rows.proximal[:, 4:7] @ self.j1

    def forces(self, rows: PairedSamples, step_s: float) -> tuple[ComplexArray, ComplexArray]:
        """Specific force of the joint in both joint planes (n - 4,) by eq 12; not known for two samples at each end."""
        return (
            _force(rows.proximal, step_s, self.j1, *self._lever_1),
            _force(rows.distal, step_s, self.j2, *self._lever_2),
        )

    def clinical(self, twist_rad: FloatArray) -> FloatArray:
        """The angle (n,) in the clinical sign, within half a turn of zero."""
        c = self.calibration
        return wrap(c.clinical_sign * (twist_rad - c.zero_rad) + c.offset_rad)


def _known(vector: FloatArray | None) -> FloatArray:
    return np.zeros(3) if vector is None else vector


def _force(
    signals: FloatArray, step_s: float, axis: FloatArray, centre_m: FloatArray, bias_m_s2: FloatArray
) -> ComplexArray:
    rate, acc = signals[:, 4:7], signals[2:-2, 7:10]
    lever = lever_matrix(rate[2:-2], angular_acceleration(rate, step_s)[2:-2])
    return in_plane(acc - bias_m_s2 - lever @ centre_m, axis)
