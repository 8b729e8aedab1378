#include "translate/emit.h"

#include "translate/chains.h"
#include "translate/frame.h"
#include "translate/regions.h"

#include <algorithm>
#include <map>

namespace tilenca::translate {

namespace {

std::string function_name(size_t region) {
    return "blocks" + std::to_string(region);
}

// All translated blocks by where they begin, and which function has them.
struct Place {
    size_t block, region;
};
using Places = std::map<uint32_t, Place>;

// A function of one block, or of the blocks of a loop. Those jump to each other's labels.
class Function {
  public:
    Function(const avr::Program& program, const Places& places, const std::vector<const Block*>& blocks,
             const uint8_t* special)
        : program_(program), places_(places), blocks_(blocks), special_(special),
          region_(places.at(blocks[0]->words[0]).region) {}

    std::string text() {
        look_through();
        so_far_ = all_;
        so_far_.forget();
        for (const Block* block : blocks_) {
            write_block(*block);
        }
        std::string body;
        std::swap(body, text_);
        write("void " + function_name(region_) + "(STATE) {\nuint32_t a, w;");
        text_ += all_.declared();
        if (blocks_.size() > 1) {
            write("switch (at - PROGRAM) {");
            for (const Block* block : blocks_) {
                write("case " + std::to_string(block->words[0]) + ": goto " + label(block->words[0]) + ";");
            }
            write("default: __builtin_unreachable();\n}");
        }
        return text_ + body + "}\n\n";
    }

  private:
    static std::string label(uint32_t word) { return "at" + std::to_string(word); }
    void write(const std::string& line) { text_ += line + "\n"; }

    // What it uses and writes, and which registers hold one number together, has to be known before.
    void look_through() {
        std::vector<unsigned> pairs;
        for (const Block* block : blocks_) {
            for (size_t i = 0; i < block->words.size(); i++) {
                const avr::Instruction in = program_.original(block->words[i]);
                const Form form = form_of(in, special_);
                const std::string piece = filled(form, in, "");
                all_.note(piece, form.kind);
                if (const Chain chain = chain_at(*block, i); chain.count != 0) {
                    all_.join(chain.first, chain.count);
                }
                for (const unsigned low :
                     {0u, 24u, 26u, 28u, 30u}) { // a product, and what is added to a word
                    const std::string pair = "(r" + std::to_string(low) + ", r" + std::to_string(low + 1);
                    if (piece.find(pair) != std::string::npos) {
                        pairs.push_back(low);
                    }
                }
                const bool jumps = form.kind == Kind::Jump || form.kind == Kind::Branch;
                is_loop_ = is_loop_ || (jumps && leads_within(target(in, block->words[i])));
            }
        }
        for (const unsigned low : pairs) {
            all_.join(low, 2);
        }
        is_loop_ = is_loop_ || blocks_.size() > 1;
    }

    static uint32_t target(const avr::Instruction& in, uint32_t word) {
        return word + static_cast<uint32_t>(in.jump);
    }
    bool leads_within(uint32_t word) const {
        const auto known = places_.find(word);
        return known != places_.end() && known->second.region == region_;
    }

    Chain chain_at(const Block& block, size_t index) const {
        std::vector<avr::Instruction> instructions;
        for (size_t i = index; i < block.words.size() && block.words[i] == block.words[index] + (i - index);
             i++) {
            instructions.push_back(program_.original(block.words[i]));
        }
        return chain_of(instructions);
    }

    // Once round a loop, anything may have been written.
    std::string written_back() const { return (is_loop_ ? all_ : so_far_).written_back(); }
    static std::string moved_to(uint32_t word) { return " at = PROGRAM + " + std::to_string(word) + "; "; }

    std::string interpret_first(const Registers& written) const {
        return "{" + written.written_back() + moved_to(begin_) + "return interpret_first<" +
               std::to_string(places_.at(begin_).block) + ">(PASSED); }";
    }

    // Leaves before an instruction, which the interpreter executes.
    std::string interpret(uint32_t word, bool always = false) const {
        if (word == begin_) {
            return interpret_first(is_loop_ ? all_ : so_far_);
        }
        return "{" + written_back() + moved_to(word) + "return " + (always ? "at->run" : "interpret") +
               "(PASSED); }";
    }

    void go(uint32_t to) {
        const auto known = places_.find(to);
        if (leads_within(to)) {
            write("goto " + label(to) + ";");
            return;
        }
        write(written_back() + moved_to(to));
        write(known == places_.end() ? "return next(PASSED);"
                                     : "return " + function_name(known->second.region) + "(PASSED);");
    }

    void go_to_computed() {
        const std::string words = std::to_string(avr::kFlashWords);
        write(written_back() + " at = PROGRAM + (w < " + words + " ? w : " + words +
              "); return next(PASSED);");
    }

    void push_return(uint32_t word, uint32_t after) {
        write("if (RARE(!IS_PLAIN_PUSH(sp, 3))) " + interpret(word));
        write("DATA(sp) = " + std::to_string(after & 0xFF) +
              "; DATA(sp - 1) = " + std::to_string(after >> 8 & 0xFF) +
              "; DATA(sp - 2) = " + std::to_string(after >> 16) + "; sp = (sp - 3) & 0xFFFF;");
    }

    void write_block(const Block& block) {
        begin_ = block.words[0];
        offset_ = last_start_ = 0;
        ended_ = reads_flash_ = false;
        std::string body;
        std::swap(body, text_);
        for (size_t i = 0; i < block.words.size(); i++) {
            i += emit(block, i);
        }
        if (!ended_) {
            go(after_);
        }
        std::swap(body, text_);
        if (is_loop_) {
            write(label(begin_) + ":");
        }
        write("if (RARE(cycle + " + std::to_string(last_start_) + " >= LIMIT" +
              (reads_flash_ ? " || FLASH_LIMIT < 0x10000" : "") + ")) " +
              interpret_first(is_loop_ ? all_ : nothing_));
        text_ += body;
    }

    void starts(unsigned offset) { last_start_ = std::max(last_start_, offset); }

    // Emits the instruction at an index, and those that it takes along; returns how many more.
    size_t emit(const Block& block, size_t index) {
        const uint32_t word = block.words[index];
        const avr::Instruction in = program_.original(word);
        const Form form = form_of(in, special_);
        if (const Chain chain = chain_at(block, index);
            chain.count != 0 && all_.are_joined(chain.first, chain.count)) {
            emit_chain(chain, block, index);
            return chain.count - 1;
        }
        if (form.kind != Kind::Skip) {
            emit_one(word, in, form, offset_);
            offset_ += form.cycles;
            return 0;
        }
        starts(offset_);
        const unsigned jump = static_cast<unsigned>(in.jump);
        write("cycle += 1; if (" + filled(form, in, "") + ") { cycle += " + std::to_string(jump - 1) +
              "; } else {");
        const uint32_t over = word + 1;
        unsigned longest = jump;
        if (index + 1 < block.words.size()) {
            const avr::Instruction skipped = program_.original(over);
            const Form its = form_of(skipped, special_);
            emit_one(over, skipped, its, offset_ + 1);
            longest = std::max(longest, 1u + its.cycles);
        } else {
            go(over);
        }
        write("}");
        ended_ = false;
        offset_ += longest;
        after_ = word + jump;
        return index + 1 < block.words.size() ? 1 : 0;
    }

    void emit_chain(const Chain& chain, const Block& block, size_t index) {
        write(chain.text() + " cycle += " + std::to_string(chain.count) + ";");
        for (size_t i = index; i < index + chain.count; i++) {
            const avr::Instruction in = program_.original(block.words[i]);
            const Form form = form_of(in, special_);
            so_far_.note(filled(form, in, ""), form.kind);
        }
        offset_ += chain.count;
        starts(offset_ - 1);
        after_ = block.words[index] + chain.count;
    }

    void emit_one(uint32_t word, const avr::Instruction& in, const Form& form, unsigned offset) {
        starts(offset);
        after_ = word_after(program_, word);
        const std::string took = "cycle += " + std::to_string(form.cycles) + ";";
        const std::string piece = filled(form, in, interpret(word));
        reads_flash_ = reads_flash_ || form.reads_flash;
        switch (form.kind) {
        case Kind::Plain:
            write(piece + " " + took);
            so_far_.note(filled(form, in, ""), form.kind);
            return;
        case Kind::Branch:
            write(took + " if (" + piece + ") { cycle += 1;");
            go(target(in, word));
            write("}");
            return;
        case Kind::Jump:
            write(took);
            go(target(in, word));
            break;
        case Kind::Call:
            push_return(word, after_);
            so_far_.note("", form.kind);
            write(took);
            go(target(in, word));
            break;
        case Kind::DynamicCall:
            push_return(word, after_);
            so_far_.note("", form.kind);
            write(piece + " " + took);
            go_to_computed();
            break;
        case Kind::Dynamic:
            write(piece + " " + took);
            so_far_.note(filled(form, in, ""), form.kind);
            go_to_computed();
            break;
        default:
            write(interpret(word, true));
        }
        ended_ = true;
    }

    const avr::Program& program_;
    const Places& places_;
    const std::vector<const Block*>& blocks_;
    const uint8_t* special_;
    const size_t region_;
    std::string text_;
    Registers all_, so_far_; // of the whole function; of what was emitted, where that is one block
    const Registers nothing_;
    bool is_loop_ = false; // its blocks are jumped to
    uint32_t begin_ = 0;   // of the block
    bool ended_ = false, reads_flash_ = false;
    uint32_t after_ = 0;      // the word that follows what was emitted
    unsigned offset_ = 0;     // cycles since the block's begin, at most
    unsigned last_start_ = 0; // of its last instruction, at most
};

} // namespace

std::string source_of(const avr::Program& program, const std::vector<Block>& blocks, const uint8_t* special) {
    const std::vector<std::vector<size_t>> regions = regions_of(program, blocks, special);
    Places places;
    std::vector<std::string> functions(blocks.size());
    std::string text = head_of(blocks.size());
    for (size_t i = 0; i < regions.size(); i++) {
        text += "void " + function_name(i) + "(STATE);\n";
        for (const size_t block : regions[i]) {
            places[blocks[block].words[0]] = {block, i};
            functions[block] = function_name(i);
        }
    }
    for (const std::vector<size_t>& region : regions) {
        std::vector<const Block*> its;
        for (const size_t block : region) {
            its.push_back(&blocks[block]);
        }
        text += Function(program, places, its, special).text();
    }
    return text + tail_of(program, blocks, functions);
}

} // namespace tilenca::translate
