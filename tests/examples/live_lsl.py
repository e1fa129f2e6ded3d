"""Print what Gaitwright streams of the running walk through Lab Streaming Layer: joint angles and the feet's events.

    python -m tests.examples.live_lsl SECONDS

It needs `pylsl`. In Gaitwright switch on Settings, Live output, Lab Streaming Layer, and open the walking page. Each
joint is a stream with three channels: its angle and the angle's standard deviation in degrees, and a status: 0 good,
1 caution, 2 not reported, where the angle is NaN.
"""

import sys
from time import monotonic

import pylsl


def main(seconds: float) -> None:
    found = pylsl.resolve_streams(2.0)
    inlets = {one.name(): pylsl.StreamInlet(one) for one in found if one.name().startswith("Gaitwright ")}
    end_s = monotonic() + seconds
    while monotonic() < end_s:
        for name, inlet in inlets.items():
            samples, stamps = inlet.pull_chunk(timeout=0.02)
            for sample, stamp in zip(samples, stamps, strict=True):
                print(f"{stamp:.3f} {name}:", *sample)


if __name__ == "__main__":
    main(float(sys.argv[1]))
