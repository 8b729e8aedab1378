"""The set-up notices what is done and what is not, and says what to do where it cannot help itself."""

import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from setup import __main__ as setup_main
from setup import command, native, python, web
from setup.__main__ import LEVELS, NEXT, levels_up_to
from setup.command import ROOT, SetupError, Stamp, digest, run

APT = ROOT / "tools" / "setup" / "apt.sh"


def test_a_stamp_holds_for_its_own_content_only(tmp_path: Path) -> None:
    path = tmp_path / "made" / ".stamp"
    assert not Stamp(path, digest(["one"])).is_current()
    Stamp(path, digest(["one"])).set()
    assert Stamp(path, digest(["one"])).is_current()
    assert not Stamp(path, digest(["two"])).is_current()
    Stamp(path, digest(["one"])).clear()
    assert not Stamp(path, digest(["one"])).is_current()


def test_a_damaged_stamp_means_not_done(tmp_path: Path) -> None:
    path = tmp_path / ".stamp"
    path.write_bytes(b"\xff\xfe\x00")
    assert not Stamp(path, digest([])).is_current()


def test_parts_that_only_meet_elsewhere_differ() -> None:
    assert digest(["ab", "c"]) != digest(["a", "bc"])
    assert digest(["ab"]) == digest([b"ab"])


def test_a_failed_command_names_the_remedy_and_reads_no_input() -> None:
    with pytest.raises(SetupError, match=r"^do this instead \(exit status 3\)$"):
        run([sys.executable, "-c", "import sys; sys.exit(len(sys.stdin.read()) + 3)"], "do this instead")
    with pytest.raises(SetupError, match="do that instead"):
        run(["/no/such/program"], "do that instead")


def test_every_requirement_is_pinned() -> None:
    project = tomllib.loads(python.PYPROJECT.read_text(encoding="utf-8"))
    for level in python.EXTRAS:
        for requirement in python.requirements(level, project):
            name = re.split(r"[<>=]", requirement)[0]
            assert re.fullmatch(r"[\d.]+", _pin(name)), requirement


def test_what_builds_the_package_is_installed_with_it() -> None:
    project = tomllib.loads(python.PYPROJECT.read_text(encoding="utf-8"))
    assert set(project["build-system"]["requires"]) <= set(python.requirements("demo", project))


def _pin(name: str) -> str:
    pins = [
        line.split("==")
        for line in python.CONSTRAINTS.read_text(encoding="utf-8").splitlines()
        if "==" in line
    ]
    return {pinned.lower(): version for pinned, version in pins}[name.lower()]


def test_an_unpinned_package_is_an_error() -> None:
    with pytest.raises(SetupError, match=r"constraints\.txt does not pin nosuch"):
        python.pinned_version("nosuch")


def test_the_installed_version_is_the_one_python_would_import(tmp_path: Path) -> None:
    assert python.installed_version("platformio", Path(sys.prefix)) == python.pinned_version("platformio")
    assert python.installed_version("platformio", tmp_path) is None


def make_environment_at(venv: Path, head: str) -> Path:
    (venv / "bin").mkdir(parents=True)
    (venv / "bin" / "python").symlink_to(sys.executable)
    (venv / "bin" / "pip").write_text(head + "\n", encoding="utf-8")
    return venv


def test_an_environment_that_was_moved_is_not_used(tmp_path: Path) -> None:
    here = tmp_path / "here"
    assert python.belongs_here(make_environment_at(here, f"#!{here}/bin/python"))
    assert not python.belongs_here(make_environment_at(tmp_path / "moved", f"#!{here}/bin/python"))


def test_an_environment_at_a_long_path_is_known_too(tmp_path: Path) -> None:
    # What pip writes where the path does not fit into a `#!` line: a shell script that is Python as well.
    venv = tmp_path / ("deep" * 40)
    assert python.belongs_here(
        make_environment_at(venv, f"#!/bin/sh\n'''exec' {venv}/bin/python \"$0\"\n' '''")
    )


def test_an_environment_without_its_interpreter_is_not_used(tmp_path: Path) -> None:
    venv = make_environment_at(tmp_path / "venv", f"#!{tmp_path}/venv/bin/python")
    (venv / "bin" / "python").unlink()
    (venv / "bin" / "python").symlink_to(tmp_path / "gone")
    assert not python.belongs_here(venv)
    assert not python.belongs_here(tmp_path / "never")


def test_an_environment_elsewhere_is_never_emptied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    other = make_environment_at(tmp_path / "other", f"#!{tmp_path}/other/bin/python")
    link = tmp_path / ".venv"
    link.symlink_to(other)
    monkeypatch.setattr(python, "VENV", link)
    with pytest.raises(SetupError, match=rf"^{link} is a link to {other}, .* remove the link"):
        python.make_environment(["demo"])
    assert (other / "bin" / "pip").exists()
    assert link.is_symlink()


def run_apt(tmp_path: Path, package: str, **programs: str) -> subprocess.CompletedProcess[str]:
    """Runs apt.sh on a machine whose programs are the real ones but for those given as shell scripts."""
    for name, body in programs.items():
        script = tmp_path / name.replace("_", "-")
        script.write_text(f"#!/bin/sh\n{body}\n", encoding="utf-8")
        script.chmod(0o755)
    environment = os.environ | {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    command = ["sh", str(APT), package]
    # In a directory of its own, where its log goes.
    return subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=60
    )


def test_without_root_or_sudo_the_user_is_told_what_to_type(tmp_path: Path) -> None:
    done = run_apt(tmp_path, "no-such-package", id="echo 1000", sudo="exit 1")
    assert done.returncode == 1
    assert len(done.stderr.splitlines()) == 1
    assert "sudo apt-get update && sudo apt-get install -y no-such-package" in done.stderr


def test_sudo_is_never_given_the_chance_to_ask(tmp_path: Path) -> None:
    done = run_apt(
        tmp_path, "no-such-package", id="echo 1000", sudo='[ "$1" = -n ] && printf "%s\\n" "$*" >>sudo.log'
    )
    assert done.returncode == 0
    calls = (tmp_path / "sudo.log").read_text(encoding="utf-8").splitlines()
    assert [call.split()[0] for call in calls] == ["-n"] * 3
    assert calls[-1].endswith("install --no-install-recommends no-such-package")


def test_a_failed_installation_shows_what_apt_said(tmp_path: Path) -> None:
    done = run_apt(tmp_path, "no-such-package", id="echo 0", apt_get='echo "E: locate $*"; exit 100')
    assert done.returncode == 1
    assert "E: locate" in done.stderr
    assert "build/setup/apt.log" in done.stderr


def test_installed_packages_need_nobody(tmp_path: Path) -> None:
    done = run_apt(tmp_path, "dpkg", id="echo 1000", sudo="exit 1")
    assert (done.returncode, done.stderr) == (0, "")


def test_make_alone_lists_the_targets() -> None:
    done = subprocess.run(
        ["make", "--no-print-directory"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    listed = {line.split()[0] for line in done.stdout.splitlines()[1:]}
    assert {"setup", "demo", "test", "check", "train", "bench", "format", "clean", "help"} <= listed


@pytest.mark.parametrize(
    ("level", "reached"),
    [
        ("demo", ["demo"]),
        ("test", ["demo", "train", "test"]),
        ("docs", ["demo", "train", "docs"]),
        ("check", ["demo", "train", "test", "docs", "check"]),
        ("web", ["demo", "web"]),
    ],
)
def test_a_level_includes_those_below_it(level: str, reached: list[str]) -> None:
    assert levels_up_to(level) == reached


def test_every_level_has_its_extra_and_its_target() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    assert set(python.EXTRAS) == set(LEVELS)
    for level in LEVELS:
        assert f"setup-{level}" in makefile


def test_a_node_without_tail_calls_is_refused_with_the_remedy() -> None:
    web.check_node("v20.20.2")
    web.check_node("v22.0.0")
    with pytest.raises(SetupError, match=r"^node is v18\.19\.0, and 20 or later is needed.* install one"):
        web.check_node("v18.19.0")
    with pytest.raises(SetupError, match="node is silent"):
        web.check_node("")


def test_a_node_that_is_there_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda program: f"/somewhere/{program}")
    assert web.system_packages() == ["emscripten"]
    monkeypatch.setattr("shutil.which", lambda _program: None)
    assert web.system_packages() == ["emscripten", "nodejs", "npm"]


def test_no_other_level_needs_the_compiler_for_browsers() -> None:
    assert [level for level in LEVELS if "web" in levels_up_to(level)] == ["web"]


@pytest.fixture
def pip(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The calls of pip in an environment of the test's own; nothing is installed."""
    calls: list[list[str]] = []
    monkeypatch.setattr(python, "VENV", tmp_path)
    monkeypatch.setattr(
        python, "run", lambda command, _failure: calls.append([str(word) for word in command])
    )
    monkeypatch.setattr(python, "installed_version", python.pinned_version)
    return calls


def install(*levels: str) -> None:
    python._install_levels(levels, tomllib.loads(python.PYPROJECT.read_text(encoding="utf-8")))


def test_what_the_levels_lack_is_installed_by_one_call_and_its_size_is_told(
    pip: list[list[str]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    install("demo", "train", "test")
    [call] = pip
    assert {"cffi>=1.16", "torch>=2.4", "pytest>=8", "--constraint"} <= set(call)
    size = sum(python.SIZE_MB[level] for level in ("demo", "train", "test"))
    [told] = capsys.readouterr().err.splitlines()
    assert told.startswith(f"setup: installing Python packages, {size} MB on the disk: platformio, ")
    install("demo", "train", "test", "web")
    assert len(pip) == 1, "all was there"
    (tmp_path / ".tilenca-test").unlink()
    install("demo", "train", "test")
    assert "pytest>=8" in pip[1]
    assert "torch>=2.4" not in pip[1]


def test_an_installation_that_failed_is_done_again(
    pip: list[list[str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise SetupError("no network")

    install("demo")
    (tmp_path / ".tilenca-demo").write_text("of other requirements")
    with monkeypatch.context() as patch:
        patch.setattr(python, "run", fail)
        with pytest.raises(SetupError):
            install("demo")
    install("demo")
    assert len(pip) == 2


def test_another_platformio_than_the_pinned_one_is_replaced(
    pip: list[list[str]], monkeypatch: pytest.MonkeyPatch
) -> None:
    install("demo", "train")
    monkeypatch.setattr(python, "installed_version", lambda _: "0.0")
    install("demo", "train")
    assert "torch>=2.4" not in pip[1]
    assert any(word.startswith("platformio") for word in pip[1])


def test_every_level_says_how_large_it_is_and_what_to_do_next() -> None:
    assert set(python.SIZE_MB) == set(NEXT) == set(LEVELS)


@pytest.mark.parametrize(
    ("options", "last"), [(["--next"], "ready. Next: make test"), ([], "ready after 0 s")]
)
def test_the_last_line_says_that_it_is_ready(
    options: list[str], last: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(setup_main, "bring_up_to", lambda levels: command.say(f"doing {levels[-1]}"))
    monkeypatch.setattr(command, "_programs", command._Programs())
    monkeypatch.setattr(sys, "argv", ["setup", "test", *options])
    assert setup_main.main() == 0
    assert capsys.readouterr().err.splitlines() == ["setup: doing test", f"setup: {last}"]


def test_where_all_was_ready_a_target_that_only_needs_it_says_nothing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(setup_main, "bring_up_to", lambda _: None)
    monkeypatch.setattr(command, "_programs", command._Programs())
    monkeypatch.setattr(sys, "argv", ["setup", "test"])
    assert setup_main.main() == 0
    assert capsys.readouterr().err == ""


def test_apt_asks_its_mirrors_once_and_not_again_at_once(tmp_path: Path) -> None:
    programs = {
        "id": "echo 0",
        "apt_get": 'for word; do echo "$word"; done | grep -E "^(update|install)$" >>calls',
    }
    for _ in range(2):
        assert run_apt(tmp_path, "no-such-package", **programs).returncode == 0
    assert (tmp_path / "calls").read_text(encoding="utf-8").split() == ["update", "install", "install"]


@pytest.mark.parametrize(
    ("told", "packages"),
    [
        ('ID=debian\nVERSION_ID="12"\n', ["chromium", "fonts-dejavu-core"]),
        ("ID=ubuntu\nID_LIKE=debian\n", []),
        (None, []),
    ],
)
def test_a_browser_comes_from_debian_only(told: str | None, packages: list[str], tmp_path: Path) -> None:
    path = tmp_path / "os-release"
    if told is not None:
        path.write_text(told, encoding="utf-8")
    assert native.browser_packages(path) == packages


def test_the_checker_of_the_page_is_pinned_by_its_content_and_names_no_place() -> None:
    lock = json.loads((ROOT / "tools" / "page" / "package-lock.json").read_text(encoding="utf-8"))
    packages = {name: about for name, about in lock["packages"].items() if name}
    assert packages
    assert all(about["integrity"] and "resolved" not in about for about in packages.values())
