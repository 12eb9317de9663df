// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/parameters.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "shadow_layers/error.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers {
namespace {

std::string to_text(const ParameterValue& value) {
    std::ostringstream text;
    if (const auto* flag = std::get_if<bool>(&value)) text << (*flag ? "true" : "false");
    if (const auto* integer = std::get_if<std::int64_t>(&value)) text << *integer;
    if (const auto* number = std::get_if<double>(&value)) text << *number;
    if (const auto* item = std::get_if<std::string>(&value)) text << '"' << *item << '"';
    return text.str();
}

std::string describe_range(const ParameterSpec& spec) {
    std::ostringstream text;
    switch (spec.type) {
        case ParameterType::Bool:
            return "true or false";
        case ParameterType::Int:
            text << "a whole number from " << spec.min << " to " << spec.max;
            if (spec.step > 1) text << " in steps of " << spec.step;
            break;
        case ParameterType::Float:
            text << "a number from " << spec.min << " to " << spec.max;
            break;
        case ParameterType::Enum:
            text << "one of";
            for (const EnumItem& item : spec.items) text << " \"" << item.id << '"';
            break;
    }
    if (!spec.unit.empty()) text << ' ' << spec.unit;
    return text.str();
}

bool is_in_range(const ParameterSpec& spec, double number) {
    return std::isfinite(number) && number >= spec.min && number <= spec.max;
}

bool is_on_step(const ParameterSpec& spec, std::int64_t value) {
    const auto step = std::int64_t(spec.step);
    return step <= 1 || (value - std::int64_t(spec.min)) % step == 0;
}

/// The value in the parameter's own type, or nothing if it is not allowed.
bool convert(const ParameterSpec& spec, const ParameterValue& given, ParameterValue& value) {
    const auto* integer = std::get_if<std::int64_t>(&given);
    switch (spec.type) {
        case ParameterType::Bool:
            value = given;
            return std::holds_alternative<bool>(given);
        case ParameterType::Int:
            value = given;
            return integer && is_in_range(spec, double(*integer)) && is_on_step(spec, *integer);
        case ParameterType::Float:
            value = integer ? ParameterValue(double(*integer)) : given;
            return std::holds_alternative<double>(value) && is_in_range(spec, std::get<double>(value));
        case ParameterType::Enum: {
            value = given;
            const auto* id = std::get_if<std::string>(&given);
            return id && std::any_of(spec.items.begin(), spec.items.end(), [&](const auto& i) { return i.id == *id; });
        }
    }
    return false;
}

template <class T>
const T& get(const std::map<std::string, ParameterValue, std::less<>>& values, std::string_view id) {
    const auto found = values.find(id);
    if (found == values.end())
        throw Error("parameter \"" + std::string(id) + "\" is not in the technique's descriptor");
    const T* value = std::get_if<T>(&found->second);
    if (!value) throw Error("parameter \"" + std::string(id) + "\" is read as another type than its descriptor's");
    return *value;
}

}  // namespace

bool ParameterValues::get_bool(std::string_view id) const { return get<bool>(values_, id); }
std::int64_t ParameterValues::get_int(std::string_view id) const { return get<std::int64_t>(values_, id); }
double ParameterValues::get_float(std::string_view id) const { return get<double>(values_, id); }
const std::string& ParameterValues::get_enum(std::string_view id) const { return get<std::string>(values_, id); }

ParameterValues resolve_parameters(std::string_view technique, const std::vector<ParameterSpec>& specs,
                                   const ParameterValues& given) {
    ParameterValues resolved;
    for (const ParameterSpec& spec : specs) resolved.set(spec.id, spec.default_value);
    for (const auto& [id, value] : given.all()) {
        const auto spec = std::find_if(specs.begin(), specs.end(), [&id = id](const auto& s) { return s.id == id; });
        if (spec == specs.end()) {
            std::string known;
            for (const ParameterSpec& s : specs) known += (known.empty() ? "" : ", ") + s.id;
            throw InputError("technique \"" + std::string(technique) + "\" has no parameter \"" + id +
                             "\"; it has: " + (known.empty() ? "none" : known));
        }
        ParameterValue converted;
        if (!convert(*spec, value, converted)) refuse_parameter(technique, id, value, describe_range(*spec));
        resolved.set(id, std::move(converted));
    }
    return resolved;
}

ParameterValues resolve_parameters(const TechniqueDescriptor& technique, const ParameterValues& given) {
    ParameterValues resolved = resolve_parameters(technique.id, technique.parameters, given);
    if (technique.check) technique.check(resolved);
    return resolved;
}

TruthSpec find_truth(const TechniqueDescriptor& technique, const ParameterValues& values) {
    return technique.truth ? technique.truth(values) : TruthSpec{};
}

void refuse_parameter(std::string_view technique, std::string_view parameter, const ParameterValue& value,
                      std::string_view allowed) {
    throw InputError("technique \"" + std::string(technique) + "\", parameter \"" + std::string(parameter) +
                     "\": " + to_text(value) + " is not allowed; give " + std::string(allowed));
}

}  // namespace shadow_layers
