// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <string>

namespace shadow_layers {

/// A library opened at run time. Never closed: Mesa and LLVM keep threads and exit handlers that point into it.
class SharedLibrary {
public:
    /// The first of `names` that opens. Throws ContextError with the loader's reason for each.
    explicit SharedLibrary(std::initializer_list<const char*> names);

    /// Throws ContextError if `required` and missing.
    void* find(const char* symbol, bool required = true) const;
    template <class Function>
    Function function(const char* symbol, bool required = true) const {
        return reinterpret_cast<Function>(find(symbol, required));
    }
    const std::string& name() const { return name_; }

private:
    void* handle_ = nullptr;
    std::string name_;
};

}  // namespace shadow_layers
