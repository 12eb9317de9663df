// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, int code) {
    throw FileError("'" + path.string() + "' cannot be written: " + std::strerror(code) +
                    "; choose another folder, or free its disk");
}

}  // namespace

TemporaryFile::TemporaryFile(std::filesystem::path path) : path_(std::move(path)) {
    name_ = path_.parent_path() / (".shadow-layers-" + std::to_string(getpid()) + "-" + path_.filename().string());
    descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) fail(path_, errno);
}

TemporaryFile::~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(name_.c_str());
}

void TemporaryFile::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail(path_, errno);
        bytes = bytes.subspan(std::size_t(written));
    }
}

void TemporaryFile::finish() {
    // Some file systems tell of a full disk only here. EINVAL: what cannot be synced.
    if (::fsync(descriptor_) != 0 && errno != EINVAL) fail(path_, errno);
    if (::close(std::exchange(descriptor_, -1)) != 0) fail(path_, errno);
    if (::rename(name_.c_str(), path_.c_str()) != 0) fail(path_, errno);
    renamed_ = true;
}

void write_whole_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    TemporaryFile file(path);
    file.write(bytes);
    file.finish();
}

void write_whole_file(const std::filesystem::path& path, std::string_view text) {
    write_whole_file(path, std::as_bytes(std::span(text)));
}

void make_output_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder)) {
        throw FileError("the output folder '" + folder.string() + "' cannot be made: " +
                        (error ? error.message() : std::string("a file has its name")) + "; choose another");
    }
    TemporaryFile test(folder / "write_test");
}

}  // namespace shadow_layers::io
