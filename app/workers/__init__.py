"""What runs beside the screen. A worker knows no widget; it tells its news by signals and waits for nobody."""
