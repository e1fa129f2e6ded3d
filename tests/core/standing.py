"""What standing shows of sensors: their gyroscopes' biases, which everything that moves afterwards is given."""

from core.body import Site
from core.calibration.rest import rest_of
from core.live.sensors import LiveSensor
from core.samples import FloatArray, ImuBlock
from core.session import Session


def bias_of(block: ImuBlock) -> FloatArray:
    """What its gyroscope reads at rest (3,), rad/s."""
    rest = rest_of(block)
    assert rest is not None
    return rest.gyr_rad_s


def live_sensors(session: Session) -> dict[Site, LiveSensor]:
    """The sensors of a session that begins with standing, as they are known when the motion begins."""
    return {
        site: LiveSensor(session.sensors[site].rate_hz or 100.0, bias_of(block))
        for site, block in session.recordings[0].imu.items()
    }
