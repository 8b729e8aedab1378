// What the host says to a tile, one byte at a time: docs/PROTOCOL.md section 6. Pure bytes, no port.
#pragma once

#include <stdint.h>

namespace tilenca {

constexpr uint8_t kMaxCommand = 64;

// Finds sentences among any bytes, checks them, and cuts them into fields.
class CommandReader {
  public:
    enum class Result : uint8_t { Pending, Ready, Damaged, TooLong };

    // Takes the next byte. What lies between sentences is skipped; a damaged or overlong one is told once,
    // and the next `$` begins anew.
    Result feed(uint8_t byte);

    // Of the command that was Ready; valid until the next feed(). Field 0 is its name, and those that it does
    // not have are empty.
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
    uint8_t checksum_ = 0; // of the body so far, then less the digits: right if nothing is left
    char bytes_[kMaxCommand - kAroundBody + 1] = {};
};

// The number that a field is; false if it is none or greater than `most`.
bool number_of(const char* field, uint16_t most, uint16_t* number);

} // namespace tilenca
