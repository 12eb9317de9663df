// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace shadow_layers::io {

/// A zip file open for reading (libzip). Everything throws FileError naming the file, and the member where there is
/// one.
class ZipArchive {
public:
    explicit ZipArchive(const std::filesystem::path& path);
    ~ZipArchive();
    ZipArchive(const ZipArchive&) = delete;
    ZipArchive& operator=(const ZipArchive&) = delete;

    bool has(const std::string& member) const;

    /// The whole member; FileError if it is larger than max_bytes.
    std::string read_text(const std::string& member, std::size_t max_bytes) const;

    /// A member read from its start, piece by piece.
    class Stream {
    public:
        ~Stream();
        Stream(Stream&& other) noexcept = default;
        /// Bytes read, fewer than asked for only at the member's end. The checksum is checked there.
        std::size_t read(std::span<std::byte> target);
        std::uint64_t size() const;  ///< as the archive says
        [[noreturn]] void fail(const std::string& what) const;

    private:
        friend class ZipArchive;
        struct Impl;
        explicit Stream(std::unique_ptr<Impl> impl);
        std::unique_ptr<Impl> impl_;
    };
    Stream open(const std::string& member) const;

    [[noreturn]] void fail(const std::string& what) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace shadow_layers::io
