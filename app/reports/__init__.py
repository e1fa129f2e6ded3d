"""What leaves the application on paper or as a file: made from an Analysis alone, without a screen."""
