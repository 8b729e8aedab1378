"""Everything that a person sees: tables, progress bars, pictures of tiles, plots and films."""
