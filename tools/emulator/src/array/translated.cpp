// An array's image as translated blocks: how it is counted, written out and used.
#include "array/array.h"
#include "translate/emit.h"
#include "translate/profile.h"
#include "translate/translation.h"

namespace tilenca {

void Array::count_instructions() {
    translate::count_instructions(*program_);
    for (auto& tile : tiles_) {
        tile->chip().cpu().use(*program_);
    }
}

std::string Array::translated() const {
    const avr::Counts* counts = program_->counts();
    if (counts == nullptr) {
        return "";
    }
    const uint8_t* special = tiles_[0]->chip().cpu().special;
    return translate::source_of(*program_, translate::hot_blocks(*program_, counts->executed, special),
                                special);
}

bool Array::use_translation(const char* path) {
    return program_->lay(path == nullptr ? translate::built_in() : translate::load(path));
}

} // namespace tilenca
