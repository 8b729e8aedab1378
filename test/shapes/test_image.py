"""Pictures become drawings."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base.errors import UsageError
from tilenca.shapes.image import cropped, drawing_of, largest_part, pooled, read_image

SEVEN = np.array([[1, 1, 1], [0, 0, 1], [0, 0, 1]], np.float64)


def picture(folder: Path, ink: np.ndarray, name: str = "drawing.png") -> Path:
    Image.fromarray((255 * (1 - ink)).astype(np.uint8)).save(folder / name)
    return folder / name


def test_a_drawing_survives_being_a_picture(tmp_path: Path) -> None:
    large = np.kron(np.pad(SEVEN, 1), np.ones((20, 20))).astype(np.float64)
    assert drawing_of(read_image(picture(tmp_path, large)), (5, 5)) == ("###", "..#", "..#")
    assert drawing_of(cropped(large), (3, 3)) == ("###", "..#", "..#")


def test_light_ink_on_dark_paper_is_ink_too(tmp_path: Path) -> None:
    large = np.kron(np.pad(SEVEN, 1), np.ones((20, 20))).astype(np.float64)
    assert drawing_of(read_image(picture(tmp_path, 1 - large)), (5, 5)) == ("###", "..#", "..#")


def test_what_is_transparent_is_paper(tmp_path: Path) -> None:
    pixels = np.zeros((30, 30, 4), np.uint8)
    pixels[10:20, 5:25, 3] = 255  # black, where it is not transparent
    Image.fromarray(pixels, "RGBA").save(tmp_path / "clear.png")
    assert drawing_of(read_image(tmp_path / "clear.png"), (3, 6)) == ("####",)


@pytest.mark.parametrize("size", [(3, 3), (4, 7), (9, 2), (1, 1), (20, 20)])
def test_pooling_keeps_the_mean(size: tuple[int, int]) -> None:
    ink = np.random.default_rng(1).random((9, 7))
    means = pooled(ink, size)
    assert means.shape == size
    assert means.mean() == pytest.approx(ink.mean())


def test_only_the_largest_part_stays() -> None:
    grid = np.array([[1, 0, 1, 1], [0, 0, 0, 1], [1, 1, 0, 0]], np.bool_)
    assert np.argwhere(largest_part(grid)).tolist() == [[0, 2], [0, 3], [1, 3]]
    assert drawing_of(np.zeros((4, 4)), (2, 2)) == ()


@pytest.mark.parametrize("what", ["text", "missing", "blank", "cut"])
def test_what_is_no_picture_is_refused_with_a_remedy(tmp_path: Path, what: str) -> None:
    file = tmp_path / "mine.png"
    if what == "text":
        file.write_text("no picture")
    elif what == "blank":
        picture(tmp_path, np.zeros((5, 5)), "mine.png")
    elif what == "cut":
        whole = picture(tmp_path, np.random.default_rng(1).random((50, 50))).read_bytes()
        file.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(UsageError, match=r"mine.png: .*; "):
        read_image(file)


def as_file(kind: str) -> bytes:
    """A small chequered picture as a file."""
    file = io.BytesIO()
    Image.fromarray(np.indices((8, 8)).sum(0).astype(np.uint8) % 2 * 255).save(file, kind)
    return file.getvalue()


@given(st.sampled_from(["PNG", "GIF", "BMP", "JPEG"]).map(as_file).flatmap(damaged))
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::PIL.Image.DecompressionBombWarning")
def test_any_bytes_are_a_picture_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    ink = read_or_refused(tmp_path_factory.mktemp("fuzz") / "picture.png", content, read_image)
    assert ink is None or (ink.min(), ink.max()) == (0, 1)


def test_a_png_with_a_broken_chunk_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "picture.png"
    whole = as_file("PNG")
    path.write_bytes(whole.replace(b"IDAT", b"[[[["))
    with pytest.raises(UsageError, match="not a picture that can be read"):
        read_image(path)
