"""What must be the same on all machines."""

from dataclasses import replace

from tilenca import __version__
from tilenca.cluster.fingerprint import fingerprint


def test_equal_software_has_no_differences() -> None:
    assert fingerprint().tilenca == __version__
    assert fingerprint().differences(replace(fingerprint())) == ""


def test_differences_name_both_sides() -> None:
    ours = fingerprint()
    theirs = replace(ours, tilenca="0.0.1", numpy="1.0")
    assert (
        ours.differences(theirs)
        == f"tilenca 0.0.1 instead of {__version__}, numpy 1.0 instead of {ours.numpy}"
    )
