// SPDX-License-Identifier: Apache-2.0
/// What this program is: its version, the commit, the compiler, the components.
#pragma once

#include <string>

namespace tactus::cli {

std::string version_and_commit();  ///< "0.1.0, commit 0123456789ab-dirty-89abcdef"; without the commit where none is known
void print_version(bool as_json);  ///< schema version.json

}  // namespace tactus::cli
