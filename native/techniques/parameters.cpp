// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

std::string to_text(const ParameterValue& value) {
    std::ostringstream text;
    if (const auto* flag = std::get_if<bool>(&value)) text << (*flag ? "true" : "false");
    else if (const auto* integer = std::get_if<std::int64_t>(&value)) text << *integer;
    else if (const auto* real = std::get_if<double>(&value)) text << *real;
    else text << '"' << std::get<std::string>(value) << '"';
    return text.str();
}

[[noreturn]] void refuse(std::string_view technique, const ParameterSpec& spec, const ParameterValue& value,
                         const std::string& wanted) {
    throw InputError(std::string(technique) + ": parameter \"" + spec.id + "\" is " + to_text(value) + ", but must be " +
                     wanted);
}

std::string describe_range(const ParameterSpec& spec, const char* kind) {
    std::ostringstream text;
    text << kind << " from " << spec.min << " to " << spec.max;
    if (spec.type == ParameterType::Int && spec.step > 1) text << " in steps of " << spec.step;
    return text.str();
}

ParameterValue check_int(std::string_view technique, const ParameterSpec& spec, const ParameterValue& value) {
    const std::string wanted = describe_range(spec, "a whole number");
    const auto* given = std::get_if<std::int64_t>(&value);
    if (!given || double(*given) < spec.min || double(*given) > spec.max) refuse(technique, spec, value, wanted);
    const auto step = std::int64_t(spec.step);
    if (step > 1 && (*given - std::int64_t(spec.min)) % step != 0) refuse(technique, spec, value, wanted);
    return *given;
}

ParameterValue check_float(std::string_view technique, const ParameterSpec& spec, const ParameterValue& value) {
    double given = 0;
    if (const auto* real = std::get_if<double>(&value)) given = *real;
    else if (const auto* integer = std::get_if<std::int64_t>(&value)) given = double(*integer);
    else refuse(technique, spec, value, describe_range(spec, "a number"));
    if (!std::isfinite(given) || given < spec.min || given > spec.max)
        refuse(technique, spec, value, describe_range(spec, "a number"));
    return given;
}

ParameterValue check_enum(std::string_view technique, const ParameterSpec& spec, const ParameterValue& value) {
    const auto* given = std::get_if<std::string>(&value);
    const auto is_given = [&](const EnumItem& item) { return given && item.id == *given; };
    if (std::any_of(spec.items.begin(), spec.items.end(), is_given)) return value;
    std::string wanted = "one of";
    for (const EnumItem& item : spec.items) wanted += (item.id == spec.items.front().id ? " " : ", ") + item.id;
    refuse(technique, spec, value, wanted);
}

ParameterValue check_value(std::string_view technique, const ParameterSpec& spec, const ParameterValue& value) {
    switch (spec.type) {
        case ParameterType::Bool:
            if (!std::holds_alternative<bool>(value)) refuse(technique, spec, value, "true or false");
            return value;
        case ParameterType::Int: return check_int(technique, spec, value);
        case ParameterType::Float: return check_float(technique, spec, value);
        case ParameterType::Enum: return check_enum(technique, spec, value);
    }
    return value;
}

template <class T>
const T& get_as(const std::map<std::string, ParameterValue, std::less<>>& values, std::string_view id) {
    const auto found = values.find(id);
    if (found == values.end()) throw InputError("there is no parameter \"" + std::string(id) + "\"");
    const T* value = std::get_if<T>(&found->second);
    if (!value) throw InputError("parameter \"" + std::string(id) + "\" is of another type: " + to_text(found->second));
    return *value;
}

}  // namespace

bool ParameterValues::get_bool(std::string_view id) const { return get_as<bool>(values_, id); }
std::int64_t ParameterValues::get_int(std::string_view id) const { return get_as<std::int64_t>(values_, id); }
double ParameterValues::get_float(std::string_view id) const { return get_as<double>(values_, id); }
const std::string& ParameterValues::get_enum(std::string_view id) const { return get_as<std::string>(values_, id); }

ParameterValues resolve_parameters(std::string_view technique, const std::vector<ParameterSpec>& specs,
                                   const ParameterValues& given) {
    for (const auto& [id, value] : given.all()) {
        const bool known = std::any_of(specs.begin(), specs.end(), [&](const ParameterSpec& spec) { return spec.id == id; });
        if (known) continue;
        std::string names;
        for (const ParameterSpec& spec : specs) names += (names.empty() ? "" : ", ") + spec.id;
        throw InputError(std::string(technique) + ": there is no parameter \"" + id + "\" (given " + to_text(value) +
                         "); it has: " + (names.empty() ? "none" : names));
    }
    ParameterValues resolved;
    for (const ParameterSpec& spec : specs) {
        const auto found = given.all().find(spec.id);
        resolved.set(spec.id, check_value(technique, spec, found != given.all().end() ? found->second : spec.default_value));
    }
    return resolved;
}

}  // namespace shadow_layers
