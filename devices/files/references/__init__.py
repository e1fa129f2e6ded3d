"""What an optical system states of the same walk: joint angles, events and strides, read from its files."""
