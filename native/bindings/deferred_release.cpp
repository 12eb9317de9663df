// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/deferred_release.h"

#include <mutex>
#include <utility>

namespace shadow_layers::bindings {
namespace {

struct Queue {
    std::mutex mutex;
    std::vector<PyObject*> objects;
    bool call_pending = false;
};

// Never destroyed: an owner may die after the static destructors have begun.
Queue& queue() {
    static Queue* instance = new Queue;
    return *instance;
}

int run_pending_call(void*) {
    release_deferred();
    return 0;
}

void defer(std::vector<PyObject*>& objects) {
    Queue& pending = queue();
    bool ask = false;
    {
        std::lock_guard lock(pending.mutex);
        pending.objects.insert(pending.objects.end(), objects.begin(), objects.end());
        ask = !std::exchange(pending.call_pending, true);
    }
    // Needs no GIL and does not block. After the interpreter's end the references are moot.
    if (ask && Py_IsInitialized() && Py_AddPendingCall(run_pending_call, nullptr) != 0) {
        std::lock_guard lock(pending.mutex);
        pending.call_pending = false;  // the interpreter's list is full: the next one out of the module does it
    }
}

struct Held {
    std::vector<PyObject*> objects;
    ~Held() { defer(objects); }
};

}  // namespace

std::shared_ptr<const void> hold_until_unused(std::vector<pybind11::object> objects) {
    auto held = std::make_shared<Held>();
    held->objects.reserve(objects.size());
    for (pybind11::object& object : objects) held->objects.push_back(object.release().ptr());
    return held;
}

void release_deferred() {
    std::vector<PyObject*> objects;
    {
        std::lock_guard lock(queue().mutex);
        objects.swap(queue().objects);
        queue().call_pending = false;
    }
    for (PyObject* object : objects) Py_DECREF(object);  // may run Python code: not under the lock
}

}  // namespace shadow_layers::bindings
