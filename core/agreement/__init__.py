"""Agreement with a reference: clocks brought together by the rates of the angles, then how the angles differ."""
