"""Shape files, drawings and their variants, glyphs; batches of cells for everything that computes."""
