"""What may be stated about a walk: one verdict per joint, leg and kind of quantity, made once, read by every output.

`model` holds the values, `gates` makes them from what was measured, `quantities` names which figure needs which of
them, `measurement_error` by how much two figures have to differ before it is stated. Nothing else judges, and nothing
outside of this package compares.
"""
