#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "../support.h"
#include "core/edge_receiver.h"
#include "core/toggles.h"

using namespace tilenca;
using test::Numbers;

namespace {

using Receiver = EdgeReceiver<52>;

constexpr double kBitCycles = 16e6 / 38400;
constexpr double kByteCycles = 10 * kBitCycles;

struct Edge {
    double cycle;
    bool level;
};

// What a sender puts on the line, beginning and ending idle.
class Line {
  public:
    explicit Line(double start_cycle, double bit_cycles = kBitCycles) : cycle(start_cycle), bit(bit_cycles) {}

    void send(uint8_t byte) {
        drive(false);
        for (int i = 0; i < 8; ++i) {
            drive(byte >> i & 1);
        }
        drive(true);
    }

    void pause(double cycles) { cycle += cycles; }

    std::vector<Edge> edges;
    double cycle;
    double bit;

  private:
    void drive(bool level) {
        if (level != level_) {
            edges.push_back({cycle, level});
            level_ = level;
        }
        cycle += bit;
    }

    bool level_ = true;
};

uint16_t count_at(double cycle) {
    return static_cast<uint16_t>(static_cast<uint64_t>(cycle) / 8);
}

uint16_t stamp_at(double cycle, bool level) {
    return static_cast<uint16_t>((count_at(cycle) & ~1) | level);
}

// One more edge, and nothing known of the time after it.
int16_t edge(Receiver& receiver, uint16_t stamp) {
    bool given = false;
    const auto once = [&](uint16_t* next) {
        *next = stamp;
        given = !given;
        return given;
    };
    return receiver.receive(once, stamp);
}

int16_t poll(Receiver& receiver, uint16_t now) {
    return receiver.receive([](uint16_t*) { return false; }, now);
}

// Receives a line as the board does: every so often the main loop comes by, takes what edges there are, and
// polls.
std::vector<uint8_t> receive(const std::vector<Edge>& edges, double end_cycle, double late_cycles = 0,
                             double loop_cycles = 16000, uint32_t seed = 1) {
    Numbers numbers(seed);
    Receiver receiver;
    std::vector<uint8_t> bytes;
    size_t next = 0;
    for (double now = 0; now < end_cycle + 4 * kByteCycles + loop_cycles; now += loop_cycles) {
        const auto source = [&](uint16_t* stamp) {
            if (next == edges.size() || edges[next].cycle > now) {
                return false;
            }
            const double late = late_cycles * numbers.draw(0, 1000) / 1000;
            *stamp = stamp_at(edges[next].cycle + late, edges[next].level);
            ++next;
            return true;
        };
        int16_t byte;
        while ((byte = receiver.receive(source, count_at(now))) != Receiver::kNoByte) {
            bytes.push_back(static_cast<uint8_t>(byte));
        }
    }
    return bytes;
}

std::vector<Edge> edges_of_toggles(const uint8_t* toggles, uint8_t size) {
    std::vector<Edge> edges;
    bool level = true;
    for (int bit = 0; bit < (size - 1) * kTogglesPerByte; ++bit) {
        if (toggles[bit / kTogglesPerByte] << bit % kTogglesPerByte & 0x80) {
            level = !level;
            edges.push_back({1000 + bit * kBitCycles, level});
        }
    }
    return edges;
}

} // namespace

TEST_CASE("every byte comes through, one after another and with pauses") {
    for (double pause : {0.0, 100.0, 5000.0}) {
        CAPTURE(pause);
        Line line(1000);
        std::vector<uint8_t> sent;
        for (int byte = 0; byte < 256; ++byte) {
            line.send(static_cast<uint8_t>(byte));
            line.pause(pause);
            sent.push_back(static_cast<uint8_t>(byte));
        }
        CHECK(receive(line.edges, line.cycle) == sent);
    }
}

TEST_CASE("a clock 2 % off, or edges stamped 150 cycles late at random, lose nothing") {
    Numbers numbers(3);
    const auto sent = numbers.draw_all<uint8_t>(3000, 0, 255);
    for (double error : {-0.02, 0.0, 0.02}) {
        CAPTURE(error);
        Line line(1000, kBitCycles * (1 + error));
        for (uint8_t byte : sent) {
            line.send(byte);
        }
        CHECK(receive(line.edges, line.cycle) == sent);
    }
    for (double error : {-0.003, 0.003}) {
        CAPTURE(error);
        Line line(1000, kBitCycles * (1 + error));
        for (uint8_t byte : sent) {
            line.send(byte);
        }
        CHECK(receive(line.edges, line.cycle, 150) == sent);
    }
}

TEST_CASE("silence of any length, turns of the timer included, changes nothing") {
    for (double turns : {0.4, 0.5, 0.9, 0.99999, 1.0, 1.00001, 1.5, 3.0, 100.25}) {
        CAPTURE(turns);
        Line line(1000);
        line.send(0xA5);
        line.pause(turns * 65536 * 8);
        line.send(0x5A);
        line.send(0xFF);
        CHECK(receive(line.edges, line.cycle) == std::vector<uint8_t>{0xA5, 0x5A, 0xFF});
    }
}

TEST_CASE("a byte whose end has no edge is complete as soon as its stop bit is half over") {
    Receiver receiver;
    CHECK(edge(receiver, 1000 & ~1) == Receiver::kNoByte); // start bit of 0xFF; the line rises after it
    CHECK(edge(receiver, (1052 & ~1) | 1) == Receiver::kNoByte);
    CHECK(poll(receiver, 1000 + 9 * 52) == Receiver::kNoByte);
    CHECK(poll(receiver, 1000 + 9 * 52 + 27) == 0xFF);
    CHECK(poll(receiver, 1000 + 20 * 52) == Receiver::kNoByte);
}

TEST_CASE("after a missed edge the next byte behind a pause is right") {
    Line line(1000);
    line.send(0x35);
    const size_t edges_of_first = line.edges.size();
    line.pause(kByteCycles);
    line.send(0xC3);
    for (size_t missed = 0; missed < edges_of_first; ++missed) {
        CAPTURE(missed);
        std::vector<Edge> edges = line.edges;
        edges.erase(edges.begin() + static_cast<std::ptrdiff_t>(missed));
        const auto bytes = receive(edges, line.cycle);
        REQUIRE_FALSE(bytes.empty());
        CHECK(bytes.back() == 0xC3);
    }
}

TEST_CASE("a glitch shorter than half a bit is no start bit") {
    Line line(20000);
    line.send(0x42);
    std::vector<Edge> edges = {{1000, false}, {1150, true}};
    edges.insert(edges.end(), line.edges.begin(), line.edges.end());
    CHECK(receive(edges, line.cycle) == std::vector<uint8_t>{0x42});
}

TEST_CASE("a line stuck low says nothing, and speaks again when it is let go") {
    Line line(2000000);
    line.send(0x42);
    std::vector<Edge> edges = {{1000, false}, {1900000, true}};
    CHECK(receive(edges, 1900000).empty());
    edges.insert(edges.end(), line.edges.begin(), line.edges.end());
    CHECK(receive(edges, line.cycle) == std::vector<uint8_t>{0x42});
}

TEST_CASE("noise never blocks what comes after it") {
    for (uint32_t seed = 1; seed <= 200; ++seed) {
        CAPTURE(seed);
        Numbers numbers(seed);
        std::vector<Edge> edges;
        double cycle = 1000;
        for (int i = 0; i < 300; ++i) {
            cycle += numbers.draw(1, 3000);
            edges.push_back({cycle, numbers.chance(50)}); // edges were missed, levels repeat
        }
        edges.push_back({cycle + 10, true});
        Line line(cycle + 2 * kByteCycles);
        line.send(0x00);
        line.send(0x99);
        edges.insert(edges.end(), line.edges.begin(), line.edges.end());
        const auto bytes = receive(edges, line.cycle);
        REQUIRE(bytes.size() >= 2);
        CHECK(bytes[bytes.size() - 2] == 0x00);
        CHECK(bytes.back() == 0x99);
    }
}

TEST_CASE("the bytes do not depend on how often the main loop comes by") {
    Numbers numbers(5);
    const auto sent = numbers.draw_all<uint8_t>(200, 0, 255);
    Line line(1000);
    for (uint8_t byte : sent) {
        line.send(byte);
        line.pause(numbers.draw(0, 3) * 10000);
    }
    for (double loop_cycles : {100.0, 1700.0, 16000.0, 100000.0}) {
        CAPTURE(loop_cycles);
        CHECK(receive(line.edges, line.cycle, 40, loop_cycles) == sent);
    }
}

TEST_CASE("after a reset in the middle of a byte the next one is right") {
    Line line(1000);
    line.send(0x35);
    for (size_t heard = 0; heard <= line.edges.size(); ++heard) {
        CAPTURE(heard);
        Receiver receiver;
        for (size_t i = 0; i < heard; ++i) {
            edge(receiver, stamp_at(line.edges[i].cycle, line.edges[i].level));
        }
        receiver.reset();
        CHECK(poll(receiver, count_at(line.cycle + kByteCycles)) == Receiver::kNoByte);
        Line next(line.cycle + 2 * kByteCycles);
        next.send(0xC3);
        for (const Edge& change : next.edges) {
            CHECK(edge(receiver, stamp_at(change.cycle, change.level)) == Receiver::kNoByte);
        }
        CHECK(poll(receiver, count_at(next.cycle)) == 0xC3);
    }
}

TEST_CASE("what the toggles send is what was to be sent") {
    Numbers numbers(6);
    for (int size = 1; size <= kMaxFrame; ++size) {
        CAPTURE(size);
        const auto sent = numbers.draw_all<uint8_t>(static_cast<size_t>(size), 0, 255);
        uint8_t toggles[kMaxToggleBytes];
        const uint8_t written = toggles_of(sent.data(), static_cast<uint8_t>(size), toggles);
        CHECK(written == (size * 10 + 6) / 7 + 1);
        CHECK(toggles[written - 1] == kNoMoreToggles);
        for (uint8_t i = 0; i + 1 < written; ++i) {
            CHECK((toggles[i] & 1) == 1);
        }
        const auto edges = edges_of_toggles(toggles, written);
        CHECK(edges.size() % 2 == 0); // the line ends high
        CHECK(receive(edges, 1000 + size * kByteCycles) == sent);
    }
}

TEST_CASE("bytes without a stop bit are counted, good ones and glitches are not") {
    Receiver receiver;
    CHECK(edge(receiver, stamp_at(1000, false)) == Receiver::kNoByte); // a break
    CHECK(poll(receiver, count_at(1000 + 2 * kByteCycles)) == Receiver::kNoByte);
    CHECK(receiver.framing_errors() == 1);
    CHECK(poll(receiver, count_at(1000 + 3 * kByteCycles)) == Receiver::kNoByte); // and still low
    CHECK(receiver.framing_errors() == 1);
    edge(receiver, stamp_at(1000 + 4 * kByteCycles, true));
    Line line(1000 + 5 * kByteCycles);
    line.send(0x00);
    line.send(0xA5);
    std::vector<uint8_t> bytes;
    for (const Edge& change : line.edges) {
        const int16_t byte = edge(receiver, stamp_at(change.cycle, change.level));
        if (byte != Receiver::kNoByte) {
            bytes.push_back(static_cast<uint8_t>(byte));
        }
    }
    CHECK(poll(receiver, count_at(line.cycle)) == 0xA5);
    CHECK(bytes == std::vector<uint8_t>{0x00});
    const double later = line.cycle + kByteCycles;
    edge(receiver, stamp_at(later, false)); // a glitch of a tenth of a bit
    edge(receiver, stamp_at(later + kByteCycles / 100, true));
    poll(receiver, count_at(later + 2 * kByteCycles));
    CHECK(receiver.framing_errors() == 1);
}
