"""Makes a clone ready to use, once, and notices when it has to be done again. Standard library only."""
