"""Descriptions of models that tilenca 0.1 wrote (format 1): the same content under other names."""

from typing import Any

# The settings of a recipe that have other names since format 2.
RECIPE = {
    "rounds": "ticks",
    "bounded": "quantisation_aware",
    "average": "ema_decay",
    "pool": "perturbed_pool",
    "late": "staggered_start",
    "scramble": "state_shuffle",
    "quiet_pool": "undisturbed_pool",
    "quiet_batch": "undisturbed_batch",
    "quiet_rounds": "undisturbed_ticks",
    "ahead_every": "refresh_every",
    "ahead": "refresh_steps",
    "quiet_penalty": "stability_penalty",
    "rounds_per_period": "ticks_per_period",
    "unheard": "stale",
    "max_unheard": "max_stale",
    "hard": "failure_weighting",
}


def metadata_of(about: dict[str, Any]) -> Any:
    """The metadata of a description of format 1, with today's names; unchecked, as the file has it."""
    metadata = about.get("made", {})
    if isinstance(metadata, dict) and isinstance(recipe := metadata.get("recipe"), dict):
        return metadata | {"recipe": {RECIPE.get(key, key): value for key, value in recipe.items()}}
    return metadata
