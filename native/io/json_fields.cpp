// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/json_fields.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include "shadow_layers/error.h"

namespace shadow_layers::io {

void JsonField::fail(const std::string& what) const { throw FileError(place_ + ": " + what); }

JsonField JsonField::operator[](const std::string& key) const {
    const auto found = object().find(key);
    if (found == value_.end()) fail("'" + key + "' is missing");
    return {*found, place_ + (place_.ends_with(' ') ? "" : ".") + key};
}

JsonField JsonField::operator[](std::size_t index) const {
    if (index >= size()) fail("it has no element " + std::to_string(index));
    return {value_[index], place_ + "[" + std::to_string(index) + "]"};
}

std::size_t JsonField::size() const {
    if (!value_.is_array()) fail(std::string("wanted a list, got ") + value_.type_name());
    return value_.size();
}

const nlohmann::json& JsonField::object() const {
    if (!value_.is_object()) fail(std::string("wanted an object, got ") + value_.type_name());
    return value_;
}

const std::string& JsonField::string() const {
    if (!value_.is_string()) fail(std::string("wanted a string, got ") + value_.type_name());
    return value_.get_ref<const std::string&>();
}

bool JsonField::boolean() const {
    if (!value_.is_boolean()) fail(std::string("wanted true or false, got ") + value_.type_name());
    return value_.get<bool>();
}

double JsonField::number() const {
    if (!value_.is_number()) fail(std::string("wanted a number, got ") + value_.type_name());
    const double number = value_.get<double>();
    if (!std::isfinite(number)) fail("wanted a finite number");
    return number;
}

int JsonField::integer(int min, int max) const {
    const double value = number();
    if (value != std::floor(value) || value < min || value > max) {
        fail(value_.dump() + " is not a whole number from " + std::to_string(min) + " to " + std::to_string(max));
    }
    return int(value);
}

std::vector<double> JsonField::numbers(std::size_t count) const {
    if (size() != count) fail("wanted " + std::to_string(count) + " numbers, got " + std::to_string(size()));
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = (*this)[i].number();
    return values;
}

glm::dmat4 JsonField::matrix() const {
    if (size() != 4) fail("wanted 4 rows, got " + std::to_string(size()));
    glm::dmat4 matrix;
    for (int row = 0; row < 4; ++row) {
        const auto values = (*this)[row].numbers(4);
        for (int column = 0; column < 4; ++column) matrix[column][row] = values[std::size_t(column)];
    }
    return matrix;
}

ParameterValue JsonField::parameter() const {
    if (value_.is_boolean()) return value_.get<bool>();
    if (value_.is_string()) return value_.get<std::string>();
    if (value_.is_number_unsigned() &&
        value_.get<std::uint64_t>() > std::uint64_t(std::numeric_limits<std::int64_t>::max())) {
        fail(value_.dump() + " is too large");
    }
    if (value_.is_number_integer()) return value_.get<std::int64_t>();
    return number();
}

}  // namespace shadow_layers::io
