"""What every room may use: errors, paths, the project at hand, standard streams, signals, the four sides."""
