// SPDX-License-Identifier: Apache-2.0
/// What `tactus --version` tells: for reports of defects and the methods section of a paper.
#pragma once

#include <string>

namespace tactus::cli {

std::string program_info(bool as_json);

}  // namespace tactus::cli
