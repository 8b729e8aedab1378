// The flash: its bytes and what they mean, decoded once and shared by all chips that run the same image.
#pragma once

#include "avr/instruction.h"

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

namespace tilenca::avr {

constexpr uint32_t kFlashBytes = 256 * 1024;
constexpr uint32_t kFlashWords = kFlashBytes / 2;
constexpr uint16_t kErased = 0xFFFF;

// Decodes the word `opcode`, followed in flash by `next`.
Instruction decode(uint16_t opcode, uint16_t next, uint32_t word);

class Program;

// Functions that each do the work of several instructions, laid over the first of them.
class Overlay {
  public:
    virtual ~Overlay() = default;
    // Whether the program has the instructions that the functions were made from.
    virtual bool fits(const Program& program) const = 0;
    virtual size_t size() const = 0;
    virtual uint32_t begin(size_t block) const = 0; // word of flash
    virtual Handler function(size_t block) const = 0;
};

// How often each word of flash was executed as an instruction.
struct Counts {
    std::vector<Handler> handlers; // what a word's instruction does, besides being counted
    std::vector<uint64_t> executed;
};

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

    // The instruction at a word, whatever lies over it.
    Instruction original(uint32_t index) const { return decode(word(index), word(index + 1), index); }
    // Its handler, by which it is executed alone.
    Handler alone(uint32_t index) const;
    // Lays functions over the instructions, until flash is written; a trap takes them off as long as it is
    // there. False: they were made from another program.
    bool lay(std::shared_ptr<const Overlay> overlay);
    // From now on `counter` is executed in place of each instruction, and has to call its handler.
    void count_with(Handler counter);
    Counts* counts() const { return counts_.get(); }

  private:
    void decode_word(uint32_t index);
    bool is_overlaid() const { return overlay_ != nullptr && traps_.empty(); }
    void show_overlay(bool shown);

    std::vector<uint8_t> bytes_;
    std::set<uint32_t> traps_;
    std::shared_ptr<const Overlay> overlay_;
    std::shared_ptr<Counts> counts_;
    std::vector<Instruction> decoded_; // two more than flash has: what runs off its end is caught there
};

// Whether an instruction takes two words (CALL, JMP, LDS, STS).
bool is_two_words(uint16_t opcode);

} // namespace tilenca::avr
