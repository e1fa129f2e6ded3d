"""The public names of `devices`, each from the module that defines it; `devices/__init__.py` says what they are."""

from devices.csv_serial import Columns as Columns
from devices.csv_serial import CsvSerial as CsvSerial
from devices.files.refusal import FileRefusedError as FileRefusedError
from devices.files.session_folder import read_session as read_session
from devices.files.session_folder import write_session as write_session
from devices.live import LiveSource as LiveSource
from devices.live import SensorDetails as SensorDetails
from devices.live import SourceLostError as SourceLostError
from devices.live import SourceRefusedError as SourceRefusedError
from devices.ports import PortInfo as PortInfo
from devices.ports import SerialPort as SerialPort
from devices.ports import list_ports as list_ports
from devices.replay import ReplaySource as ReplaySource
from devices.source import DecodedSensor as DecodedSensor
from devices.source import SourceInfo as SourceInfo
from devices.stream import ByteSource as ByteSource
from devices.stream import Decoder as Decoder
from devices.stream import Framer as Framer
from devices.stream import Heard as Heard
from devices.stream import SensorProtocol as SensorProtocol
from devices.walker import FreeMotion as FreeMotion
from devices.walker import Standing as Standing
from devices.walker import Walk as Walk
from devices.walker import WalkerSettings as WalkerSettings
from devices.walker import simulate as simulate
