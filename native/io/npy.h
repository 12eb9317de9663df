// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace shadow_layers::io {

/// The header of a .npy member (NumPy's own format, versions 1 to 3).
struct NpyHeader {
    std::string descr;  ///< "<f4", "|u1", ...
    bool fortran_order = false;
    std::vector<std::size_t> shape;
    std::size_t data_offset = 0;  ///< bytes before the first element
};

/// How many bytes of a member hold the header at most. Longer ones are refused.
inline constexpr std::size_t kMaxNpyHeaderBytes = 64 * 1024;

/// Reads the header from the start of a member. Trusts nothing. FileError without the member's name.
NpyHeader parse_npy_header(std::span<const std::byte> start);

/// What a member must be; -1 in the shape for any length.
struct NpySpec {
    std::string descr;
    std::vector<long> shape;
};

/// Bytes of the elements; FileError if dtype, order or shape differ from what is wanted, or the size overflows.
std::size_t check_npy_header(const NpyHeader& header, const NpySpec& wanted);

}  // namespace shadow_layers::io
