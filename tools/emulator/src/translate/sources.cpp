// Where translations come from: shared libraries, or what the emulator itself was linked with.
#include "translate/translation.h"

#include <map>
#include <mutex>

#ifndef __EMSCRIPTEN__
#include <dlfcn.h>
#endif

// Of blocks that are linked into the emulator; null in an emulator without any.
extern "C" [[gnu::weak, gnu::visibility("hidden")]] const tilenca::translate::Table tilenca_blocks;

namespace tilenca::translate {

namespace {

#ifdef __EMSCRIPTEN__

std::shared_ptr<const Translation> opened(const std::string& path) {
    throw TranslationError(path +
                           ": this emulator loads no libraries; use the blocks that it was built with");
}

#else

// A shared library that stays open as long as its translation lives.
class Library : public Translation {
  public:
    Library(void* handle, const std::string& path)
        : Translation(static_cast<const Table*>(dlsym(handle, "tilenca_blocks")), path), handle_(handle) {}
    ~Library() override { dlclose(handle_); }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

  private:
    void* handle_;
};

std::shared_ptr<const Translation> opened(const std::string& path) {
    void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
        throw TranslationError(path + ": no library");
    }
    try {
        return std::make_shared<const Library>(handle, path);
    } catch (...) {
        dlclose(handle);
        throw;
    }
}

#endif

} // namespace

std::shared_ptr<const Translation> load(const std::string& path) {
    static std::mutex loading;
    static std::map<std::string, std::weak_ptr<const Translation>> loaded;
    const std::lock_guard<std::mutex> lock(loading);
    std::shared_ptr<const Translation> found = loaded[path].lock();
    if (found == nullptr) {
        loaded[path] = found = opened(path);
    }
    return found;
}

std::shared_ptr<const Translation> built_in() {
    const Table* table = &tilenca_blocks;
    if (table == nullptr) {
        throw TranslationError("the emulator was built without translated blocks");
    }
    return std::make_shared<const Translation>(table, "the emulator's own blocks");
}

} // namespace tilenca::translate
