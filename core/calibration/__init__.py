"""The robust identification of how two sensors sit on a joint, one step per module."""
