"""The public names of `devices`, each from the module that defines it; `devices/__init__.py` explains them.

The imports are for type checkers and editors; at run time `core.lazy_names` takes `MODULES`.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from devices.catalogue import Driver as Driver
    from devices.clocks.host_clock import host_time_ns as host_time_ns
    from devices.drivers.csv_serial import Columns as Columns
    from devices.drivers.csv_serial import CsvSerial as CsvSerial
    from devices.files.file_format import FileFormat as FileFormat
    from devices.files.refusal import FileRefusedError as FileRefusedError
    from devices.files.session_folder import read_session as read_session
    from devices.files.session_folder import write_session as write_session
    from devices.files.trial import ImportedSensor as ImportedSensor
    from devices.files.trial import ImportedTrial as ImportedTrial
    from devices.live import LiveSource as LiveSource
    from devices.live import SensorDetails as SensorDetails
    from devices.live import SourceLostError as SourceLostError
    from devices.live import SourceRefusedError as SourceRefusedError
    from devices.simulation.replay import ReplaySource as ReplaySource
    from devices.simulation.walker import FreeMotion as FreeMotion
    from devices.simulation.walker import Standing as Standing
    from devices.simulation.walker import Walk as Walk
    from devices.simulation.walker import WalkerSettings as WalkerSettings
    from devices.simulation.walker import simulate as simulate
    from devices.source import DecodedSensor as DecodedSensor
    from devices.source import SourceInfo as SourceInfo
    from devices.stream import ByteSource as ByteSource
    from devices.stream import Decoder as Decoder
    from devices.stream import Framer as Framer
    from devices.stream import Received as Received
    from devices.stream import SensorProtocol as SensorProtocol
    from devices.transport.channels import Channel as Channel
    from devices.transport.ports import PortInfo as PortInfo
    from devices.transport.ports import SerialPort as SerialPort
    from devices.transport.ports import list_ports as list_ports

MODULES = {
    "Driver": "devices.catalogue",
    "host_time_ns": "devices.clocks.host_clock",
    "Columns": "devices.drivers.csv_serial",
    "CsvSerial": "devices.drivers.csv_serial",
    "FileFormat": "devices.files.file_format",
    "FileRefusedError": "devices.files.refusal",
    "read_session": "devices.files.session_folder",
    "write_session": "devices.files.session_folder",
    "ImportedSensor": "devices.files.trial",
    "ImportedTrial": "devices.files.trial",
    "LiveSource": "devices.live",
    "SensorDetails": "devices.live",
    "SourceLostError": "devices.live",
    "SourceRefusedError": "devices.live",
    "ReplaySource": "devices.simulation.replay",
    "FreeMotion": "devices.simulation.walker",
    "simulate": "devices.simulation.walker",
    "Standing": "devices.simulation.walker",
    "Walk": "devices.simulation.walker",
    "WalkerSettings": "devices.simulation.walker",
    "DecodedSensor": "devices.source",
    "SourceInfo": "devices.source",
    "ByteSource": "devices.stream",
    "Decoder": "devices.stream",
    "Framer": "devices.stream",
    "Received": "devices.stream",
    "SensorProtocol": "devices.stream",
    "Channel": "devices.transport.channels",
    "list_ports": "devices.transport.ports",
    "PortInfo": "devices.transport.ports",
    "SerialPort": "devices.transport.ports",
}
