"""Frames and COBS, on the cases that the C++ twin is tested with, and under fuzzing."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.vectors import cases
from tilenca.protocol.frames import (
    Frame,
    FrameDecoder,
    cobs_decode,
    cobs_encode,
    decode_payload,
    encode_frame,
    encode_payload,
)

messages = st.integers(-127, 127)
frames = st.builds(
    Frame,
    st.integers(0, 3),
    st.integers(0, 255),
    st.integers(0, 255),
    st.integers(0, 0xFFFF),
    st.lists(messages, min_size=1, max_size=51).map(tuple),
)


def events(decoder: FrameDecoder, line: bytes) -> list[str]:
    """What a decoder says of a line, in the words of the shared file."""
    found = []
    for byte in line:
        result = decoder.feed(byte)
        if result is FrameDecoder.Result.CORRUPT:
            found.append("corrupt")
        elif result is FrameDecoder.Result.READY:
            frame = decoder.frame
            assert frame is not None
            found.append(
                f"ready {'NESW'[frame.side]} {frame.tile} {frame.sequence} {frame.model_id:04X} "
                + " ".join(map(str, frame.messages))
            )
    return found


@pytest.mark.parametrize(("name", "channels", "line", "expected"), cases("frames.inc"))
def test_frame_case(name: str, channels: str, line: str, expected: str) -> None:
    assert ";".join(events(FrameDecoder(int(channels)), bytes.fromhex(line))) == expected


@given(st.binary(max_size=57))
def test_cobs_has_no_zero_and_comes_back(payload: bytes) -> None:
    encoded = cobs_encode(payload)
    assert 0 not in encoded
    assert len(encoded) == len(payload) + 1
    assert cobs_decode(encoded) == payload


def test_cobs_refuses_what_no_frame_holds() -> None:
    with pytest.raises(ValueError, match="at most 58"):
        cobs_encode(bytes(59))


@given(st.binary(max_size=70))
def test_cobs_decodes_only_what_it_would_encode(encoded: bytes) -> None:
    payload = cobs_decode(encoded)
    if payload is not None:
        assert cobs_encode(payload) == encoded


@given(frames)
def test_a_frame_comes_back(frame: Frame) -> None:
    assert decode_payload(encode_payload(frame), len(frame.messages)) == frame


@given(frames, frames, st.binary(max_size=300))
def test_a_good_frame_is_found_behind_any_bytes(before: Frame, frame: Frame, noise: bytes) -> None:
    decoder = FrameDecoder(len(frame.messages))
    for byte in encode_frame(before) + noise + b"\0":
        decoder.feed(byte)
    *early, last = (decoder.feed(byte) for byte in encode_frame(frame))
    assert set(early) == {FrameDecoder.Result.PENDING}
    assert last is FrameDecoder.Result.READY
    assert decoder.frame == frame
