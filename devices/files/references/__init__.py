"""What an optical system says of the same walk: joint angles, events and strides, read from its files."""
