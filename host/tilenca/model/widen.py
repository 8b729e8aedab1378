"""A wider network that computes what a narrower one does, so that training goes on from there with more room.

After Net2Net (Chen, Goodfellow and Shlens, 2016): what is new changes nothing at first.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tilenca.model.file import NEIGHBOURHOOD, Dimensions, Model
from tilenca.model.initial import initial_arrays
from tilenca.model.quantise import quantise

Arrays = Mapping[str, NDArray[Any]]


def widened(model: Model, size: Dimensions, random: np.random.Generator) -> Model:
    """The same model with more channels behind the seed's, and with more hidden units.

    Its tiles show what they showed: the old units do not read the new ones, and the new channels stay zero.
    The new units read everything by random weights, and all units read the new channels, or training could
    not begin with them.

    Args:
        model: any.
        size: no narrower than the model, with as many directions.
        random: of the new weights.

    Raises:
        ValueError: a width of `size` is less than the model's, or its directions differ.
    """
    old = model.dimensions
    narrower = size.channels < old.channels or size.hidden1 < old.hidden1 or size.hidden2 < old.hidden2
    if narrower or size.directions != old.directions:
        raise ValueError(f"{size} cannot hold {old}")
    kept = np.arange(old.channels)
    kept[1:] += size.channels - old.channels
    fresh = initial_arrays(size, random)
    fresh["w2"][: old.hidden2] = 0
    return quantise(size, model.labels, placed(model.floats, kept, fresh), model.metadata)[0]


def placed(arrays: Arrays, kept: NDArray[np.int64], wider: Arrays) -> dict[str, NDArray[Any]]:
    """`wider`, with the weights of a narrower network in their places.

    Args:
        arrays: of the narrower network, by name.
        kept: (C,) the places of its channels.
        wider: arrays of a network with at least as many hidden units; they are kept as they are.
    """
    channels = wider["w3"].shape[0]
    inputs = (np.arange(NEIGHBOURHOOD)[:, None] * channels + kept).ravel()
    hidden1, hidden2 = np.arange(len(arrays["b1"])), np.arange(len(arrays["b2"]))
    places: dict[str, Any] = {
        "w1": np.ix_(hidden1, inputs),
        "b1": hidden1,
        "w2": np.ix_(hidden2, hidden1),
        "b2": hidden2,
        "w3": np.ix_(kept, hidden2),
        "b3": kept,
    }
    found = {name: array.copy() for name, array in wider.items()}
    for name, place in places.items():
        found[name][place] = arrays[name]
    return found
