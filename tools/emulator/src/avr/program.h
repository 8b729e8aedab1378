// The flash: its bytes and what they mean, decoded once and shared by all chips that run the same image.
#pragma once

#include "avr/instruction.h"

#include <cstdint>
#include <set>
#include <vector>

namespace tilenca::avr {

constexpr uint32_t kFlashBytes = 256 * 1024;
constexpr uint32_t kFlashWords = kFlashBytes / 2;
constexpr uint16_t kErased = 0xFFFF;

class Program {
  public:
    // An erased flash.
    Program();

    // Copies bytes in and decodes what changed, and the word before, which may skip or take the first one
    // along.
    void write(uint32_t byte_address, const uint8_t* bytes, uint32_t count);

    const Instruction* instructions() const { return decoded_.data(); }
    const uint8_t* bytes() const { return bytes_.data(); }
    uint16_t word(uint32_t index) const;

    // Lays a trap over the instruction at a word, or takes it away.
    void set_trap(uint32_t word, bool set);
    // Puts the instruction under a trap in its place for a while, or back under it.
    void lift_trap(uint32_t word, bool lifted);
    const std::set<uint32_t>& traps() const { return traps_; }

  private:
    void decode_word(uint32_t index);

    std::vector<uint8_t> bytes_;
    std::set<uint32_t> traps_;
    std::vector<Instruction> decoded_; // two more than flash has: what runs off its end is caught there
};

// Decodes the word `opcode`, followed in flash by `next`.
Instruction decode(uint16_t opcode, uint16_t next, uint32_t word);

// Whether an instruction takes two words (CALL, JMP, LDS, STS).
bool is_two_words(uint16_t opcode);

} // namespace tilenca::avr
