// SPDX-License-Identifier: Apache-2.0
/// What was probably meant by a word that is not known.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tactus::cli {

/// ". Did you mean NAME?" with the name nearest to `typed`, or empty when none is near.
///   near: at most a third of its letters are missing, superfluous, other ones or swapped with the next
std::string did_you_mean(std::string_view typed, std::span<const std::string> names);

}  // namespace tactus::cli
