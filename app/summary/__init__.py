"""What a walk, condition, visit and patient show: figures, differences, progress, findings. No screen, no file."""
