// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shadow_layers/parameters.h"

namespace shadow_layers::io {

/// A value in a JSON document together with its place, so that whatever is wrong with it can be named.
/// Everything throws FileError. Lives no longer than the document.
class JsonField {
public:
    JsonField(const nlohmann::json& value, std::string place) : value_(value), place_(std::move(place)) {}

    JsonField operator[](const std::string& key) const;
    JsonField operator[](const char* key) const { return (*this)[std::string(key)]; }
    JsonField operator[](std::size_t index) const;
    JsonField operator[](int index) const { return (*this)[std::size_t(index)]; }

    std::size_t size() const;  ///< of an array
    const nlohmann::json& object() const;
    const std::string& string() const;
    bool boolean() const;
    double number() const;  ///< finite
    int integer(int min, int max) const;
    std::vector<double> numbers(std::size_t count) const;
    glm::dmat4 matrix() const;  ///< four rows of four
    ParameterValue parameter() const;

    [[noreturn]] void fail(const std::string& what) const;

private:
    const nlohmann::json& value_;
    std::string place_;
};

}  // namespace shadow_layers::io
