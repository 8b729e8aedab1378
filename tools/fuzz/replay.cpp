// Gives files to a target, in any compiler's build: replay TARGET FILE...
#include <stdio.h>

#include <fstream>
#include <iterator>
#include <vector>

#include "targets.h"

int main(int count, char** words) {
    const tilenca::fuzz::Target target = count > 2 ? tilenca::fuzz::target_of(words[1]) : nullptr;
    if (target == nullptr) {
        fprintf(stderr, "replay TARGET FILE..., where TARGET is %s\n", tilenca::fuzz::names().c_str());
        return 2;
    }
    for (int i = 2; i < count; ++i) {
        std::ifstream file(words[i], std::ios::binary);
        if (!file) {
            fprintf(stderr, "%s cannot be read\n", words[i]);
            return 2;
        }
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        target(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
        printf("%s\n", words[i]);
    }
    return 0;
}
