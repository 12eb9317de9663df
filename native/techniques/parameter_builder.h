// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>

#include "shadow_layers/parameters.h"

namespace shadow_layers {

/// Writes a ParameterSpec down in one expression:
///
///     int_parameter("kernel", "Kernel", 3).range(1, 31).unit("taps").help("Depth tests per side of the kernel")
class ParameterBuilder {
public:
    ParameterBuilder(std::string id, std::string label, ParameterType type, ParameterValue default_value) {
        spec_.id = std::move(id);
        spec_.label = std::move(label);
        spec_.type = type;
        spec_.default_value = std::move(default_value);
    }
    /// Both ends belong to it.
    ParameterBuilder& range(double min, double max) {
        spec_.min = min;
        spec_.max = max;
        return *this;
    }
    ParameterBuilder& step(double step) {
        spec_.step = step;
        return *this;
    }
    ParameterBuilder& unit(std::string unit) {
        spec_.unit = std::move(unit);
        return *this;
    }
    /// One sentence.
    ParameterBuilder& help(std::string help) {
        spec_.help = std::move(help);
        return *this;
    }
    /// One of an enumeration's values.
    ParameterBuilder& item(std::string id, std::string label, std::string help) {
        spec_.items.push_back({std::move(id), std::move(label), std::move(help)});
        return *this;
    }
    /// One value for all techniques that have this parameter.
    ParameterBuilder& shared() {
        spec_.shared = true;
        return *this;
    }
    operator ParameterSpec() const { return spec_; }

private:
    ParameterSpec spec_;
};

inline ParameterBuilder int_parameter(std::string id, std::string label, std::int64_t default_value) {
    return {std::move(id), std::move(label), ParameterType::Int, default_value};
}
inline ParameterBuilder float_parameter(std::string id, std::string label, double default_value) {
    return {std::move(id), std::move(label), ParameterType::Float, default_value};
}
inline ParameterBuilder bool_parameter(std::string id, std::string label, bool default_value) {
    return {std::move(id), std::move(label), ParameterType::Bool, default_value};
}
/// `default_item` is the id of one of the items that follow.
inline ParameterBuilder enum_parameter(std::string id, std::string label, std::string default_item) {
    return {std::move(id), std::move(label), ParameterType::Enum, std::move(default_item)};
}

}  // namespace shadow_layers
