"""Each failure has its exit status."""

import pytest

from tilenca.base import errors
from tilenca.base.paths import FIRMWARE_ELF


@pytest.mark.parametrize(
    ("kind", "status"),
    [
        (errors.TilencaError, 1),
        (errors.UsageError, 2),
        (errors.NoDeviceError, 3),
        (errors.BuildError, 4),
        (errors.InterruptedRunError, 130),
    ],
)
def test_every_kind_has_the_status_that_help_promises(kind: type[errors.TilencaError], status: int) -> None:
    assert kind("words").exit_status == status
    assert issubclass(kind, errors.TilencaError)


def test_our_own_image_is_a_build_and_a_given_one_is_usage() -> None:
    assert type(errors.image_error(f"{FIRMWARE_ELF}: truncated")) is errors.BuildError
    assert type(errors.image_error(f"{FIRMWARE_ELF.with_suffix('.hex')}: truncated")) is errors.BuildError
    assert type(errors.image_error("/home/me/firmware.elf: truncated")) is errors.UsageError
