"""Analyse a session folder and print, for every walk and joint, how far it bends and how sure that is.

    python -m tests.examples.analyse_a_folder SESSION

SESSION holds a session.toml and one folder per recording. One line per joint is printed: its range over the walk and
the standard deviation of its angle, both in degrees; then one line per finding.
"""

import sys
from pathlib import Path

import numpy as np

from core import JointAngle, RecordingKind, analyse
from devices import read_session


def range_deg(joint: JointAngle) -> float:
    """From the 2nd to the 98th percentile, so that one odd sample is no range; angles are NaN in gaps."""
    low, high = np.nanpercentile(np.rad2deg(joint.angle_rad), [2, 98])
    return float(high - low)


def main(folder: Path) -> None:
    analysis = analyse(read_session(folder))
    for recording in analysis.recordings:
        if recording.kind is RecordingKind.WALKING:
            for name, joint in recording.joints.items():
                sd_deg = np.rad2deg(np.nanmedian(joint.sd_rad))
                print(f"{recording.name}, {name}: range {range_deg(joint):.1f} deg, sd {sd_deg:.1f} deg")
    for finding in analysis.findings:
        print(f"{finding.severity}: {finding.key} ({finding.where})")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
