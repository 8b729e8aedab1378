// What the south link would be with Arduino's SoftwareSerial: the tiles' own frames, in both directions at
// once.
//
// Joined as tiles are, south (A14, A15) to north (Serial2), one such board above another. Every PERIOD_MS
// (0: as fast as they go) a frame leaves on both sides. The counters are read by tools/bench/links.py.
#include <Arduino.h>
#include <SoftwareSerial.h>

#include "core/frame.h"

using namespace tilenca;

namespace {

constexpr uint32_t kBaud = 38400;
constexpr uint8_t kChannels = 21;
constexpr uint16_t kModelId = 0x1234;
constexpr uint8_t kRxPin = A14;
constexpr uint8_t kTxPin = A15;

SoftwareSerial south(kRxPin, kTxPin);

struct Line {
    Stream& stream;
    FrameDecoder decoder;
    uint8_t sequence;
};
Line lines[2] = {{south, FrameDecoder(kChannels), 0}, {Serial2, FrameDecoder(kChannels), 0}};

} // namespace

extern "C" {
// South, then north.
uint32_t frames_sent[2] __attribute__((used));
uint32_t frames_received[2] __attribute__((used));
volatile uint16_t period_ms __attribute__((used)); // written from outside
}

namespace {

void read(uint8_t side) {
    Line& line = lines[side];
    while (line.stream.available()) {
        const uint8_t byte = static_cast<uint8_t>(line.stream.read());
        frames_received[side] += line.decoder.feed(byte) == FrameDecoder::Result::Ready;
    }
}

void write(uint8_t side) {
    Line& line = lines[side];
    int8_t messages[kChannels];
    for (int8_t& message : messages) {
        message = static_cast<int8_t>(random(-kMessageMax, kMessageMax + 1));
    }
    FrameHeader header{};
    header.sequence = line.sequence++;
    header.model_id = kModelId;
    uint8_t wire[kMaxFrame];
    const uint8_t size = encode_frame(header, messages, kChannels, wire);
    line.stream.write(wire, size);
    ++frames_sent[side];
}

} // namespace

void setup() {
    south.begin(kBaud);
    Serial2.begin(kBaud);
}

void loop() {
    static uint32_t last_ms = 0;
    read(0);
    read(1);
    if (millis() - last_ms >= period_ms) {
        last_ms = millis();
        write(1); // into the core's buffer, and out by interrupts
        write(0);
    }
}
