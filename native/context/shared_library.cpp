// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "context/shared_library.h"

#include <dlfcn.h>

#include "shadow_layers/error.h"

namespace shadow_layers {

SharedLibrary::SharedLibrary(std::initializer_list<const char*> names) {
    std::string reasons;
    for (const char* name : names) {
        // Local, so that its symbols do not mix with Blender's. Not RTLD_DEEPBIND: the library would then bypass the
        // allocator that Blender puts in front of malloc, and frees would meet foreign blocks.
        handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (handle_) {
            name_ = name;
            return;
        }
        const char* reason = dlerror();
        reasons += (reasons.empty() ? "" : "; ") + std::string(reason ? reason : name);
    }
    throw ContextError(reasons);
}

void* SharedLibrary::find(const char* symbol, bool required) const {
    void* address = dlsym(handle_, symbol);
    if (!address && required) throw ContextError(name_ + " has no function " + symbol);
    return address;
}

}  // namespace shadow_layers
