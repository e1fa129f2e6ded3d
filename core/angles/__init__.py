"""From orientations and a calibration to joint angles."""
