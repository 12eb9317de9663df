// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <pybind11/stl.h>

#include <cmath>
#include <limits>
#include <set>

#include "bindings/bindings.h"
#include "bindings/convert.h"
#include "bindings/deferred_release.h"
#include "bindings/render_pump.h"
#include "shadow_layers/error.h"
#include "shadow_layers/names.h"
#include "shadow_layers/session.h"

namespace shadow_layers::bindings {
namespace {

struct PyLayer {
    std::uint32_t job = 0, light = 0;
    std::string technique;
    py::dict parameters, channels;
    py::list views, times;
    py::dict counters;
    double total_ms = 0;
};

struct PyFrameResult {
    py::object coverage, combined;
    py::dict aux;
    py::tuple camera_position;
    py::list warnings, times;
    py::dict counters;
    double total_ms = 0;
    py::list layers;
};

class PySession;
// Sessions not yet closed, for the interpreter's end. Touched with the GIL held only. Never destroyed: see atexit.
std::set<PySession*>& open_sessions() {
    static auto* sessions = new std::set<PySession*>;
    return *sessions;
}

class PySession {
public:
    explicit PySession(const SessionOptions& options) {
        {
            const GilRelease release;
            session_ = std::make_shared<Session>(options);
        }
        open_sessions().insert(this);
    }
    ~PySession() { close(); }
    PySession(const PySession&) = delete;
    PySession& operator=(const PySession&) = delete;

    /// Kept by each call for its duration: another thread may close the session meanwhile.
    std::shared_ptr<Session> require_open(const char* member) const {
        if (!session_) throw Error(std::string("Session.") + member + ": the session is closed; make a new Session");
        return session_;
    }

    void cancel() const {
        if (const auto session = session_) session->cancel();
    }

    void close() {
        open_sessions().erase(this);
        auto session = std::move(session_);
        session_.reset();
        if (session) {
            const GilRelease release;
            session->close();  // cancels a running render; waits for the worker, which never wants the GIL
            session.reset();
        }
        release_deferred();
    }

private:
    std::shared_ptr<Session> session_;
};

// No worker thread or GL context may outlive the interpreter; Blender frees its own GL state after that.
void close_open_sessions() {
    while (!open_sessions().empty()) (*open_sessions().begin())->close();
}

std::unique_ptr<PySession> make_session(const std::string& backend, int threads, const py::object& shader_dir,
                                        const py::object& gpu_cache_bytes, const py::object& host_cache_bytes,
                                        bool debug) {
    release_deferred();
    SessionOptions options;
    options.backend = backend;
    options.threads = threads;
    options.shader_dir = py::module_::import("os").attr("fspath")(shader_dir).cast<std::string>();
    const auto bytes_from = [](const char* name, const py::object& given) {
        return std::size_t(integer_from(name, given, 0, std::numeric_limits<std::int64_t>::max()));
    };
    options.gpu_cache_bytes = bytes_from("Session: gpu_cache_bytes", gpu_cache_bytes);
    options.host_cache_bytes = bytes_from("Session: host_cache_bytes", host_cache_bytes);
    options.debug = debug;
    return std::make_unique<PySession>(options);
}

py::dict info_to(const SessionInfo& info) {
    py::dict result;
    result["backend"] = info.backend;
    result["gl_version"] = info.gl_version;
    result["gl_renderer"] = info.gl_renderer;
    result["gl_vendor"] = info.gl_vendor;
    result["threads"] = info.threads;
    result["max_texture_size"] = info.max_texture_size;
    result["software"] = info.software;
    return result;
}

PixelFilterKind filter_from(const std::string& name) {
    if (const auto found = find_pixel_filter(name)) return *found;
    throw InputError("Session.render: filter '" + name + "' is unknown; use " + kPixelFilterNames);
}

std::vector<LayerJob> jobs_from(const py::sequence& jobs) {
    std::vector<LayerJob> result;
    result.reserve(py::len(jobs));
    for (std::size_t i = 0; i < py::len(jobs); ++i) {
        const std::string place = "Session.render: jobs[" + std::to_string(i) + "]";
        const py::object job = jobs[i];
        if (!py::isinstance<py::sequence>(job) || py::isinstance<py::str>(job) || py::len(job) != 3) {
            throw py::type_error(place + ": expected (light index, technique id, parameters), got " +
                                 std::string(py::repr(job)).substr(0, 80));
        }
        const auto parts = py::reinterpret_borrow<py::sequence>(job);
        const py::object technique = parts[1];
        if (!py::isinstance<py::str>(technique)) {
            throw py::type_error(place + "[1]: the technique's id is a string, got " +
                                 std::string(py::repr(technique)).substr(0, 80));
        }
        LayerJob& made = result.emplace_back();
        made.light = std::uint32_t(integer_from(place + "[0] (light index)", py::object(parts[0]), 0,
                                                std::numeric_limits<std::int32_t>::max()));
        made.technique = technique.cast<std::string>();
        made.parameters = parameters_from(place + "[2]", py::object(parts[2]));
    }
    return result;
}

PixelRect region_from(const py::object& region) {
    if (region.is_none()) return {};
    const auto numbers = numbers_from("Session.render: region", region, 4);
    for (const double number : numbers) {
        if (!(std::abs(number) < 1e9) || number != double(int(number))) {
            throw InputError("Session.render: region: expected whole pixels (x, y, width, height), got " +
                             std::string(py::repr(region)));
        }
    }
    const PixelRect rect{int(numbers[0]), int(numbers[1]), int(numbers[2]), int(numbers[3])};
    if (rect.width <= 0 || rect.height <= 0) {
        throw InputError("Session.render: region " + std::string(py::repr(region)) +
                         " is empty; leave it out for the whole picture");
    }
    return rect;
}

py::dict view_to(const MapView& view) {
    py::array_t<double> matrix({4, 4});
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) matrix.mutable_at(row, column) = view.view_from_world[column][row];
    py::dict result;
    result["perspective"] = view.perspective;
    result["face"] = view.face;
    result["corner"] = py::make_tuple(view.corner.x, view.corner.y);
    result["texel_size"] = py::make_tuple(view.texel_size.x, view.texel_size.y);
    result["view_from_world"] = matrix;
    return result;
}

PyLayer layer_to(Layer&& layer, const RenderRequest& request) {
    PyLayer result;
    result.job = layer.job;
    result.light = request.jobs.at(layer.job).light;
    result.technique = request.jobs.at(layer.job).technique;
    result.parameters = parameters_to(layer.parameters);
    for (auto& [name, image] : layer.channels) result.channels[py::str(name)] = array_from(std::move(image));
    for (const MapView& view : layer.views) result.views.append(view_to(view));
    result.times = times_to(layer.stats);
    result.counters = counters_to(layer.stats);
    result.total_ms = layer.stats.total_ms;
    return result;
}

PyFrameResult result_to(FrameResult&& frame, py::list layers) {
    PyFrameResult result;
    result.coverage = array_from(std::move(frame.coverage));
    result.combined =
        frame.combined.data.empty() ? py::object(py::none()) : py::object(array_from(std::move(frame.combined)));
    for (auto& [name, image] : frame.aux) result.aux[py::str(name)] = array_from(std::move(image));
    if (!frame.ids.data.empty()) result.aux["ids"] = array_from(std::move(frame.ids));
    result.camera_position = py::make_tuple(frame.camera_position.x, frame.camera_position.y, frame.camera_position.z);
    for (const std::string& warning : frame.warnings) result.warnings.append(warning);
    result.times = times_to(frame.stats);
    result.counters = counters_to(frame.stats);
    result.total_ms = frame.stats.total_ms;
    result.layers = std::move(layers);
    return result;
}

PyFrameResult render(PySession& self, PyScene& scene, const Camera& camera, const py::sequence& jobs, int width,
                     int height, const py::object& region, int samples, const std::string& filter, double filter_width,
                     bool combined, const std::vector<std::string>& aux, const py::object& on_layer,
                     const py::object& on_progress) {
    const std::shared_ptr<Session> session = self.require_open("render");
    RenderRequest request;
    request.camera = camera;
    request.width = width;
    request.height = height;
    request.region = region_from(region);
    request.samples = samples;
    request.filter = {filter_from(filter), filter_width};
    request.jobs = jobs_from(jobs);
    request.combined = combined;
    request.aux = aux;
    scene.frozen = true;
    request.scene = scene.scene;

    py::list layers;
    RenderListener listener;
    listener.on_layer = [&](Layer&& layer) {
        py::object made = py::cast(layer_to(std::move(layer), request));
        if (on_layer.is_none()) {
            layers.append(std::move(made));
        } else {
            on_layer(std::move(made));
        }
    };
    if (!on_progress.is_none()) {
        listener.on_progress = [&](double fraction, const std::string& text) { on_progress(fraction, text); };
    }
    listener.poll = [] {
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        release_deferred();
    };
    FrameResult frame = RenderPump(*session).run(request, listener);
    return result_to(std::move(frame), std::move(layers));
}

void bind_results(py::module_& module) {
    py::class_<PyLayer>(module, "Layer", py::module_local(), "One light worked by one technique.")
        .def_readonly("job", &PyLayer::job, "Index into the jobs of the render.")
        .def_readonly("light", &PyLayer::light)
        .def_readonly("technique", &PyLayer::technique)
        .def_readonly("parameters", &PyLayer::parameters, "Every parameter with its value.")
        .def_readonly("channels", &PyLayer::channels, "float32 (h, w) or (h, w, c) by name; row 0 at the bottom.")
        .def_readonly("views", &PyLayer::views, "The maps' views; see MapView in request.h.")
        .def_readonly("times", &PyLayer::times)
        .def_readonly("counters", &PyLayer::counters)
        .def_readonly("total_ms", &PyLayer::total_ms);
    py::class_<PyFrameResult>(module, "FrameResult", py::module_local(), "What one render gives beside the layers.")
        .def_readonly("coverage", &PyFrameResult::coverage)
        .def_readonly("combined", &PyFrameResult::combined)
        .def_readonly("aux", &PyFrameResult::aux)
        .def_readonly("camera_position", &PyFrameResult::camera_position)
        .def_readonly("warnings", &PyFrameResult::warnings)
        .def_readonly("times", &PyFrameResult::times)
        .def_readonly("counters", &PyFrameResult::counters)
        .def_readonly("total_ms", &PyFrameResult::total_ms)
        .def_readonly("layers", &PyFrameResult::layers, "Empty if on_layer was given.");
}

}  // namespace

void bind_session(py::module_& module) {
    bind_results(module);
    const SessionOptions defaults;
    py::class_<PySession>(module, "Session", py::module_local(), "One GL context on a private thread.")
        .def(py::init(&make_session), py::kw_only(), py::arg("backend") = defaults.backend,
             py::arg("threads") = defaults.threads, py::arg("shader_dir"),
             py::arg("gpu_cache_bytes") = py::int_(defaults.gpu_cache_bytes),
             py::arg("host_cache_bytes") = py::int_(defaults.host_cache_bytes), py::arg("debug") = defaults.debug)
        .def_property_readonly("info", [](const PySession& self) { return info_to(self.require_open("info")->info()); })
        .def("render", &render, py::arg("scene"), py::arg("camera"), py::arg("jobs"), py::kw_only(), py::arg("width"),
             py::arg("height"), py::arg("region") = py::none(), py::arg("samples") = 1,
             py::arg("filter") = "BLACKMAN_HARRIS", py::arg("filter_width") = 1.5, py::arg("combined") = true,
             py::arg("aux") = std::vector<std::string>{}, py::arg("on_layer") = py::none(),
             py::arg("on_progress") = py::none(),
             "Blocks without the GIL. The callbacks run on this thread; what they raise ends the render and is raised.")
        .def("cancel", &PySession::cancel, "From any thread; the running render raises Cancelled within 300 ms.")
        .def_property_readonly("host_bytes",
                               [](const PySession& self) { return self.require_open("host_bytes")->host_bytes(); })
        .def_property_readonly("gpu_bytes",
                               [](const PySession& self) { return self.require_open("gpu_bytes")->gpu_bytes(); })
        .def("close", &PySession::close, "Ends the thread and frees the context; a running render is cancelled.")
        .def("__enter__",
             [](py::object self) {
                 self.cast<const PySession&>().require_open("__enter__");
                 return self;
             })
        .def("__exit__", [](PySession& self, const py::args&) { self.close(); });
    py::module_::import("atexit").attr("register")(py::cpp_function(&close_open_sessions));
}

}  // namespace shadow_layers::bindings
