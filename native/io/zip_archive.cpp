// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/zip_archive.h"

#include <zip.h>

#include <algorithm>

#include "shadow_layers/error.h"

namespace shadow_layers::io {

struct ZipArchive::Impl {
    std::filesystem::path path;
    zip_t* archive = nullptr;
};

struct ZipArchive::Stream::Impl {
    std::string place;
    zip_file_t* file = nullptr;
    std::uint64_t size = 0;
    ~Impl() {
        if (file) zip_fclose(file);
    }
};

ZipArchive::ZipArchive(const std::filesystem::path& path) : impl_(std::make_unique<Impl>()) {
    impl_->path = path;
    int code = 0;
    impl_->archive = zip_open(path.c_str(), ZIP_RDONLY, &code);
    if (!impl_->archive) {
        zip_error_t error;
        zip_error_init_with_code(&error, code);
        const std::string text = zip_error_strerror(&error);
        zip_error_fini(&error);
        fail("it is not a whole snapshot archive (" + text + "); write it again");
    }
}

ZipArchive::~ZipArchive() { zip_discard(impl_->archive); }

void ZipArchive::fail(const std::string& what) const { throw FileError("'" + impl_->path.string() + "': " + what); }

bool ZipArchive::has(const std::string& member) const {
    return zip_name_locate(impl_->archive, member.c_str(), 0) >= 0;
}

ZipArchive::Stream ZipArchive::open(const std::string& member) const {
    zip_stat_t stat;
    if (zip_stat(impl_->archive, member.c_str(), 0, &stat) != 0) {
        fail("member " + member + " is missing; write the snapshot again");
    }
    auto impl = std::make_unique<Stream::Impl>();
    impl->place = "'" + impl_->path.string() + "': member " + member + ": ";
    if (!(stat.valid & ZIP_STAT_SIZE)) throw FileError(impl->place + "its size is unknown");
    impl->size = stat.size;
    impl->file = zip_fopen(impl_->archive, member.c_str(), 0);
    if (!impl->file) throw FileError(impl->place + zip_strerror(impl_->archive));
    return Stream(std::move(impl));
}

std::string ZipArchive::read_text(const std::string& member, std::size_t max_bytes) const {
    Stream stream = open(member);
    if (stream.size() > max_bytes) stream.fail("it is larger than " + std::to_string(max_bytes) + " bytes");
    // The stated size may be a lie: what comes is counted.
    std::string text;
    std::vector<std::byte> piece(64 * 1024);
    for (std::size_t got = 1; got > 0;) {
        got = stream.read(piece);
        text.append(reinterpret_cast<const char*>(piece.data()), got);
        if (text.size() > max_bytes) stream.fail("it is larger than " + std::to_string(max_bytes) + " bytes");
    }
    return text;
}

ZipArchive::Stream::Stream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ZipArchive::Stream::~Stream() = default;

std::uint64_t ZipArchive::Stream::size() const { return impl_->size; }

void ZipArchive::Stream::fail(const std::string& what) const { throw FileError(impl_->place + what); }

std::size_t ZipArchive::Stream::read(std::span<std::byte> target) {
    std::size_t total = 0;
    while (total < target.size()) {
        const zip_int64_t got = zip_fread(impl_->file, target.data() + total, target.size() - total);
        if (got < 0)
            fail(std::string("it is damaged (") + zip_file_strerror(impl_->file) + "); write the snapshot again");
        if (got == 0) break;
        total += std::size_t(got);
    }
    return total;
}

}  // namespace shadow_layers::io
