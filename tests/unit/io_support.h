// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shadow_layers/error.h"

namespace shadow_layers::test {

/// A folder of its own for each test, removed after it.
class FolderTest : public ::testing::Test {
protected:
    FolderTest() {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("shadow_layers_" + std::to_string(getpid()) + "_" + info->test_suite_name() + "_" + info->name());
        std::filesystem::create_directories(folder_);
    }
    ~FolderTest() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    std::filesystem::path folder_;
};

/// The text of the Error that `action` throws; a failure if it throws none.
template <class Wanted = FileError>
std::string error_of(const std::function<void()>& action) {
    try {
        action();
    } catch (const Wanted& error) {
        return error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << "another kind of error: " << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// A .npy member as NumPy writes it.
std::string make_npy(const std::string& descr, const std::string& shape, const std::string& data,
                     const std::string& fortran_order = "False");

/// A snapshot as a map of its members: a ground plane and a triangle, a sun, a camera.
std::map<std::string, std::string> make_snapshot_members();
nlohmann::json make_snapshot_json();

/// Members as a zip file, stored or deflated.
void write_zip(const std::filesystem::path& path, const std::map<std::string, std::string>& members,
               bool deflate = true);

}  // namespace shadow_layers::test
