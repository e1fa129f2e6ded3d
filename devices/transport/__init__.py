"""Ways by which bytes arrive: serial ports, Bluetooth, the network. Nothing here knows a sensor."""
