"""What sees a whole drawing at once makes of it: python -m bench.whole KNOWN HELD_OUT [--seed N].

A mark for tiles, which see only their neighbours: the nearest of the known drawings, and a small
convolutional network that is trained on them. Both see drawings stretched to one size, and give one answer.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from tilenca.base.errors import TilencaError
from tilenca.commands.arguments import seed as seed_argument
from tilenca.shapes.file import Shape, load_task

HEIGHT, WIDTH = 16, 12
NEAREST = (1, 3, 5)
EPOCHS, BATCH, LEARNING_RATE = 16, 64, 1e-3

Images = NDArray[np.float32]


def stretched(shape: Shape) -> Images:
    """(HEIGHT, WIDTH) of a drawing: 1 where a tile lies."""
    cells = np.array(shape.cells)
    grid = np.zeros(cells.max(axis=0) + 1, np.float32)
    grid[tuple(cells.T)] = 1
    rows = (np.arange(HEIGHT) + 0.5) * grid.shape[0] / HEIGHT
    columns = (np.arange(WIDTH) + 0.5) * grid.shape[1] / WIDTH
    return np.asarray(grid[rows.astype(int)][:, columns.astype(int)])


def read(path: Path) -> tuple[Images, NDArray[np.str_]]:
    """The images of a shape file, (N, HEIGHT, WIDTH), and their N labels.

    Raises:
        UsageError: it is no shape file.
    """
    shapes = load_task(path).shapes
    return np.stack([stretched(shape) for shape in shapes]), np.array([shape.label for shape in shapes])


def by_neighbours(known: Images, labels: NDArray[np.str_], asked: Images, nearest: int) -> NDArray[np.str_]:
    """The commonest label among the nearest known images; among equals that of the nearest."""
    near, far = known.reshape(len(known), -1), asked.reshape(len(asked), -1)
    distances = (near**2).sum(1) - 2 * far @ near.T
    found = labels[np.argsort(distances, axis=1, kind="stable")[:, :nearest]]
    return np.array([max(row, key=list(row).count) for row in found])


def by_convolutions(known: Images, labels: NDArray[np.str_], asked: Images, seed: int) -> NDArray[np.str_]:
    """The answers of a network of two convolutions and two layers, trained on the known images."""
    torch.manual_seed(seed)
    classes, targets = np.unique(labels, return_inverse=True)
    flat = 64 * (HEIGHT // 4) * (WIDTH // 4)
    net = nn.Sequential(
        nn.Conv2d(1, 32, 3, padding=1), nn.ReLU(), nn.MaxPool2d(2),
        nn.Conv2d(32, 64, 3, padding=1), nn.ReLU(), nn.MaxPool2d(2),
        nn.Flatten(), nn.Linear(flat, 128), nn.ReLU(), nn.Dropout(0.3), nn.Linear(128, len(classes)),
    )  # fmt: skip
    images, wanted = torch.from_numpy(known)[:, None], torch.from_numpy(targets)
    optimizer = torch.optim.Adam(net.parameters(), LEARNING_RATE)
    for _ in range(EPOCHS):
        for batch in torch.split(torch.randperm(len(images)), BATCH):
            optimizer.zero_grad()
            nn.functional.cross_entropy(net(images[batch]), wanted[batch]).backward()  # type: ignore[no-untyped-call]
            optimizer.step()
    net.eval()
    with torch.no_grad():
        answers = net(torch.from_numpy(asked)[:, None]).argmax(1).numpy()
    return np.asarray(classes[answers])


def main() -> int:
    """Prints the shares of right answers."""
    parser = argparse.ArgumentParser(description="What sees a whole drawing at once makes of it.")
    parser.add_argument("known", type=Path, help="shape file with the drawings to learn")
    parser.add_argument("held_out", type=Path, help="shape file with the drawings to ask")
    parser.add_argument("--seed", type=seed_argument, default=1, help="of the network (default: %(default)s)")
    args = parser.parse_args()
    try:
        (known, labels), (asked, right) = read(args.known), read(args.held_out)
    except TilencaError as error:
        print(f"bench: {error}", file=sys.stderr)
        return 1
    print(f"{len(right)} drawings, {len(labels)} known")
    for nearest in NEAREST:
        share = np.mean(by_neighbours(known, labels, asked, nearest) == right)
        print(f"nearest neighbours, {nearest}: {share:.3f}")
    print(f"convolutions: {np.mean(by_convolutions(known, labels, asked, args.seed) == right):.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
