// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "cli/verbs.h"
#include "shadow_layers/error.h"

int main(int argc, char** argv) {
    using namespace shadow_layers;
    constexpr int kFailed = 1, kUsageError = 2, kInterrupted = 130;
    // A full disk (or a file size limit) is an error of the write, to be reported.
    std::signal(SIGXFSZ, SIG_IGN);
    cli::Options options;
    try {
        if (const auto code = cli::parse_options(argc, argv, options)) return *code;
    } catch (const InputError& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return kUsageError;
    }
    try {
        switch (options.verb) {
            case cli::Verb::Render:
                cli::run_render(options);
                break;
            case cli::Verb::Bench:
                cli::run_bench(options);
                break;
            case cli::Verb::Info:
                cli::run_info(options);
                break;
        }
    } catch (const Cancelled&) {
        std::fprintf(stderr, "interrupted; what was not whole yet was removed\n");
        return kInterrupted;
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "error: memory ran out; take a smaller scene, picture or map\n");
        return kFailed;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return kFailed;
    }
    if (std::fflush(stdout) != 0) {
        std::perror("error: standard output");
        return kFailed;
    }
    return 0;
}
