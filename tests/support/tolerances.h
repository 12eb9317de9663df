// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Reads tests/tolerances.toml: lines of `technique = { name = number, ... }`.

#include <fstream>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>

namespace shadow_layers::testing {

/// The technique's numbers; missing names are 0. Throws if the technique has no line: adding one takes a line there.
inline std::map<std::string, double> read_tolerances(const std::string& technique) {
    const std::string path = std::string(SHADOW_LAYERS_SHADER_DIR) + "/../tests/tolerances.toml";
    std::ifstream file(path);
    const std::regex line_form(R"(^(\w+)\s*=\s*\{(.*)\})"), item_form(R"((\w+)\s*=\s*([0-9.eE+-]+))");
    std::string line;
    while (std::getline(file, line)) {
        std::smatch match;
        if (!std::regex_search(line, match, line_form) || match[1] != technique) continue;
        std::map<std::string, double> numbers;
        const std::string items = match[2];
        for (std::sregex_iterator it(items.begin(), items.end(), item_form), end; it != end; ++it)
            numbers[(*it)[1]] = std::stod((*it)[2]);
        return numbers;
    }
    throw std::runtime_error(path + " has no line for the technique \"" + technique + "\"");
}

}  // namespace shadow_layers::testing
