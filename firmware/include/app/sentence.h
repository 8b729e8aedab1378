// One line of telemetry: `$NAME,field,...*checksum` CR LF, built without printf and without a heap.
#pragma once

#include <stdint.h>

namespace tilenca {

constexpr uint8_t kMaxSentence = 200;

class Sentence {
  public:
    // Starts a new sentence.
    void begin(const char* name);

    // Each appends one field.
    void number(uint32_t value);
    void hex(uint32_t value, uint8_t digits);
    void text(const char* characters);
    void nothing() { put(','); }

    // Appends to the last field.
    void more(char character) { put(character); }
    void more_hex(uint32_t value, uint8_t digits = 2);
    void more(const char* characters);

    // Appends checksum and line end, which completes the sentence.
    void end();

    const char* bytes() const { return bytes_; }
    uint8_t size() const { return size_; }

  private:
    static constexpr uint8_t kEndSize = 5; // *5A CR LF

    void put(char character);

    uint8_t size_ = 0;
    uint8_t checksum_ = 0;
    char bytes_[kMaxSentence] = {};
};

} // namespace tilenca
