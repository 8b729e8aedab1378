"""Tiles that know which shape they form: train, export, emulate, flash and watch them."""

__version__ = "0.2.0.dev0"
