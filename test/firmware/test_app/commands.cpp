#include <doctest/doctest.h>

#include "../support.h"
#include "app/command.h"

using namespace tilenca;
using test::Numbers;

namespace {

struct CommandCase {
    const char* name;
    const char* line;
    const char* events;
};

const CommandCase kCases[] = {
#define CASE(name, line, events) {name, line, events},
#include "commands.inc"
#undef CASE
};

std::vector<std::string> events_of(CommandReader& reader, const std::vector<uint8_t>& line) {
    std::vector<std::string> events;
    for (uint8_t byte : line) {
        switch (reader.feed(byte)) {
        case CommandReader::Result::Pending:
            break;
        case CommandReader::Result::Ready: {
            std::string text = std::string("ok ") + reader.field(0);
            for (uint8_t i = 1; i < reader.fields(); ++i) {
                text += std::string(",") + reader.field(i);
            }
            events.push_back(text);
            break;
        }
        case CommandReader::Result::Damaged:
            events.push_back("CHECKSUM");
            break;
        case CommandReader::Result::TooLong:
            events.push_back("LONG");
            break;
        }
    }
    return events;
}

} // namespace

TEST_CASE("every case of the shared table") {
    for (const CommandCase& command_case : kCases) {
        CAPTURE(command_case.name);
        CommandReader reader;
        CHECK(test::joined(events_of(reader, test::bytes_of_hex(command_case.line)), ";") ==
              command_case.events);
    }
}

TEST_CASE("good commands between any bytes are all found") {
    Numbers numbers(5);
    const std::vector<uint8_t> command = test::bytes_of_hex(kCases[1].line);
    CommandReader reader;
    int good = 0;
    for (int i = 0; i < 20000; ++i) {
        // Much of what a parser looks for, so that it gets far.
        const char interesting[] = "$*,0123456789ABCDEF\r\nASK";
        std::vector<uint8_t> noise = numbers.draw_all<uint8_t>(numbers.draw(0, 90), 0, 255);
        for (uint8_t& byte : noise) {
            if (numbers.chance(40)) {
                byte = static_cast<uint8_t>(interesting[numbers.draw(0, sizeof interesting - 2)]);
            }
        }
        events_of(reader, noise);
        CHECK(reader.field(200) == std::string());
        const std::vector<std::string> events = events_of(reader, command);
        REQUIRE_FALSE(events.empty());
        REQUIRE(events.back() == kCases[1].events);
        ++good;
    }
    CHECK(good == 20000);
}

TEST_CASE("no command with one bit flipped is obeyed") {
    const std::vector<uint8_t> command = test::bytes_of_hex(kCases[1].line);
    for (size_t bit = 0; bit < 8 * (command.size() - 2); ++bit) {
        CAPTURE(bit);
        std::vector<uint8_t> damaged = command;
        damaged[bit / 8] ^= 1 << bit % 8;
        CommandReader reader;
        for (const std::string& event : events_of(reader, damaged)) {
            CHECK(event.compare(0, 2, "ok") != 0);
        }
    }
}

TEST_CASE("a field that a command does not have is empty") {
    CommandReader reader;
    CHECK(reader.field(0) == std::string());
    events_of(reader, test::bytes_of_hex(kCases[1].line));
    CHECK(reader.field(2) == std::string("20"));
    CHECK(reader.field(3) == std::string());
    CHECK(reader.field(255) == std::string());
}

TEST_CASE("numbers are digits within their range") {
    uint16_t number = 99;
    CHECK(number_of("0", 0, &number));
    CHECK(number == 0);
    CHECK(number_of("0065535", 65535, &number));
    CHECK(number == 65535);
    for (const char* wrong :
         {"", "65536", "4294967297", "99999999999999999999", "-1", "+1", "1 ", "0x1", "1.0"}) {
        CAPTURE(wrong);
        number = 99;
        CHECK_FALSE(number_of(wrong, 65535, &number));
        CHECK(number == 99);
    }
    CHECK_FALSE(number_of("11", 10, &number));
}
