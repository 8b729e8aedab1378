"""PlatformIO works without its registry, and the question whether the registry answers is never long."""

import configparser
import contextlib
import http.server
import os
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import platformio.http
import platformio.registry.client
import pytest
from platformio.dependencies import get_core_dependencies
from platformio.package.meta import PackageSpec
from semantic_version import Version

from offline import boards, probe, seed

ROOT = Path(__file__).resolve().parents[2]
PIO = Path(sys.executable).with_name("pio")

BOARDS_TXT = """
# a comment = not a value
menu.cpu=Processor
mega.name=Mega
mega.vid.1=0x2341
mega.pid.1=0x0042
mega.vid.0=0x2341
mega.pid.0=0x0010
mega.upload.maximum_data_size=8192
mega.build.f_cpu=16000000L
mega.build.core=arduino
mega.build.variant=mega
mega.build.board=AVR_OLD
mega.menu.cpu.atmega2560.upload.protocol=wiring
mega.menu.cpu.atmega2560.upload.maximum_size=253952
mega.menu.cpu.atmega2560.upload.speed=115200
mega.menu.cpu.atmega2560.build.mcu=atmega2560
mega.menu.cpu.atmega2560.build.board=AVR_MEGA2560
megaother.name=Not this one
"""


def test_the_board_is_what_boards_txt_says() -> None:
    board = boards.board_manifest(boards.parse_boards(BOARDS_TXT), "mega", "atmega2560")
    assert board["name"] == "Mega"
    assert board["build"]["hwids"] == [["0x2341", "0x0010"], ["0x2341", "0x0042"]]
    assert board["build"]["extra_flags"] == "-DARDUINO_AVR_MEGA2560", (
        "the processor's choice overrides the board's"
    )
    assert board["upload"]["maximum_size"] == 253952


def test_an_unknown_processor_is_an_error() -> None:
    with pytest.raises(KeyError):
        boards.board_manifest(boards.parse_boards(BOARDS_TXT), "mega", "atmega1280")


@pytest.mark.parametrize(
    ("debian", "upstream"),
    [
        ("1:5.4.0+Atmel3.6.2-3", "5.4.0"),
        ("7.1+dfsg-3", "7.1.0"),
        ("2.26.20160125+Atmel3.6.2-4", "2.26.20160125"),
    ],
)
def test_debian_versions_lose_what_is_debians(debian: str, upstream: str) -> None:
    assert seed.upstream_version(debian) == upstream


def test_tool_scons_means_a_release_of_scons() -> None:
    assert seed.scons_release("~4.41101.0") == "4.11.1"
    assert seed.scons_release("~4.40801.0") == "4.8.1"
    with pytest.raises(ValueError, match="tool-scons"):
        seed.scons_release("^5")


def test_the_pinned_platformio_wants_a_scons_that_is_known() -> None:
    assert seed.scons_release(get_core_dependencies()["tool-scons"])


def test_the_stand_ins_satisfy_platformio_ini() -> None:
    config = configparser.ConfigParser()
    config.read(ROOT / "platformio.ini", encoding="utf-8")
    wanted = [PackageSpec(config[section]["platform"]) for section in config if "platform" in config[section]]
    made = {"atmelavr": seed.ATMELAVR_VERSION, "native": seed.NATIVE_VERSION}
    assert {spec.name for spec in wanted} == set(made)
    for spec in wanted:
        assert not spec.requirements or Version(made[spec.name]).truncate() in spec.requirements


def test_a_local_ini_of_the_users_own_is_kept(tmp_path: Path) -> None:
    ini = tmp_path / "platformio.local.ini"
    seed.write_local_ini(ini)
    assert seed.is_ours(ini)
    seed.write_local_ini(ini)
    ini.write_text("[env]\nupload_port = /dev/ttyACM7\n", encoding="utf-8")
    assert not seed.is_ours(ini)
    with pytest.raises(FileExistsError, match="core_dir = build/platformio"):
        seed.write_local_ini(ini)
    assert "ttyACM7" in ini.read_text(encoding="utf-8")


@contextlib.contextmanager
def listening(backlog: int) -> Iterator[int]:
    """A port of this machine on which connections are made and nothing is ever said."""
    with socket.create_server(("127.0.0.1", 0), backlog=backlog) as server:
        yield server.getsockname()[1]


def offline_environment(port: int) -> dict[str, str]:
    """All traffic goes to one port of this machine."""
    proxies = ("http_proxy", "https_proxy", "HTTP_PROXY", "HTTPS_PROXY", "all_proxy", "ALL_PROXY")
    kept = {name: value for name, value in os.environ.items() if name.lower() != "no_proxy"}
    return kept | dict.fromkeys(proxies, f"http://127.0.0.1:{port}")


def test_a_registry_that_takes_the_call_and_says_nothing_does_not_answer() -> None:
    with listening(backlog=16) as port:
        command = [sys.executable, str(ROOT / "tools" / "offline" / "probe.py"), "0.5"]
        # The timeout is for a probe that hangs, as PlatformIO itself does for a minute.
        done = subprocess.run(
            command, env=offline_environment(port), capture_output=True, check=False, timeout=30
        )
    assert done.returncode == 1


class Registry(http.server.BaseHTTPRequestHandler):
    """Knows one package."""

    def do_GET(self) -> None:
        known = self.path.startswith("/v3/packages/platformio/platform/atmelavr")
        body = b'{"name": "atmelavr"}' if known else b'{"message": "not found"}'
        self.send_response(200 if known else 404)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        pass


def test_a_registry_that_has_the_platform_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLATFORMIO_CORE_DIR", str(tmp_path))
    monkeypatch.setenv("no_proxy", "*")
    monkeypatch.setattr(platformio.http, "ensure_internet_on", lambda **_: True)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Registry) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        # PlatformIO's client knows https addresses only: it is told another one, the rest is its own.
        address = f"http://127.0.0.1:{server.server_port}"
        monkeypatch.setattr(
            platformio.registry.client.RegistryClient,
            "__init__",
            lambda self: platformio.http.HTTPClient.__init__(self, [address]),
        )
        assert probe.registry_answers(limit_s=20)
        server.shutdown()
        thread.join()


PLATFORMIO_INI = """
[platformio]
default_envs = megaatmega2560
extra_configs = platformio.local.ini
[env:megaatmega2560]
platform = atmelavr@^5.1.0
board = megaatmega2560
framework = arduino
[env:native]
platform = native
build_src_filter = -<*> +<native.c>
"""
MAIN_CPP = """
#include <Arduino.h>
#include <EEPROM.h>
void setup() { Serial.begin(115200); Serial.println(EEPROM.read(0)); }
void loop() {}
"""


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small project with official names, and a core directory seeded for real."""
    path = tmp_path_factory.mktemp("project")
    (path / "src").mkdir()
    (path / "platformio.ini").write_text(PLATFORMIO_INI, encoding="utf-8")
    (path / "src" / "main.cpp").write_text("#ifdef ARDUINO\n" + MAIN_CPP + "#endif\n", encoding="utf-8")
    (path / "src" / "native.c").write_text(
        "#ifndef ARDUINO\nint main(void) { return 0; }\n#endif\n", encoding="utf-8"
    )
    seed.Seeder(path / seed.CORE_DIR).seed()
    seed.write_local_ini(path / "platformio.local.ini")
    return path


def pio(project: Path, *arguments: str) -> str:
    """What a PlatformIO command prints on a machine without network and with a new user."""
    with listening(backlog=16) as port:
        environment = offline_environment(port) | {"HOME": str(project / "nobody")}
        environment.pop("PLATFORMIO_CORE_DIR", None)
        done = subprocess.run(
            [str(PIO), *arguments],
            cwd=project,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_the_firmware_builds_and_says_what_built_it(project: Path) -> None:
    output = pio(project, "run")
    assert "toolchain-atmelavr @ 1." in output
    assert "+debian" in output
    assert (project / ".pio" / "build" / "megaatmega2560" / "firmware.hex").exists()
    assert "Device: atmega2560" in pio(project, "run", "-t", "size")


def test_a_native_program_builds(project: Path) -> None:
    pio(project, "run", "-e", "native")
    subprocess.run([project / ".pio" / "build" / "native" / "program"], check=True)


def test_the_sources_can_be_checked(project: Path) -> None:
    assert "PASSED" in pio(project, "check", "--skip-packages", "-e", "megaatmega2560")


def test_nothing_is_left_to_install(project: Path) -> None:
    assert "Already up-to-date" in pio(project, "pkg", "install")


def test_seeding_again_starts_from_nothing(project: Path) -> None:
    stale = project / seed.CORE_DIR / "packages" / "stale"
    stale.mkdir()
    seed.Seeder(project / seed.CORE_DIR).seed()
    assert not stale.exists()
    assert "5.1.0+offline" in pio(project, "pkg", "list")
