// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

#include "cli/describe.h"
#include "cli/verbs.h"
#include "io/whole_file.h"

namespace shadow_layers::cli {

void run_info(const Options& options) {
    Session session(make_session_options(options));
    const SessionInfo& info = session.info();
    std::printf(
        "version           %s\nrevision          %s\nbackend           %s\ngl_version        %s\ngl_renderer       %s\n"
        "gl_vendor         %s\nsoftware          %s\nthreads           %d\nmax_texture_size  %d\n\n%s\n",
        version(), revision(), info.backend.c_str(), info.gl_version.c_str(), info.gl_renderer.c_str(),
        info.gl_vendor.c_str(), info.software ? "true" : "false", info.threads, info.max_texture_size,
        describe_techniques().c_str());
    if (options.json.empty()) return;
    nlohmann::json document = versions_to_json(info);
    document["schema"] = "shadow-layers-info";
    document["schema_version"] = 1;
    document["version"] = version();
    document["gl_vendor"] = info.gl_vendor;
    document["software"] = info.software;
    document["threads"] = info.threads;
    document["max_texture_size"] = info.max_texture_size;
    document["techniques"] = nlohmann::json::array();
    for (const TechniqueDescriptor& descriptor : technique_descriptors())
        document["techniques"].push_back(technique_to_json(descriptor));
    io::write_whole_file(options.json, document.dump(1) + "\n");
}

}  // namespace shadow_layers::cli
