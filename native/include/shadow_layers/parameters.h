// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace shadow_layers {

/// Enumerations hold the item's id as a string.
using ParameterValue = std::variant<bool, std::int64_t, double, std::string>;

enum class ParameterType : std::uint8_t { Bool, Int, Float, Enum };

struct EnumItem {
    std::string id, label, help;
};

/// A parameter as data. UI, command line, docs table, test matrix and benchmark grid are made from it.
struct ParameterSpec {
    std::string id;     ///< snake_case; also the Python property and the command-line key
    std::string label;  ///< title case, for the UI
    ParameterType type = ParameterType::Float;
    ParameterValue default_value;
    double min = 0, max = 0;      ///< inclusive, Int and Float
    std::string unit;             ///< "texels", "px", "", ...
    std::string help;             ///< one sentence
    std::vector<EnumItem> items;  ///< Enum only
    bool shared = false;          ///< one value for all techniques that have it (map_size); shown once in the UI
    double step = 1;              ///< Int: allowed values are min + k * step (odd kernels: min 1, step 2)
};

/// Values by id. Holds every parameter of the descriptor it was resolved against.
class ParameterValues {
public:
    bool get_bool(std::string_view id) const;
    std::int64_t get_int(std::string_view id) const;
    double get_float(std::string_view id) const;
    const std::string& get_enum(std::string_view id) const;
    const std::map<std::string, ParameterValue, std::less<>>& all() const { return values_; }
    void set(std::string id, ParameterValue value) { values_[std::move(id)] = std::move(value); }

private:
    std::map<std::string, ParameterValue, std::less<>> values_;
};

/// Fills in defaults and checks `given`: InputError names technique, parameter, value and range; unknown ids too.
/// An int is accepted where a float is wanted.
ParameterValues resolve_parameters(std::string_view technique, const std::vector<ParameterSpec>& specs,
                                   const ParameterValues& given);

}  // namespace shadow_layers
