// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "context/context.h"

#include <cstdlib>
#include <functional>
#include <mutex>
#include <vector>

#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

struct Attempt {
    const char* name;
    const char* remedy;
    std::function<std::unique_ptr<Context>()> make;
};

const Attempt kEGLHardware = {"EGL on a GPU", "install a GPU driver with OpenGL 4.5 and libegl1",
                              [] { return make_egl_context(EGLChoice::Hardware); }};
const Attempt kOSMesa = {"OSMesa", "install libosmesa6", [] { return make_osmesa_context(); }};
const Attempt kEGLSoftware = {"EGL in software", "install libegl1 and libgl1-mesa-dri",
                              [] { return make_egl_context(EGLChoice::Software); }};
const Attempt kEGL = {"EGL", "install libegl1 and a GPU driver, or libgl1-mesa-dri for software",
                      [] { return make_egl_context(EGLChoice::Any); }};

std::vector<Attempt> list_attempts(const std::string& backend) {
    if (backend == "auto") return {kEGLHardware, kOSMesa, kEGLSoftware};
    if (backend == "osmesa") return {kOSMesa};
    if (backend == "egl") return {kEGL};
    throw InputError("there is no back end \"" + backend + "\"; the back ends are: auto, osmesa, egl");
}

}  // namespace

std::unique_ptr<Context> make_context(const std::string& backend, int threads) {
    const std::vector<Attempt> attempts = list_attempts(backend);
    // setenv is not safe beside itself; other threads of ours only get here under this lock.
    static std::mutex environment_mutex;
    if (threads > 0) {
        std::lock_guard lock(environment_mutex);
        setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), /*overwrite=*/0);
    }
    std::string text = "no OpenGL 4.5 context could be made";
    for (const Attempt& attempt : attempts) {
        try {
            return attempt.make();
        } catch (const ContextError& error) {
            text += std::string("\n  ") + attempt.name + ": " + error.what() + " -> " + attempt.remedy;
        }
    }
    throw ContextError(text);
}

}  // namespace shadow_layers
