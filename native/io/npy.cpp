// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/npy.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kMaxDimensions = 32;

// Reads the one Python literal that NumPy writes: a dict of strings to a string, a bool and a tuple of ints.
class LiteralReader {
public:
    explicit LiteralReader(std::string_view text) : text_(text) {}

    NpyHeader read_header() {
        NpyHeader header;
        bool has_descr = false, has_order = false, has_shape = false;
        expect('{');
        while (!take('}')) {
            const std::string key = read_string();
            expect(':');
            if (key == "descr" && !has_descr) {
                header.descr = read_descr();
                has_descr = true;
            } else if (key == "fortran_order" && !has_order) {
                header.fortran_order = read_bool();
                has_order = true;
            } else if (key == "shape" && !has_shape) {
                header.shape = read_shape();
                has_shape = true;
            } else {
                throw FileError("its header has an unknown or double key '" + key + "'");
            }
            if (!take(',')) {
                expect('}');
                break;
            }
        }
        if (!has_descr || !has_order || !has_shape) throw FileError("its header lacks descr, fortran_order or shape");
        skip_space();
        if (position_ != text_.size()) throw FileError("its header goes on after its end");
        return header;
    }

private:
    void skip_space() {
        while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\n')) ++position_;
    }
    bool take(char wanted) {
        skip_space();
        if (position_ >= text_.size() || text_[position_] != wanted) return false;
        ++position_;
        return true;
    }
    void expect(char wanted) {
        if (!take(wanted)) throw FileError(std::string("its header lacks a '") + wanted + "'");
    }
    std::string read_string() {
        skip_space();
        const char quote = position_ < text_.size() ? text_[position_] : ' ';
        if (quote != '\'' && quote != '"') throw FileError("its header lacks a string");
        const std::size_t end = text_.find(quote, position_ + 1);
        if (end == std::string_view::npos) throw FileError("its header has a string without end");
        std::string value(text_.substr(position_ + 1, end - position_ - 1));
        position_ = end + 1;
        return value;
    }
    std::string read_descr() {
        skip_space();
        if (position_ < text_.size() && text_[position_] == '[') {
            throw FileError("it is a structured array; write plain numbers");
        }
        return read_string();
    }
    bool read_bool() {
        skip_space();
        for (const auto& [word, value] :
             {std::pair{std::string_view("True"), true}, {std::string_view("False"), false}}) {
            if (text_.substr(position_, word.size()) == word) {
                position_ += word.size();
                return value;
            }
        }
        throw FileError("its header lacks True or False");
    }
    std::vector<std::size_t> read_shape() {
        std::vector<std::size_t> shape;
        expect('(');
        while (!take(')')) {
            shape.push_back(read_size());
            if (shape.size() > kMaxDimensions) throw FileError("it has more than 32 dimensions");
            if (!take(',')) {
                expect(')');
                break;
            }
        }
        return shape;
    }
    std::size_t read_size() {
        skip_space();
        std::size_t value = 0, digits = 0;
        for (; position_ < text_.size() && text_[position_] >= '0' && text_[position_] <= '9'; ++position_, ++digits) {
            const std::size_t digit = std::size_t(text_[position_] - '0');
            if (value > (std::numeric_limits<std::size_t>::max() - digit) / 10)
                throw FileError("its shape is too large");
            value = value * 10 + digit;
        }
        if (digits == 0) throw FileError("its shape is not made of whole numbers");
        return value;
    }

    std::string_view text_;
    std::size_t position_ = 0;
};

std::string shape_text(const std::vector<std::size_t>& shape) {
    std::string text = "(";
    for (const std::size_t length : shape) text += std::to_string(length) + ", ";
    return text + ")";
}

std::string shape_text(const std::vector<long>& shape) {
    std::string text = "(";
    for (const long length : shape) text += (length < 0 ? "n" : std::to_string(length)) + ", ";
    return text + ")";
}

std::size_t item_bytes(const std::string& descr) { return std::size_t(descr.back() - '0'); }

}  // namespace

NpyHeader parse_npy_header(std::span<const std::byte> start) {
    const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
    if (text.size() < 10 || text.substr(0, kMagic.size()) != kMagic) throw FileError("it is not a .npy array");
    const auto byte_at = [&](std::size_t index) { return std::size_t(std::to_integer<unsigned>(start[index])); };
    const std::size_t version = byte_at(6);
    if (version < 1 || version > 3) throw FileError("its .npy version " + std::to_string(version) + " is unknown");
    const std::size_t prefix = version == 1 ? 10 : 12;
    if (text.size() < prefix) throw FileError("it is cut off in its header");
    std::size_t length = byte_at(8) | byte_at(9) << 8;
    if (version > 1) length |= byte_at(10) << 16 | byte_at(11) << 24;
    if (length > kMaxNpyHeaderBytes - prefix) throw FileError("its header is longer than 64 KiB");
    if (length > text.size() - prefix) throw FileError("it is cut off in its header");
    NpyHeader header = LiteralReader(text.substr(prefix, length)).read_header();
    header.data_offset = prefix + length;
    return header;
}

std::size_t check_npy_header(const NpyHeader& header, const NpySpec& wanted) {
    // One byte has no order: NumPy writes '|'.
    if (header.descr != wanted.descr) {
        throw FileError("its dtype is '" + header.descr + "', wanted '" + wanted.descr + "'; write it with .astype('" +
                        wanted.descr + "')");
    }
    const auto fits = [](std::size_t got, long length) { return length < 0 || got == std::size_t(length); };
    if (!std::equal(header.shape.begin(), header.shape.end(), wanted.shape.begin(), wanted.shape.end(), fits)) {
        throw FileError("its shape is " + shape_text(header.shape) + ", wanted " + shape_text(wanted.shape));
    }
    if (header.fortran_order && header.shape.size() > 1) {
        throw FileError("it is in Fortran order; write it with numpy.ascontiguousarray");
    }
    std::size_t bytes = item_bytes(wanted.descr);
    for (const std::size_t length : header.shape) {
        if (length != 0 && bytes > std::numeric_limits<std::size_t>::max() / length) {
            throw FileError("its shape " + shape_text(header.shape) + " is too large");
        }
        bytes *= length;
    }
    return bytes;
}

}  // namespace shadow_layers::io
