"""The base of every room: errors, paths, standard streams, signals, the four sides."""
