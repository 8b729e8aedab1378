"""What decides the trained weights; a checkpoint of another configuration is refused. No torch here."""

from dataclasses import asdict, dataclass
from typing import Any

from tilenca.model.file import Dimensions, Model
from tilenca.training.recipe import Recipe


@dataclass(frozen=True)
class Config:
    """Everything that decides the trained weights.

    Attributes:
        recipe: how to train.
        dimensions: the widths of the network.
        seed: of all random numbers.
        labels: the classes.
        sources: the shape files and their checksums.
        initial: the model whose real weights training begins with, of these widths and labels; None: random
            ones.
    """

    recipe: Recipe
    dimensions: Dimensions
    seed: int
    labels: tuple[str, ...]
    sources: tuple[dict[str, str], ...]
    initial: Model | None = None

    def as_json(self) -> dict[str, Any]:
        """Plain values, as JSON reads them back; without settings that do not touch the weights."""
        recipe = {key: list(v) if isinstance(v, tuple) else v for key, v in asdict(self.recipe).items()}
        del recipe["validation_runs"]
        return {
            "recipe": recipe,
            "dimensions": self.dimensions.as_json(),
            "seed": self.seed,
            "labels": list(self.labels),
            "sources": list(self.sources),
            "initial": None if self.initial is None else f"{self.initial.model_id:04X}",
        }
