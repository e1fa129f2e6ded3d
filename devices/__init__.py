"""Where samples come from: sensors, simulated patients and files of other programs, all ending as `core.samples`.

Nothing in this package knows what the numbers mean for a patient.

Public is what `__all__` names: session folders, a simulated patient whose angles are known, what another maker's sensor
has to say of itself, samples that come now, and what a package offers that brings a driver or a file format. These keep
their meaning, every other name may change.
"""

from typing import TYPE_CHECKING

from core.lazy_names import lazily
from devices.public import MODULES

if TYPE_CHECKING:
    from devices.public import *  # the names below, for type checkers and editors

# a page to read: one line or two for each task
# fmt: off
__all__ = (
    "read_session", "write_session", "FileRefusedError",
    "simulate", "WalkerSettings", "Standing", "FreeMotion", "Walk",
    "SensorProtocol", "Framer", "Received", "Channel", "Decoder", "DecodedSensor", "SourceInfo", "SensorDetails",
    "list_ports", "PortInfo", "SerialPort", "ByteSource", "CsvSerial", "Columns", "ReplaySource", "LiveSource",
    "host_time_ns", "SourceLostError", "SourceRefusedError",
    "Driver", "FileFormat", "ImportedTrial", "ImportedSensor",
)
# fmt: on

if not TYPE_CHECKING:  # a type checker would take any name for offered
    __getattr__ = lazily(__name__, MODULES)
