#include "translate/translation.h"

#include "avr/ops.h"
#include "translate/frame.h"

namespace tilenca::translate {

Translation::Translation(const Table* table, const std::string& name) : table_(table) {
    if (table_ == nullptr || layout() != table_->layout) {
        throw TranslationError(name + ": made by another version of the emulator");
    }
    *table_->leave = avr::ops::leave;
    // The interpreter's handlers follow from the instructions, which are the same wherever this fits.
    for (uint32_t block = 0, i = 0; block < table_->count; block++) {
        while (table_->code_words[i] != table_->begins[block]) {
            i++;
        }
        const bool is_last = i + 1 == table_->code_count;
        const uint16_t after = is_last ? avr::kErased : table_->code[i + 1];
        table_->handlers[block] = avr::decode(table_->code[i], after, table_->begins[block]).run;
    }
}

bool Translation::fits(const avr::Program& program) const {
    for (uint32_t i = 0; i < table_->code_count; i++) {
        if (program.word(table_->code_words[i]) != table_->code[i]) {
            return false;
        }
    }
    return true;
}

} // namespace tilenca::translate
