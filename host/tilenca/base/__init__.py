"""The base of every room: errors, paths, the current project, standard streams, signals, the four sides."""
