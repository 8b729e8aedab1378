"""What does a browser see? The server of `tilenca page`: tile events out, commands in."""
