"""Every claim, measured again: a list of commands of tilenca, and what their results are called."""
