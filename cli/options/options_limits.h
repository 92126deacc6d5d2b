// SPDX-License-Identifier: Apache-2.0
/// How large a scene may be, as typed: objects=100000,memory=1GB.
#pragma once

#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include <tactus/scene/scene.h>
#include "cli/command.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// Limits that are named, those of `usual` for the rest.   err  a sentence that names the part and what would be right
tl::expected<DecodeLimits, std::string> parse_limits(std::string_view text, const DecodeLimits& usual = {});

/// Option --limit. It may be repeated.
Option* add_limits(Command& app, DecodeLimits& value, const std::string& help);
const char* limits_help();  ///< for the footer of a command

/// A scene can be longer than it is large.   err  limit_exceeded R-STR-14; of write_scene
tl::expected<void, Error> check_declaration(const Scene& scene, const DecodeLimits& limits);

/// Names of the limits that the rule of an error is about: "objects, vertices, triangles or declaration"; empty: it is about none.
std::string limits_of(const Error& error);
/// Of a scene that is beyond a limit: with the option that allows more.
Failure allow_more(Failure failure, const Error& error);

}  // namespace tactus::cli
