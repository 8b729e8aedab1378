"""Did you mean ...? The known word that is closest to a mistyped one."""

import difflib
from collections.abc import Iterable


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The words to add to an error about an unknown word, for instance " (did you mean 'slant'?)".

    Args:
        word: what was written.
        known: what could have been meant.

    Returns:
        Nothing where no known word is close.
    """
    words = list(known)
    other_case = [one for one in words if one.casefold() == word.casefold()]
    close = other_case or difflib.get_close_matches(word, words, 1)
    return f" (did you mean '{close[0]}'?)" if close else ""
