"""What people look at: tables, progress bars, pictures of tiles, plots and films."""
