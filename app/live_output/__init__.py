"""The running walk for other programs on this computer: as streams of Lab Streaming Layer and over a WebSocket."""
