#include "translate/translation.h"

#include "avr/ops.h"
#include "translate/frame.h"

#include <dlfcn.h>
#include <map>
#include <mutex>

namespace tilenca::translate {

Translation::Translation(const std::string& path) : library_(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) {
        throw TranslationError(path + ": no library");
    }
    table_ = static_cast<const Table*>(dlsym(library_, "tilenca_blocks"));
    if (table_ == nullptr || layout() != table_->layout) {
        dlclose(library_);
        throw TranslationError(path + ": made by another version of the emulator");
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

Translation::~Translation() {
    dlclose(library_);
}

bool Translation::fits(const avr::Program& program) const {
    for (uint32_t i = 0; i < table_->code_count; i++) {
        if (program.word(table_->code_words[i]) != table_->code[i]) {
            return false;
        }
    }
    return true;
}

std::shared_ptr<const Translation> load(const std::string& path) {
    static std::mutex loading;
    static std::map<std::string, std::weak_ptr<const Translation>> loaded;
    const std::lock_guard<std::mutex> lock(loading);
    std::shared_ptr<const Translation> found = loaded[path].lock();
    if (found == nullptr) {
        loaded[path] = found = std::make_shared<const Translation>(path);
    }
    return found;
}

} // namespace tilenca::translate
