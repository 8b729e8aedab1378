// A compiled translation: the blocks that a program's chips execute in place of its instructions.
#pragma once

#include "avr/program.h"

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace tilenca::translate {

// What compiled blocks say of themselves: `tilenca_blocks` in them.
struct Table {
    const char* layout;
    uint32_t count;
    const uint32_t* begins;        // words of flash
    const avr::Handler* functions; // a block each
    avr::Handler* handlers; // the interpreter's for each first instruction; filled in when it is loaded
    avr::Handler* leave;    // what hands control back; the same
    uint32_t code_count;    // words that were translated: where they lie in flash, and what they are
    const uint32_t* code_words;
    const uint16_t* code;
};

struct TranslationError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Translation : public avr::Overlay {
  public:
    // `table` must live on; `name` is for the message. Throws TranslationError: it is null, or of another
    // version of the emulator.
    Translation(const Table* table, const std::string& name);

    // Whether all that was translated stands in the program.
    bool fits(const avr::Program& program) const override;
    size_t size() const override { return table_->count; }
    uint32_t begin(size_t block) const override { return table_->begins[block]; }
    avr::Handler function(size_t block) const override { return table_->functions[block]; }

  private:
    const Table* table_;
};

// The translation in a shared library; the same for all who ask for it while one of them has it. Throws
// TranslationError.
std::shared_ptr<const Translation> load(const std::string& path);

// The translation that the emulator itself was linked with. Throws TranslationError: with none.
std::shared_ptr<const Translation> built_in();

} // namespace tilenca::translate
