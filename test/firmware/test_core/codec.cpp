#include <doctest/doctest.h>

#include <cstdio>

#include "../support.h"
#include "core/crc16.h"
#include "core/crc32.h"
#include "core/frame.h"

using namespace tilenca;
using test::Numbers;

namespace {

struct FrameCase {
    const char* name;
    uint8_t channels;
    const char* line;
    const char* events;
};

const FrameCase kCases[] = {
#define CASE(name, channels, line, events) {name, channels, line, events},
#include "frames.inc"
#undef CASE
};

std::string event_of(const FrameDecoder& decoder, uint8_t channels) {
    char head[32];
    const FrameHeader header = decoder.header();
    std::snprintf(head, sizeof head, "ready %c %u %u %04X", kSideLetters[index_of(header.side)], header.tile,
                  header.sequence, header.model_id);
    std::string event = head;
    for (uint8_t c = 0; c < channels; ++c) {
        event += " " + std::to_string(decoder.messages()[c]);
    }
    return event;
}

std::string events_of(FrameDecoder& decoder, uint8_t channels, const std::vector<uint8_t>& line) {
    std::vector<std::string> events;
    for (uint8_t byte : line) {
        switch (decoder.feed(byte)) {
        case FrameDecoder::Result::Pending:
            break;
        case FrameDecoder::Result::Ready:
            events.push_back(event_of(decoder, channels));
            break;
        case FrameDecoder::Result::Corrupt:
            events.push_back("corrupt");
            break;
        }
    }
    return test::joined(events, ";");
}

} // namespace

TEST_CASE("the CRC of 123456789 is the published one") {
    CHECK(crc16(reinterpret_cast<const uint8_t*>("123456789"), 9) == 0x29B1);
    CHECK(crc16(nullptr, 0) == 0xFFFF);
}

TEST_CASE("the CRC-32 of 123456789 is the published one, however it is cut") {
    for (uint8_t cut = 0; cut <= 9; ++cut) {
        const uint8_t* digits = reinterpret_cast<const uint8_t*>("123456789");
        Crc32 crc;
        crc.add(digits, cut);
        crc.add(digits + cut, 9 - cut);
        CHECK(crc.value() == 0xCBF43926);
    }
    CHECK(Crc32().value() == 0);
}

TEST_CASE("every case of the shared table") {
    for (const FrameCase& frame_case : kCases) {
        CAPTURE(frame_case.name);
        FrameDecoder decoder(frame_case.channels);
        CHECK(events_of(decoder, frame_case.channels, test::bytes_of_hex(frame_case.line)) ==
              frame_case.events);
    }
}

TEST_CASE("encoding gives the line of every case that is one good frame") {
    int encoded = 0;
    for (const FrameCase& frame_case : kCases) {
        const std::vector<uint8_t> line = test::bytes_of_hex(frame_case.line);
        FrameDecoder decoder(frame_case.channels);
        const std::string events = events_of(decoder, frame_case.channels, line);
        if (events.empty() || events.find(';') != std::string::npos || line[0] == 0) {
            continue;
        }
        CAPTURE(frame_case.name);
        uint8_t wire[kMaxFrame];
        const uint8_t size = encode_frame(decoder.header(), decoder.messages(), frame_case.channels, wire);
        CHECK(std::vector<uint8_t>(wire, wire + size) == line);
        ++encoded;
    }
    CHECK(encoded >= 5);
}

TEST_CASE("any frame comes back, whatever bytes came before its predecessor's delimiter") {
    Numbers numbers(1);
    for (int i = 0; i < 3000; ++i) {
        const uint8_t channels = static_cast<uint8_t>(numbers.draw(1, kMaxChannels));
        const auto messages = numbers.draw_all<int8_t>(channels, -127, 127);
        const FrameHeader header = {
            side_at(static_cast<uint8_t>(numbers.draw(0, 3))), static_cast<uint8_t>(numbers.draw(0, 255)),
            static_cast<uint8_t>(numbers.draw(0, 255)), static_cast<uint16_t>(numbers.draw(0, 65535))};
        FrameDecoder decoder(channels);
        for (uint8_t byte : numbers.draw_all<uint8_t>(numbers.draw(0, 150), 0, 255)) {
            decoder.feed(byte);
        }
        decoder.feed(0);
        uint8_t wire[kMaxFrame];
        const uint8_t size = encode_frame(header, messages.data(), channels, wire);
        REQUIRE(size == channels + 9);
        for (uint8_t at = 0; at + 1 < size; ++at) {
            REQUIRE(wire[at] != 0);
            REQUIRE(decoder.feed(wire[at]) == FrameDecoder::Result::Pending);
        }
        REQUIRE(decoder.feed(wire[size - 1]) == FrameDecoder::Result::Ready);
        REQUIRE(decoder.header().side == header.side);
        REQUIRE(decoder.header().tile == header.tile);
        REQUIRE(decoder.header().sequence == header.sequence);
        REQUIRE(decoder.header().model_id == header.model_id);
        REQUIRE(std::vector<int8_t>(decoder.messages(), decoder.messages() + channels) == messages);
    }
}

TEST_CASE("no single flipped bit passes for a good frame, and the next frame is received") {
    const int8_t messages[21] = {64, 0, -127, 127, 5};
    uint8_t wire[kMaxFrame];
    const uint8_t size = encode_frame({Side::West, 7, 200, 0xD0AA}, messages, 21, wire);
    for (int bit = 0; bit < size * 8; ++bit) {
        FrameDecoder decoder(21);
        for (uint8_t at = 0; at < size; ++at) {
            const uint8_t damage = at == bit / 8 ? 1 << bit % 8 : 0;
            REQUIRE(decoder.feed(wire[at] ^ damage) != FrameDecoder::Result::Ready);
        }
        decoder.feed(0); // in case the delimiter itself was hit
        for (uint8_t at = 0; at + 1 < size; ++at) {
            REQUIRE(decoder.feed(wire[at]) == FrameDecoder::Result::Pending);
        }
        REQUIRE(decoder.feed(0) == FrameDecoder::Result::Ready);
    }
}
