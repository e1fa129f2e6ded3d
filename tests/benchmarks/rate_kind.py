"""Count how often the kind of the rates is mistaken when no sensor reports it. On the project's own patient.

    python -m tests.benchmarks.rate_kind --seeds 12

One line per tissue and sample rate: sessions of instants called averaged, sessions of averages called instants.
"""

from dataclasses import replace

from core.calibration.rate_kind import tracks_of_kind
from core.samples import RateKind
from core.session import Session
from devices.simulation.walker import Tissue, WalkerSettings, simulate
from tests.driver import options

RATES_HZ = (60.0, 100.0, 200.0)


def not_reported_session(settings: WalkerSettings) -> Session:
    """A session whose sensors do not say what their rates stand for."""
    session = simulate(settings).session
    sensors = {site: replace(info, rate_kind=None) for site, info in session.sensors.items()}
    return replace(session, sensors=sensors)


def is_mistaken(settings: WalkerSettings) -> bool:
    session = not_reported_session(settings)
    tracks, _ = tracks_of_kind(session, session.recordings, frozenset())
    return tracks.rate_kind is not settings.rate_kind


def main() -> None:
    seeds = range(options(__doc__, seeds=12).seeds)
    for tissue in Tissue:
        for rate_hz in RATES_HZ:
            wrong = {
                kind: sum(
                    is_mistaken(WalkerSettings(seed=seed, tissue=tissue, rate_hz=rate_hz, rate_kind=kind))
                    for seed in seeds
                )
                for kind in RateKind
            }
            cells = ", ".join(f"{kind}: {count} of {len(seeds)} mistaken" for kind, count in wrong.items())
            print(f"{tissue:6s} {rate_hz:4.0f} Hz  {cells}", flush=True)


if __name__ == "__main__":
    main()
