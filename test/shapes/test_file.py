"""Shape files: what is read, and what each mistake says."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.refusal import read_or_refused
from support.strategies import damaged
from tilenca.base import paths
from tilenca.base.errors import UsageError
from tilenca.shapes.cells import connected
from tilenca.shapes.file import load_task, too_large


def write(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "shapes.toml"
    path.write_text(text, encoding="utf-8")
    return path


def shape(label: str, *rows: str) -> str:
    return f'[[shape]]\nlabel = "{label}"\ngrid = """\n' + "\n".join(rows) + '\n"""\n'


def refusals(path: Path, max_classes: int | None = None) -> list[str]:
    with pytest.raises(UsageError) as caught:
        load_task(path, max_classes)
    return str(caught.value).split("\n")


def refusal(path: Path, max_classes: int | None = None) -> str:
    (message,) = refusals(path, max_classes)
    return message


def test_the_papers_ten_digits() -> None:
    task = load_task(paths.DEFAULT_SHAPES, max_classes=20)
    assert task.labels == tuple("0123456789")
    assert [len(s.cells) for s in task.shapes] == [14, 5, 14, 14, 10, 14, 15, 9, 16, 15]
    assert task.find("4").rows == ("#..#", "#..#", "####", "...#", "...#")
    assert task.labels.index(task.find("4").label) == 4


@pytest.mark.parametrize("path", sorted(paths.SHAPES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_file_is_valid(path: Path) -> None:
    assert load_task(path).shapes


def test_neighbours_are_north_east_south_west(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, shape("0", ".#.", "###", ".#.")))
    assert task.shapes[0].neighbours() == [
        [-1, -1, 2, -1],
        [-1, 2, -1, -1],
        [0, 3, 4, 1],
        [-1, -1, -1, 2],
        [2, -1, -1, -1],
    ]


def test_blanks_are_no_tiles_and_empty_borders_are_cut(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, shape("1", "....", " ## ", ".#..", "....")))
    assert task.shapes[0].rows == ("##", "#.")


def test_blank_rows_above_and_below_are_layout(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, shape("1", "", "   ", "##", "#.", "", " ")))
    assert task.shapes[0].rows == ("##", "#.")


def test_variants_of_a_class_have_names_of_their_own(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, shape("7", "##") + shape("7", "###")))
    assert [s.name for s in task.shapes] == ["7", "7@2"]
    assert task.labels == ("7",)
    assert task.find("7@2").rows == ("###",)


def test_an_unknown_shape_lists_the_known_ones(tmp_path: Path) -> None:
    task = load_task(write(tmp_path, shape("1", "#") + shape("2", "##")))
    with pytest.raises(UsageError, match="no shape 'x'; it has: 1 2"):
        task.find("x")


@pytest.mark.parametrize(
    ("text", "line", "fact"),
    [
        (shape("1", "##", "#"), 5, "ragged rows"),
        (shape("1", "##", "#x"), 5, "unknown character 'x'"),
        (shape("1", "##") + shape("2", "#.#"), 9, "not connected: the tile in row 1, column 1 is apart"),
        (shape("1", "#.", "  ", ".#"), 4, "not connected"),
        (shape("1", "##", "", "##"), 5, "ragged rows"),
        (shape("1", "..", ".."), 4, "no tile"),
        (shape("1", "##") + "\n# note\n" + shape("2", "##"), 11, "drawn exactly like '1'"),
        (shape("@", "##"), 2, "label '@'; a 7-segment digit shows"),
        (shape("T", "##"), 2, "label 'T'; did you mean 't'? a 7-segment digit shows"),
        (
            shape("heart", "##"),
            2,
            "is the one character that the tiles are to show, such as 'h'; a 7-segment",
        ),
        (shape("4", "##").replace('"4"', "4"), 2, 'write "4", in quotes'),
        (shape("10", "##"), 2, "label '10'"),
        (shape("5", "##") + shape("S", "###"), 7, "look the same"),
        ('[[shape]]\nlabel = "1"\n', 1, "has no grid"),
        ('[[shape]]\ngrid = "#"\n', 1, "label missing"),
        ('[[shape]]\nlabel = "1"\ngrid = "#"\ncolour = "red"\n', 1, "unknown key 'colour'"),
        ('[[shape]]\nlabel = "1"\ngrid = "#\\n##"\n', 3, "ragged rows"),
        ('[[shape]\nlabel = "1"\n', 1, "not valid TOML"),
    ],
)
def test_a_mistake_names_its_line(tmp_path: Path, text: str, line: int, fact: str) -> None:
    path = write(tmp_path, text)
    message = refusal(path)
    assert message.startswith(f"{path}:{line}: "), message
    assert fact in message


def test_all_mistakes_are_named_at_once(tmp_path: Path) -> None:
    """Each with its line, in the order of the file; what is right beside a mistake is no mistake."""
    text = "size = 3\n" + shape("T", "##", "#") + shape("4", "#x", "##").replace("label", "lable")
    text += shape("1", "#") + "[forms]\nT = [0]\n"
    path = write(tmp_path, text)
    assert [line.removeprefix(f"{path}:").partition(";")[0] for line in refusals(path)] == [
        "1: unknown key 'size' (did you mean 'sizes'?)",
        "3: label 'T'",
        "6: shape 'T' has ragged rows (here 1 character, elsewhere 2)",
        "8: unknown key 'lable' (did you mean 'label'?)",
        "8: label missing",
        "11: shape 2, column 2: unknown character 'x'",
        ' [forms] "T" must be a list of texts, like ["0,0 1,0 | 1,0 1,1"]',
    ]


def test_of_many_mistakes_the_first_are_named(tmp_path: Path) -> None:
    mistakes = refusals(write(tmp_path, "".join(shape("@", "#.#") for _ in range(15))))
    assert len(mistakes) == 21
    assert mistakes[-1] == "and 10 more mistakes"


def test_too_many_classes_for_the_state(tmp_path: Path) -> None:
    path = write(tmp_path, shape("1", "#") + shape("2", "##") + shape("3", "###"))
    assert "class 3" in refusal(path, max_classes=2)
    assert len(load_task(path, max_classes=3).labels) == 3


@pytest.mark.parametrize(
    ("text", "fact"),
    [
        ("", "no shapes"),
        ("shape = 3\n", "no shapes"),
        ("title = 'x'\n" + shape("1", "#"), "unknown key 'title'"),
        ("[[shape]\n", "not valid TOML"),
    ],
)
def test_a_file_that_is_no_shape_file(tmp_path: Path, text: str, fact: str) -> None:
    assert fact in refusal(write(tmp_path, text))


def test_a_missing_or_binary_file(tmp_path: Path) -> None:
    assert "No such file" in refusal(tmp_path / "none.toml")
    (tmp_path / "signs.toml").touch()
    assert "signs.tml: No such file or directory (did you mean 'signs.toml'?)" in refusal(
        tmp_path / "signs.tml"
    )
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    assert "not UTF-8" in refusal(binary)


@settings(max_examples=300)
@given(st.text(alphabet="[]shape=\"label#. \n1grid'x", max_size=200))
def test_arbitrary_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, text: str) -> None:
    path = tmp_path_factory.mktemp("fuzz") / "shapes.toml"
    path.write_text(text, encoding="utf-8")
    with contextlib.suppress(UsageError):
        assert all(connected(s.cells) for s in load_task(path).shapes)


@given(damaged(b'[sizes]\nrows = [4, 6]\n[[shape]]\nlabel = "4"\ngrid = """\n#.#\n###\n..#\n"""\n'))
def test_any_bytes_are_read_or_refused(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    task = read_or_refused(tmp_path_factory.mktemp("fuzz") / "shapes.toml", content, load_task)
    assert task is None or task.shapes


@pytest.mark.parametrize(
    ("value", "reason"), [("9" * 5000, "a number has too many digits"), ("[" * 2000, "nested too deeply")]
)
def test_a_number_or_a_list_without_end_is_named(value: str, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "shapes.toml"
    path.write_text(f"orientations = {value}\n")
    with pytest.raises(UsageError, match=f"not valid TOML: {reason}"):
        load_task(path)


def test_a_drawing_with_more_tiles_than_ids_is_named(tmp_path: Path) -> None:
    block, bar = shape("0", *["#" * 16] * 16), shape("1", "#" * 255)
    shapes = load_task(write(tmp_path, bar + block)).shapes
    assert too_large(shapes[:1]) is None
    assert too_large(shapes) == "shape '0' has 256 tiles; the most that ids allow are 255"
