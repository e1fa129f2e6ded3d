"""What an optical system gives for the same walk: joint angles, events and strides, read from its files."""
