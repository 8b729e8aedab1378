"""What every room may use: errors, paths, standard streams, signals, the four sides."""
