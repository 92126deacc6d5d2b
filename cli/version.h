// SPDX-License-Identifier: Apache-2.0
/// What this program is: its version, the commit, the compiler, the components.
#pragma once

namespace tactus::cli {

void print_version(bool as_json);  ///< schema version.json

}  // namespace tactus::cli
