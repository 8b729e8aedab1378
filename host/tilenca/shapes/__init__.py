"""Shape files, drawings and what they may become, glyphs; batches of cells for everything that computes."""
