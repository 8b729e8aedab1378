#include "translate/emit.h"

#include "translate/forms.h"
#include "translate/frame.h"

#include <algorithm>
#include <array>
#include <map>

namespace tilenca::translate {

namespace {

constexpr unsigned kStackPointer = 32, kRegisters = 33; // the stack pointer is one more register

// A block's function. Registers are variables: read when it is entered, written back wherever it is left.
class Function {
  public:
    Function(const avr::Program& program, const std::map<uint32_t, size_t>& numbers, const Block& block,
             const uint8_t* special)
        : program_(program), numbers_(numbers), block_(block), special_(special), begin_(block.words[0]) {}

    std::string text() {
        for (const uint32_t word : block_.words) { // what it writes has to be known before it is left
            const avr::Instruction in = program_.original(word);
            note(filled(form_of(in, special_), in, ""), form_of(in, special_).kind, written_);
            loops_ = loops_ || leads_to(in, word) == begin_;
        }
        const std::string own = std::to_string(numbers_.at(begin_));
        write("void block" + own + "(STATE) {");
        write("uint32_t a, w;");
        std::string body;
        std::swap(body, text_);
        for (size_t i = 0; i < block_.words.size(); i++) {
            i += emit(i);
        }
        if (!ended_) {
            go(after_);
        }
        std::swap(body, text_);
        for (unsigned reg = 0; reg <= kStackPointer; reg++) {
            if (used_[reg]) {
                write("uint32_t " + name(reg) + " = " + stored(reg) + ";");
            }
        }
        if (loops_) {
            write("again:");
        }
        write("if (RARE(cycle + " + std::to_string(last_start_) + " >= LIMIT)) {" + (loops_ ? flush() : "") +
              " return interpret_first<" + own + ">(PASSED); }");
        text_ += body;
        write("}\n");
        return text_;
    }

  private:
    using Registers = std::array<bool, kRegisters>;

    static std::string name(unsigned reg) { return reg == kStackPointer ? "sp" : "r" + std::to_string(reg); }
    static std::string stored(unsigned reg) {
        return reg == kStackPointer ? "DATA(0x5D) | DATA(0x5E) << 8" : "DATA(" + std::to_string(reg) + ")";
    }
    void write(const std::string& line) { text_ += line + "\n"; }

    uint32_t leads_to(const avr::Instruction& in, uint32_t word) const {
        const Kind kind = form_of(in, special_).kind;
        return kind == Kind::Jump || kind == Kind::Branch ? word + static_cast<uint32_t>(in.jump) : ~0u;
    }

    // Registers in a piece of text: "r24", "sp"; a blank and "=" behind one tells that it is written.
    void note(const std::string& piece, Kind kind, Registers& set) {
        for (size_t i = 0; i < piece.size(); i++) {
            const bool starts = i == 0 || !is_name(piece[i - 1]);
            if (!starts) {
                continue;
            }
            size_t end = i;
            unsigned reg = kStackPointer + 1;
            if (piece[i] == 'r' && i + 1 < piece.size() && piece[i + 1] >= '0' && piece[i + 1] <= '9') {
                for (reg = 0, end = i + 1; end < piece.size() && is_name(piece[end]); end++) {
                    reg = reg * 10 + static_cast<unsigned>(piece[end] - '0');
                }
            } else if (piece.compare(i, 2, "sp") == 0 && (i + 2 == piece.size() || !is_name(piece[i + 2]))) {
                reg = kStackPointer;
                end = i + 2;
            }
            if (reg <= kStackPointer) {
                used_[reg] = true;
                set[reg] = set[reg] || piece.compare(end, 3, " = ") == 0;
            }
        }
        if (kind == Kind::Call || kind == Kind::DynamicCall) {
            used_[kStackPointer] = set[kStackPointer] = true;
        }
    }
    static bool is_name(char c) {
        return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    }

    // Once round the loop, anything may have been written.
    bool is_dirty(unsigned reg) const { return loops_ ? written_[reg] : dirty_[reg]; }

    std::string flush() const {
        std::string all;
        for (unsigned reg = 0; reg < kStackPointer; reg++) {
            if (is_dirty(reg)) {
                all += " " + stored(reg) + " = static_cast<uint8_t>(" + name(reg) + ");";
            }
        }
        if (is_dirty(kStackPointer)) {
            all += " DATA(0x5D) = static_cast<uint8_t>(sp); DATA(0x5E) = static_cast<uint8_t>(sp >> 8);";
        }
        return all;
    }

    // Leaves the block before an instruction, which the interpreter executes.
    std::string interpret(uint32_t word, bool always = false) const {
        if (word == begin_) {
            return "{" + flush() + " return interpret_first<" + std::to_string(numbers_.at(begin_)) +
                   ">(PASSED); }";
        }
        return "{" + flush() + " at += " + std::to_string(word - begin_) + "; return " +
               (always ? "at->run" : "interpret") + "(PASSED); }";
    }

    void go(uint32_t to) {
        const auto known = numbers_.find(to);
        if (loops_ && to == begin_) {
            write("goto again;");
            return;
        }
        write(flush() + " at += " + std::to_string(static_cast<int64_t>(to) - begin_) + ";");
        write(known == numbers_.end() ? "return next(PASSED);"
                                      : "return block" + std::to_string(known->second) + "(PASSED);");
    }

    void go_to_computed() {
        write(flush() + " at = PROGRAM + (w < " + std::to_string(avr::kFlashWords) +
              " ? w : " + std::to_string(avr::kFlashWords) + "); return next(PASSED);");
    }

    void push_return(uint32_t word, uint32_t after) {
        write("if (RARE(!IS_PLAIN_PUSH(sp, 3))) " + interpret(word));
        write("DATA(sp) = " + std::to_string(after & 0xFF) +
              "; DATA(sp - 1) = " + std::to_string(after >> 8 & 0xFF) +
              "; DATA(sp - 2) = " + std::to_string(after >> 16) + "; sp = (sp - 3) & 0xFFFF;");
    }

    void starts(unsigned offset) { last_start_ = std::max(last_start_, offset); }

    // Emits the instruction at an index, and the next one as well if it may be skipped; returns how many
    // more.
    size_t emit(size_t index) {
        const uint32_t word = block_.words[index];
        const avr::Instruction in = program_.original(word);
        const Form form = form_of(in, special_);
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
        if (index + 1 < block_.words.size()) {
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
        return index + 1 < block_.words.size() ? 1 : 0;
    }

    void emit_one(uint32_t word, const avr::Instruction& in, const Form& form, unsigned offset) {
        starts(offset);
        after_ = word_after(program_, word);
        const std::string took = "cycle += " + std::to_string(form.cycles) + ";";
        const std::string piece = filled(form, in, interpret(word));
        switch (form.kind) {
        case Kind::Plain:
            write(piece + " " + took);
            note(filled(form, in, ""), form.kind, dirty_);
            return;
        case Kind::Branch:
            write(took + " if (" + piece + ") { cycle += 1;");
            go(word + static_cast<uint32_t>(in.jump));
            write("}");
            return;
        case Kind::Jump:
            write(took);
            go(word + static_cast<uint32_t>(in.jump));
            break;
        case Kind::Call:
            push_return(word, after_);
            dirty_[kStackPointer] = true;
            write(took);
            go(word + static_cast<uint32_t>(in.jump));
            break;
        case Kind::DynamicCall:
            push_return(word, after_);
            dirty_[kStackPointer] = true;
            write(piece + " " + took);
            go_to_computed();
            break;
        case Kind::Dynamic:
            write(piece + " " + took);
            note(filled(form, in, ""), form.kind, dirty_);
            go_to_computed();
            break;
        default:
            write(interpret(word, true));
        }
        ended_ = true;
    }

    const avr::Program& program_;
    const std::map<uint32_t, size_t>& numbers_; // of all blocks, by their begin
    const Block& block_;
    const uint8_t* special_;
    const uint32_t begin_;
    std::string text_;
    Registers used_{}, written_{}, dirty_{};
    bool loops_ = false, ended_ = false;
    uint32_t after_ = 0;      // the word that follows what was emitted
    unsigned offset_ = 0;     // cycles since the begin, at most
    unsigned last_start_ = 0; // of the last instruction, at most
};

} // namespace

std::string source_of(const avr::Program& program, const std::vector<Block>& blocks, const uint8_t* special) {
    std::map<uint32_t, size_t> numbers;
    for (const Block& block : blocks) {
        numbers.emplace(block.words[0], numbers.size());
    }
    std::string text = head_of(blocks.size());
    for (size_t i = 0; i < blocks.size(); i++) {
        text += "void block" + std::to_string(i) + "(STATE);\n";
    }
    for (const Block& block : blocks) {
        text += Function(program, numbers, block, special).text();
    }
    return text + tail_of(program, blocks);
}

} // namespace tilenca::translate
