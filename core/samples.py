"""Samples as they came from one sensor, in SI units and sensor axes, and what is known of that sensor."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

# any precision: NumPy's operators on float64 are typed so
FloatArray = NDArray[np.floating[Any]]
ComplexArray = NDArray[np.complexfloating[Any, Any]]
BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int64]

GRAVITY_M_S2 = 9.81  # where people walk, about
G_M_S2 = 9.80665  # the unit g, in which devices and files may state specific force


class RateKind(StrEnum):
    """What one angular-rate sample represents: the instant of its stamp, or the mean over the interval before it."""

    INSTANTANEOUS = "instantaneous"
    AVERAGED = "averaged"


@dataclass(frozen=True, slots=True)
class ImuBlock:
    """Consecutive samples of one sensor.

    Attributes
    ----------
    sensor
        Serial number or name of the sensor.
    time_s : (n,)
        Ascending stamps on the session's clock. A missing stretch is a gap.
    gyr_rad_s, acc_m_s2 : (n, 3)
        Angular rate and specific force in sensor axes; NaN where a sample is missing.
    q_earth_from_sensor : (n, 4) or None
        The device's own orientation, scalar first, earth z up; NaN where missing.
    mag : (n, 3) or None
        Magnetic field in sensor axes, any unit.
    is_rate_derived
        The rates were computed from the device's orientation, because it sent none.
    unknown : column name -> (n,)
        Columns of the file that mean nothing to us, kept as they were read.

    Raises
    ------
    ValueError
        Shapes that disagree.
    """

    sensor: str
    time_s: FloatArray
    gyr_rad_s: FloatArray
    acc_m_s2: FloatArray
    q_earth_from_sensor: FloatArray | None = None
    mag: FloatArray | None = None
    is_rate_derived: bool = False
    unknown: Mapping[str, NDArray[np.generic]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n = len(self.time_s)
        expected = {
            "time_s": (n,),
            "gyr_rad_s": (n, 3),
            "acc_m_s2": (n, 3),
            "q_earth_from_sensor": (n, 4),
            "mag": (n, 3),
        }
        for name, shape in expected.items():
            array = getattr(self, name)
            if array is not None and array.shape != shape:
                raise ValueError(f"{name} has shape {array.shape}, expected {shape}")

    def __len__(self) -> int:
        return len(self.time_s)

    def select(self, rows: slice | BoolArray | NDArray[np.intp]) -> "ImuBlock":
        """The samples of these rows, with all that is known of them."""
        return replace(
            self,
            time_s=self.time_s[rows],
            gyr_rad_s=self.gyr_rad_s[rows],
            acc_m_s2=self.acc_m_s2[rows],
            q_earth_from_sensor=None if self.q_earth_from_sensor is None else self.q_earth_from_sensor[rows],
            mag=None if self.mag is None else self.mag[rows],
            unknown={name: column[rows] for name, column in self.unknown.items()},
        )


@dataclass(frozen=True, slots=True)
class SensorInfo:
    """What is known of the sensor worn at one site. `rate_kind` None: not given, to be found from the data.

    Sensors whose `clock` is the same share one; empty: not known.
    """

    serial: str = ""
    model: str = ""
    firmware: str = ""
    rate_hz: float | None = None
    rate_kind: RateKind | None = None
    clock: str = ""
    unknown: Mapping[str, object] = field(default_factory=dict)
