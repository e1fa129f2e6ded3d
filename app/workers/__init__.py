"""What runs beside the screen. A worker knows no widget; it reports its news by signals and waits for nobody."""
