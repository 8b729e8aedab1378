// Reads the host's commands from single bytes: docs/PROTOCOL.md section 6. It owns no port.
#pragma once

#include <stdint.h>

namespace tilenca {

constexpr uint8_t kMaxCommand = 64;

// Finds sentences in a stream of bytes, checks them, and splits them into fields.
class CommandReader {
  public:
    enum class Result : uint8_t { Pending, Ready, Damaged, TooLong };

    // Takes the next byte. Bytes between sentences are skipped. A damaged or overlong sentence is reported
    // once, and the next `$` begins a new one.
    Result feed(uint8_t byte);

    // The command that was Ready, valid until the next feed(). Field 0 is its name; a field that it does not
    // have is empty.
    uint8_t fields() const { return fields_; }
    const char* field(uint8_t index) const;

  private:
    enum class Stage : uint8_t { Outside, Body, FirstDigit, SecondDigit };
    static constexpr uint8_t kAroundBody = 6; // $ *5A CR LF

    Result end(Result result);
    Result body(uint8_t byte);

    Stage stage_ = Stage::Outside;
    uint8_t size_ = 0;
    uint8_t fields_ = 0;
    uint8_t checksum_ = 0; // XOR of the body and of the digits so far; 0 at the end of a good sentence
    char bytes_[kMaxCommand - kAroundBody + 1] = {};
};

// Reads a field as a number. False if it is not one, or greater than `most`.
bool number_of(const char* field, uint16_t most, uint16_t* number);

} // namespace tilenca
